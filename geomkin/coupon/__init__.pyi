# The public names of this package. Each is imported when it is first used.
from .fit_test import FitTest as FitTest
from .kinds.fit_test import FitTestRecipe as FitTestRecipe
from .parts import fit_test_parts as fit_test_parts
