# The public names of this package. Each is imported when it is first used.
from .kinds import GenevaRecipe as GenevaRecipe
from .wheel import GenevaWheel as GenevaWheel
