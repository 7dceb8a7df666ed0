"""What every recipe is: the text of one thing to make, and all that can be known of it."""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar, Self

from ..check import Check
from ..part import Part
from ..table import Table
from ..walls import wall_checks
from .settings import Files


class AbstractRecipe(ABC):
    """A recipe: a frozen dataclass of keyword arguments, on which all that can be known of it hangs.

    A subclass has the field `kind`, a Literal with itself as default, then its tables, the mechanism's first, and
    `files` last; its docstring introduces the kind. What is asked of it is worked out then, and kept. Any of it may
    raise DesignError, whose field is a size of the mechanism or a dotted key of the recipe.
    """

    kind: str
    files: Files
    # Of the folder and the files that are made; "" for that of the kind.
    name: str = ""
    # What a template says of the kind, besides what it is.
    advice: ClassVar[str] = ""

    @property
    @abstractmethod
    def design(self) -> object:
        """The mechanism: sizes as the library takes them, such as FourBar, Cam or SpurGear."""

    @property
    @abstractmethod
    def table(self) -> Table:
        """What the mechanism does, over its frames."""

    @property
    @abstractmethod
    def parts(self) -> tuple[Part, ...]:
        """What is cut."""

    @property
    @abstractmethod
    def judged(self) -> tuple[Check, ...]:
        """Whether the mechanism is good; the walls of its parts come besides."""

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """Whether the mechanism is good, and whether its parts hold when they are cut."""
        # Parts first: what cannot be made at all is told before what is poor.
        walls = wall_checks(self.parts, self.files.kerf)
        return (*self.judged, *walls)

    @property
    def scene(self) -> object | None:
        """How it looks moving: None for a kind that shows nothing."""
        return None

    @property
    def notes(self) -> Mapping[str, object]:
        """Further entries of summary.json."""
        return {}

    @classmethod
    def about(cls) -> str:
        """One line that introduces the kind."""
        return " ".join((cls.__doc__ or "").split())

    @classmethod
    def fit(cls, asked: Mapping[str, str]) -> Mapping[str, object]:
        """Sizes, by dotted key, that make an example of the tables that a template is asked to show.

        asked: dotted key -> kind of table. What this leaves out is made of the examples of its fields.
        """
        return {}

    def called(self, name: str) -> Self:
        """The same recipe under another name, that of its folder and files."""
        other = copy.copy(self)
        object.__setattr__(other, "name", name)
        return other
