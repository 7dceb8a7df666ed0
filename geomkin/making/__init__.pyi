# The public names of this package. Each is imported when it is first used.
from .bases import BaseStock as BaseStock
from .bases import RackBaseStock as RackBaseStock
from .motors import motor_plate as motor_plate
