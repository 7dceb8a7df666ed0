# The public names of this package. Each is imported when it is first used.
from .kinds import RatchetRecipe as RatchetRecipe
from .wheel import Ratchet as Ratchet
