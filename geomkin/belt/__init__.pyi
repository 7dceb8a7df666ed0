# The public names of this package. Each is imported when it is first used.
from .kinds import BeltDriveRecipe as BeltDriveRecipe
from .kinds import ChainDriveRecipe as ChainDriveRecipe
from .loop import BeltLoop as BeltLoop
from .loop import LoopWheel as LoopWheel
from .profiles import PROFILES as PROFILES
from .profiles import toothed_outline as toothed_outline
