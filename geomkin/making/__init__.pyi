# The public names of this package. Each is imported when it is first used.
from .assembly import BaseStock as BaseStock
from .assembly import RackBaseStock as RackBaseStock
from .attachments import ACTUATORS as ACTUATORS
from .attachments import Attachment as Attachment
from .materials import MATERIALS as MATERIALS
from .materials import material as material
from .motors import MOTOR_FACES as MOTOR_FACES
from .motors import MOTORS as MOTORS
from .motors import MotorFace as MotorFace
from .motors import motor as motor
from .motors import motor_plate as motor_plate
from .motors import smallest_motor as smallest_motor
