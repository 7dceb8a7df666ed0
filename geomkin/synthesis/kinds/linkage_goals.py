"""What recipes have in common that find a linkage: how it is chosen, and the recipe that is made of it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from ...core.errors import DesignError
from ...core.fields import quantity, rounded_up
from ...core.records import record
from ...linkage.checks import LEAST_TRANSMISSION_ANGLE_DEG
from ...linkage.kinds.linkages import AbstractLinkageRecipe, EllipticTrammelRecipe, FourBarRecipe, SliderCrankRecipe
from ...linkage.linkage import AbstractLinkage
from ...linkage.measures import grashof_type
from ...linkage.named_linkages import EllipticTrammel, FourBar, SliderCrank
from ...linkage.parts.stock import LinkStock
from ...model.check import Check
from ...model.scene import Choice, Plot, Scene, SceneCurve
from ...recipe.recipe import AbstractGoal
from ...recipe.settings import Drive, Files, Stroke, Turn
from ..found import Found
from ..rounding import Rounding

# What a goal's search finds.
F = TypeVar("F", bound=Found)
# Linkages that summary.json lists: more are a table that nobody reads.
LISTED = 20
# Errors of rounding, as shares of the linkage's size, one after the other until nothing that was kept is lost. The
# first is a thousandth of what anybody can cut; the last leaves no more than rounding.
SHARES = tuple(10.0**-k for k in range(6, 13))
# Share, and deg, by which a limit may be missed for rounding.
NEAR = 1e-9


@record(checked=True)
class Search:
    """How long to look, and from where."""

    seed: int = quantity("of the search's random starts", default=0, at_least=0, at_most=2**32 - 1, whole=True)
    time_limit: float = quantity("after which the best so far is taken", "s", default=10.0, above=0, at_most=3600)


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
        """The one that is made, in short decimal numbers."""
        if self.choose > len(self.ranked):
            raise DesignError("choose", f"found {self.choose}", f"give at most {len(self.ranked)}: so many were found")
        return self.shortened(self.ranked[self.choose - 1])

    @property
    def size_bounds(self) -> Mapping[str, tuple[float, float]]:
        """Least and greatest value of the sizes that are bounded, by name, mm and deg; both alike if one is given."""
        return {}

    @property
    @abstractmethod
    def search_limits(self) -> tuple[float, float]:
        """The least transmission angle, deg, and the largest ratio of links that the search keeps."""

    def shortened(self, found: F) -> F:
        """A linkage rounded to the fewest digits with which it still keeps every check and limit that it kept."""
        for share in SHARES:
            # A limit that the search stands on is kept by every second rounding: else one link takes another digit.
            links = [(name, units) for name in found.lengths for units in (1, -1)]
            for longer in [("", 0), *links]:
                try:
                    other = found.rounded(Rounding(share, found.size, self.size_bounds, longer))
                except DesignError:
                    break
                if not self._does_as_much(found, other):
                    break
                if self._keeps_limits(found, other):
                    return other
        return found

    def _does_as_much(self, found: F, other: F) -> bool:
        """Whether another linkage passes the goal's own checks that the one found passes, and closes as it does."""
        passed = [check.passed for check in self.met_by(other)]
        closes = np.isfinite([found.transmission_angle_deg, other.transmission_angle_deg])
        return bool(closes[0] == closes[1]) and all(
            after or not check.passed for check, after in zip(self.met_by(found), passed)
        )

    def _keeps_limits(self, found: F, other: F) -> bool:
        """Whether another linkage is of the same Grashof type and within the limits that the one found is within."""
        least, largest = self.search_limits
        angles = found.transmission_angle_deg, other.transmission_angle_deg
        for limit in (least, LEAST_TRANSMISSION_ANGLE_DEG):
            if angles[1] < limit - NEAR <= angles[0]:
                return False
        if other.ratio > largest * (1 + NEAR) >= found.ratio:
            return False
        types = [grashof_type(one.linkage) for one in (found, other) if isinstance(one.linkage, FourBar)]
        return len(set(types)) <= 1

    @property
    def way(self) -> tuple[float, float]:
        """The driver's first and last place in the recipe that is made: deg, or mm where a slide drives."""
        low, high = self.found.drive_range
        if self.found.linkage.linkage.driven_slider is not None:
            return low, high
        # Without the last bits, which the turn from radians adds.
        return float(f"{np.degrees(low):.13g}"), float(f"{np.degrees(high):.13g}")

    @cached_property
    def design(self) -> AbstractLinkageRecipe:
        return recipe_of(self.found.linkage, self.found.branch, self.way, self.drive, self.stock, self.files)

    @abstractmethod
    def met_by(self, found: F) -> tuple[Check, ...]:
        """How near a linkage comes to what was wanted; nan where a defect keeps it from being told."""

    @property
    def met(self) -> tuple[Check, ...]:
        """The same of the one that is made."""
        return self.met_by(self.found)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        defects = self.found.defects
        # A linkage that cannot go the whole way has no swing to miss: the defect says so, and a nan would say nothing.
        told = [check for check in self.met if not (defects and np.isnan(check.value))]
        advice = f"it has a defect of {', '.join(defects)}" if defects else ""
        return (*told, Check("defects", "defects", len(defects), "at most", 0, "", advice), *super().design_checks)

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
        listed = [self.shortened(found).summary() for found in self.ranked[:LISTED]]
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
        speed, acceleration = (
            float(f"{length * rate:.10g}") for rate in (drive.speed_rpm / 30, drive.acceleration_rad_per_s2 / np.pi)
        )
        step = float(rounded_up(length * drive.step_deg / 180))
        given["stroke"] = Stroke(*way, speed, step, acceleration)
    kinds: dict[type, type[AbstractLinkageRecipe]] = {
        FourBar: FourBarRecipe,
        SliderCrank: SliderCrankRecipe,
        EllipticTrammel: EllipticTrammelRecipe,
    }
    return kinds[type(linkage)](**given)
