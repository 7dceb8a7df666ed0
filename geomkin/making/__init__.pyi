# The public names of this package. Each is imported when it is first used.
from .bases import BaseStock as BaseStock
from .bases import RackBaseStock as RackBaseStock
from .materials import MATERIALS as MATERIALS
from .materials import material as material
from .motor_faces import MOTOR_FACES as MOTOR_FACES
from .motor_faces import MotorFace as MotorFace
from .motor_faces import motor_plate as motor_plate
from .motors import MOTORS as MOTORS
from .motors import motor as motor
from .motors import smallest_motor as smallest_motor
