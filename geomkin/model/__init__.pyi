# The public names of this package. Each is imported when it is first used.
from .check import Check as Check
from .check import Suggestion as Suggestion
from .material import Mass as Mass
from .material import Material as Material
from .material import hertz_pressure as hertz_pressure
from .motor import LinearActuator as LinearActuator
from .motor import Motor as Motor
from .motor import MotorDuty as MotorDuty
from .part import Bought as Bought
from .part import HoleFit as HoleFit
from .part import Part as Part
from .part import Twist as Twist
from .table import Column as Column
from .table import Table as Table
