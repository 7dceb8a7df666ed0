"""What recipes have in common that find a linkage: how it is chosen, and the recipe that is made of it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from ..cached import cached_property
from ..check import Check
from ..errors import DesignError
from ..linkage.bars import FourBar
from ..linkage.linkage import AbstractLinkage
from ..linkage.sliders import EllipticTrammel, SliderCrank
from ..recipe.recipe import AbstractGoal
from ..recipe.settings import Drive, Files, Stroke, Turn
from ..scene import Choice, Plot, Scene, SceneCurve
from ..shop.linkage.stock import LinkStock
from ..sizes import check_sizes, quantity
from ..synthesis.found import Found
from .linkages import AbstractLinkageRecipe, EllipticTrammelRecipe, FourBarRecipe, SliderCrankRecipe

# What a goal's search finds.
F = TypeVar("F", bound=Found)
# Linkages that summary.json lists: more are a table that nobody reads.
LISTED = 20


@dataclass(frozen=True)
class Search:
    """How long to look, and from where."""

    seed: int = quantity("of the search's random starts", default=0, at_least=0, at_most=2**32 - 1, whole=True)
    seconds: float = quantity("after which the best so far is taken", "s", default=10.0, above=0, at_most=3600)

    def __post_init__(self) -> None:
        check_sizes(self)


def choose_entry() -> Any:
    """Which of the ranked linkages is made."""
    return quantity(
        "which of the linkages found is made, 1 the best; summary.json lists them",
        default=1,
        at_least=1,
        at_most=1000,
        whole=True,
    )


class AbstractLinkageGoal(AbstractGoal, Generic[F]):
    """A goal whose search ranks linkages: one is chosen, and becomes a recipe of its own.

    A subclass is a dataclass with `choose`, `drive`, `stock` and `files`, and says what was found.
    """

    can_be_scaled: ClassVar[bool] = True
    choose: int
    drive: Drive
    stock: LinkStock

    @property
    @abstractmethod
    def ranked(self) -> Sequence[F]:
        """What was found, the best first."""

    @cached_property
    def found(self) -> F:
        """The one that is made."""
        if self.choose > len(self.ranked):
            raise DesignError("choose", f"found {self.choose}", f"give at most {len(self.ranked)}: so many were found")
        return self.ranked[self.choose - 1]

    @property
    def way(self) -> tuple[float, float]:
        """The driver's first and last place in the recipe that is made: deg, or mm where a slide drives."""
        low, high = float(np.min(self.found.drive)), float(np.max(self.found.drive))
        slides = self.found.linkage.linkage.driven_slider is not None
        return (low, high) if slides else (float(np.degrees(low)), float(np.degrees(high)))

    @cached_property
    def design(self) -> AbstractLinkageRecipe:
        return recipe_of(self.found.linkage, self.found.branch, self.way, self.drive, self.stock, self.files)

    @property
    @abstractmethod
    def met(self) -> tuple[Check, ...]:
        """How near the linkage comes to what was wanted; nan where a defect keeps it from being told."""

    @property
    def judged(self) -> tuple[Check, ...]:
        defects = self.found.defects
        # A linkage that cannot go the whole way has no swing to miss: the defect says so, and a nan would say nothing.
        told = [check for check in self.met if not (defects and np.isnan(check.value))]
        advice = f"it has a defect of {', '.join(defects)}" if defects else ""
        return (*told, Check("defects", len(defects), "at most", 0, "", advice), *super().judged)

    @property
    def shown(self) -> Sequence[SceneCurve]:
        """What was wanted, as curves to be drawn with the mechanism."""
        return ()

    @property
    def plotted(self) -> Sequence[Plot]:
        """Plots of the goal's own columns, which come first."""
        return ()

    @property
    def choice(self) -> Choice | None:
        """What there was to choose from, where it lies along one quantity."""
        return None

    @cached_property
    def scene(self) -> Scene:
        """The linkage that was found, moving, with what was wanted of it."""
        found = self.design.scene
        assert found is not None
        curves, plots = (*found.curves, *self.shown), (*self.plotted, *found.plots)
        return replace(found, table=self.table, curves=curves, plots=plots, choice=self.choice)

    @property
    def notes(self) -> Mapping[str, object]:
        listed = [found.summary() for found in self.ranked[:LISTED]]
        return {"found": self.found.summary(), "number_found": len(self.ranked), "ranked": listed, **super().notes}


def recipe_of(
    linkage: AbstractLinkage, branch: int, way: tuple[float, float], drive: Drive, stock: LinkStock, files: Files
) -> AbstractLinkageRecipe:
    """The recipe of a linkage that goes `way`, deg, or mm where a slide drives.

    A slide goes there in the time of half a turn of the speed that `drive` gives, in as many steps. Where that speed is
    negative the way is gone backwards, a whole turn from its start on.
    """
    low, high = way
    if drive.speed_rpm < 0:
        way = (low, low - 360) if linkage.linkage.driven_slider is None and high - low == 360 else (high, low)
    given: dict[str, Any] = {"linkage": linkage, "branch": branch, "stock": stock, "files": files}
    if linkage.linkage.driven_slider is None:
        given["drive"] = Turn(drive.speed_rpm, drive.step_deg, *way, drive.acceleration_rad_per_s2)
    else:
        length = high - low
        given["stroke"] = Stroke(
            *way,
            length * drive.speed_rpm / 30,
            length * drive.step_deg / 180,
            length * drive.acceleration_rad_per_s2 / np.pi,
        )
    kinds: dict[type, type[AbstractLinkageRecipe]] = {
        FourBar: FourBarRecipe,
        SliderCrank: SliderCrankRecipe,
        EllipticTrammel: EllipticTrammelRecipe,
    }
    return kinds[type(linkage)](**given)
