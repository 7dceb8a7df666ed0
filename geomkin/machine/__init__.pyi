# The public names of this package. Each is imported when it is first used.
from .kinds import MachineRecipe as MachineRecipe
from .mechanisms import Mechanism as Mechanism
