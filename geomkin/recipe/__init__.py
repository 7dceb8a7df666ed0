"""Recipes: text to frozen data, one class for each kind of mechanism."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .dump import to_toml as to_toml
    from .recipe import AbstractGoal as AbstractGoal
    from .recipe import AbstractRecipe as AbstractRecipe
    from .settings import Drive as Drive
    from .settings import Files as Files
    from .settings import Stroke as Stroke
    from .settings import Turn as Turn
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
