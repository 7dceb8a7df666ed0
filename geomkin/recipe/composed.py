"""Recipes whose results are those of a mechanism and of its aspects, in one order."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

from ..model.check import Check
from ..model.part import Part
from ..model.scene import Scene, plottable
from ..model.table import Table
from ..plane.vec import Real
from .aspect import AbstractAspect
from .recipe import AbstractAssembledRecipe, AssemblyLike

AspectKinds = tuple[type[AbstractAspect[Any, Any]], ...]


class AbstractComposedRecipe(AbstractAssembledRecipe):
    """A recipe of a mechanism with aspects, of which it knows none by name but in the tuple of its kind.

    A subclass has the results of the mechanism alone, `own_table`, `own_scene`, `own_checks` and `own_notes`.
    """

    # Forwards for columns, entries and remarks; backwards for checks and plots.
    aspect_kinds: ClassVar[AspectKinds]

    @property
    def made(self) -> Any:
        """The mechanism in its setting, as the aspects take it."""
        return self

    @cached_property
    def aspects(self) -> tuple[Any, ...]:
        """The aspects whose keys are given."""
        given = ((kind, getattr(self, kind.key, None)) for kind in self.aspect_kinds)
        return tuple(kind(self.made, value) for kind, value in given if value)

    def aspect(self, key: str) -> Any:
        """The aspect of a key, such as that of `loads` with its forces; None if the key is not given."""
        return next((aspect for aspect in self.aspects if aspect.key == key), None)

    @property
    def depends_on_setting(self) -> bool:
        return bool(self.aspects)

    @property
    @abstractmethod
    def own_table(self) -> Table:
        """Motion and quantities of the mechanism alone."""

    @property
    @abstractmethod
    def own_checks(self) -> tuple[Check, ...]:
        """Checks of the mechanism alone."""

    @property
    @abstractmethod
    def own_scene(self) -> Scene:
        """The moving drawing of the mechanism alone, with the plots of all columns of `table`."""

    @property
    @abstractmethod
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        """Entries of summary.json before and after those of the aspects."""

    @property
    def own_remarks(self) -> tuple[str, ...]:
        """Sentences on the mechanism alone."""
        return ()

    @cached_property
    def table(self) -> Table:
        return self.with_aspects(self.own_table)

    def with_aspects(self, table: Table) -> Table:
        """A table of the mechanism alone with the columns of the aspects."""
        for aspect in self.aspects:
            table = Table((*table.columns, *aspect.columns(table)))
        return table

    @property
    def design_checks(self) -> tuple[Check, ...]:
        of_aspects = (check for aspect in reversed(self.aspects) for check in aspect.checks)
        return (*self.own_checks, *self.engagement_checks, *of_aspects)

    @cached_property
    def scene(self) -> Scene:
        scene = self.own_scene
        for aspect in self.aspects:
            plots = plottable(aspect.plots(scene.table), scene.table)
            scene = aspect.on_scene(replace(scene, plots=(*plots, *scene.plots)))
        return scene

    @property
    def quantities(self) -> Mapping[str, str]:
        """Those of the aspects; a kind adds its own."""
        return {label: text for aspect in self.aspects for label, text in aspect.quantities.items()}

    @property
    def remarks(self) -> tuple[str, ...]:
        return (*self.own_remarks, *(remark for aspect in self.aspects for remark in aspect.remarks))

    @property
    def notes(self) -> Mapping[str, object]:
        before, after = self.own_notes
        return {**before, **{key: entry for aspect in self.aspects for key, entry in aspect.entries.items()}, **after}

    def torque_at(self, turn: Real) -> Real | None:
        torques = [torque for aspect in self.aspects if (torque := aspect.torque_at(turn)) is not None]
        return sum(torques[1:], torques[0]) if torques else None


class AbstractPlatesRecipe(AbstractComposedRecipe):
    """A recipe of a mechanism of plates on a base, such as a belt drive, with one aspect of loads."""

    # Sentence on what is computed with the table `loads`.
    without_loads: ClassVar[str]

    @property
    @abstractmethod
    def plates(self) -> Any:
        """The plates: `parts`, and `assembly` with what is bought and the steps."""

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        return self.plates.parts  # type: ignore[no-any-return]

    @cached_property
    def assembly(self) -> AssemblyLike:
        """What is bought, and the steps of assembly."""
        return self.plates.assembly  # type: ignore[no-any-return]

    @property
    def forces_missing(self) -> str:
        return "" if self.aspect("loads") else self.without_loads
