# The public names of this package. Each is imported when it is first used.
from .families import FAMILIES as FAMILIES
from .family import Method as Method
from .family import MethodFamily as MethodFamily
from .files import chart_files as chart_files
from .measurement import Chart as Chart
from .measurement import FamilyChart as FamilyChart
from .measurement import Measurement as Measurement
from .measurement import Stability as Stability
from .measurement import chart as chart
from .measurement import pareto_front as pareto_front
from .measurement import stability as stability
