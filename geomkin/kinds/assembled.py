"""What recipes share whose parts go together on shafts: what is bought for them, and the steps."""

from __future__ import annotations

from abc import abstractmethod

from ..part import Bought
from ..recipe.recipe import AbstractRecipe
from ..shop.assembling import Assembly


class AbstractAssembledRecipe(AbstractRecipe):
    """A recipe of gears or of a cam. Bill and steps come from one thing, so that names and letters agree."""

    @property
    @abstractmethod
    def assembly(self) -> Assembly:
        """Shafts and keys, what holds them and the base, and how all of it goes together."""

    @property
    def bought(self) -> tuple[Bought, ...]:
        return self.assembly.bought

    @property
    def steps(self) -> tuple[str, ...]:
        return self.assembly.steps
