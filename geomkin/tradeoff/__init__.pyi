# The public names of this package. Each is imported when it is first used.
from .families import FAMILIES as FAMILIES
from .family import Method as Method
from .family import MethodFamily as MethodFamily
from .files import chart_files as chart_files
from .results import Chart as Chart
from .results import FamilyChart as FamilyChart
from .results import Measurement as Measurement
from .results import chart as chart
from .results import pareto_front as pareto_front
from .study import Stability as Stability
from .study import stability as stability
