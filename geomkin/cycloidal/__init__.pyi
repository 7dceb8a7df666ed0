# The public names of this package. Each is imported when it is first used.
from .drive import CycloidalDrive as CycloidalDrive
from .kinds import CycloidalDriveRecipe as CycloidalDriveRecipe
