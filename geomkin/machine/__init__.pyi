# The public names of this package. Each is imported when it is first used.
from .recipes import MachineRecipe as MachineRecipe
from .recipes import Mechanism as Mechanism
