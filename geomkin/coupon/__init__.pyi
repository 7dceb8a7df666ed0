# The public names of this package. Each is imported when it is first used.
from .kinds import FitTestRecipe as FitTestRecipe
from .parts import FitTest as FitTest
from .parts import fit_test_parts as fit_test_parts
