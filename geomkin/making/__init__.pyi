# The public names of this package. Each is imported when it is first used.
from .bases import BaseStock as BaseStock
from .bases import RackBaseStock as RackBaseStock
from .materials import MATERIALS as MATERIALS
from .materials import material as material
from .motors import motor_plate as motor_plate
