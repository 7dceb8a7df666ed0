# The public names of this package. Each is imported when it is first used.
from .kinds import KINDS as KINDS
from .kinds import KindRow as KindRow
from .kinds import kind_names as kind_names
from .kinds import recipe_class as recipe_class
from .load import to_toml as to_toml
from .recipe import AbstractGoal as AbstractGoal
from .recipe import AbstractRecipe as AbstractRecipe
from .settings import Drive as Drive
from .settings import Files as Files
from .settings import Stroke as Stroke
from .settings import Turn as Turn
