"""The common base of recipes that search for a linkage: the choice of one, and the recipe made from it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from ...core.errors import DesignError
from ...core.fields import quantity, rounded_up, to_digits
from ...core.records import record
from ...core.units import marked
from ...linkage.checks import LEAST_TRANSMISSION_ANGLE_DEG
from ...linkage.kinds.linkage_kinds import EllipticTrammelRecipe, FourBarRecipe, LinkageRecipe, SliderCrankRecipe
from ...linkage.kinds.linkages import AbstractLinkageRecipe
from ...linkage.kinds.moved import BodyList
from ...linkage.linkage import AbstractLinkage, Linkage
from ...linkage.measures import grashof_type
from ...linkage.moving import move
from ...linkage.named_linkages import EllipticTrammel, FourBar, SliderCrank
from ...linkage.parts.stock import LinkStock
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Candidate, Choice, Plot, Scene, SceneCurve
from ...model.table import Table
from ...plane.vec import Complex
from ...recipe.recipe import AbstractGoal
from ...recipe.settings import Drive, Files, Stroke, Turn
from ..found import Found, Rounding

# The result type of a goal's search.
F = TypeVar("F", bound=Found)
# Number of linkages that summary.json lists.
LISTED = 20
# Positions of a linkage in its picture.
PICTURE_FRAMES = 61
# Rounding errors, as shares of the linkage's size, tried in this order until the rounded linkage passes all checks that
# the exact one passes. The first is a thousandth of manufacturing accuracy; the last is the level of rounding noise.
SHARES = tuple(10.0**-k for k in range(6, 13))
# Tolerance, relative and in deg, for limits that are missed by rounding only.
NEAR = 1e-9
# Key of a search's limit of the transmission angle, in its table `limits` or `wanted`.
LIMIT_OF_ANGLE = "least_transmission_angle_deg"
CUT_SHORT = (
    "The time limit ended the search, so its result depends on the computer: a longer one may find better linkages."
)


@record(checked=True)
class Search:
    """Seed and time limit of a search."""

    seed: int = quantity("seed of the search's random starts", default=0, at_least=0, at_most=2**32 - 1, whole=True)
    time_limit: float = quantity(
        "processor time after which the best linkage so far is taken", "s", default=30.0, above=0, at_most=3600
    )


def choose_entry() -> Any:
    """The field `choose`."""
    return quantity(
        "rank of the linkage that is made, 1 for the best; summary.json lists all",
        default=1,
        at_least=1,
        at_most=1000,
        whole=True,
    )


class AbstractLinkageGoal(AbstractGoal, Generic[F]):
    """A goal whose search ranks linkages; the chosen one becomes a recipe.

    A subclass is a record with `choose`, `drive`, `stock` and `files` that implements `ranked`, `search_limits` and
    `met_by`.
    """

    can_be_scaled: ClassVar[bool] = True
    choose: int
    drive: Drive
    stock: LinkStock

    @property
    @abstractmethod
    def ranked(self) -> Sequence[F]:
        """The linkages found, the best first."""

    @property
    def further(self) -> Sequence[F]:
        """Linkages of a further search, which have the ranks after `ranked`."""
        return ()

    @cached_property
    def found(self) -> F:
        """The chosen linkage with short decimal numbers as its sizes."""
        ranked = self.ranked
        if self.choose > len(ranked):
            ranked = (*ranked, *self.further)
        if self.choose > len(ranked):
            remedy = f"give at most {len(ranked)}, the number of linkages found"
            raise DesignError("choose", f"found {self.choose}", remedy, "out-of-range")
        return self.shortened(ranked[self.choose - 1])

    @property
    def size_bounds(self) -> Mapping[str, tuple[float, float]]:
        """Least and greatest value of bounded sizes by name, mm and deg; equal if the size is given."""
        return {}

    @property
    @abstractmethod
    def search_limits(self) -> tuple[float, float]:
        """The least transmission angle, deg, and the largest ratio of links that the search keeps."""

    def shortened(self, found: F) -> F:
        """Round a linkage to the fewest digits with which it passes every check and limit that it passed."""
        for share in SHARES:
            # About half of all roundings violate a limit that is active in the search. In this case one link is changed
            # by one unit of its last digit.
            links = [(name, units) for name in found.lengths for units in (1, -1)]
            for longer in [("", 0), *links]:
                try:
                    rounded = found.rounded(Rounding(share, found.size, self.size_bounds, longer))
                except DesignError:
                    break
                if not self._passes_same_checks(found, rounded):
                    break
                if self._keeps_limits(found, rounded):
                    return rounded
        return found

    def _passes_same_checks(self, found: F, rounded: F) -> bool:
        """Whether the rounded linkage passes every check that the found one passes, and closes if it does."""
        passed = [check.passed for check in self.met_by(rounded)]
        closes = np.isfinite([found.transmission_angle_deg, rounded.transmission_angle_deg])
        return bool(closes[0] == closes[1]) and all(
            after or not check.passed for check, after in zip(self.met_by(found), passed)
        )

    def _keeps_limits(self, found: F, rounded: F) -> bool:
        """Whether the rounded linkage has the same Grashof type and stays within the limits of the found one."""
        least, largest = self.search_limits
        angles = found.transmission_angle_deg, rounded.transmission_angle_deg
        for limit in (least, LEAST_TRANSMISSION_ANGLE_DEG):
            if angles[1] < limit - NEAR <= angles[0]:
                return False
        if rounded.ratio > largest * (1 + NEAR) >= found.ratio:
            return False
        types = [grashof_type(result.linkage) for result in (found, rounded) if isinstance(result.linkage, FourBar)]
        return len(set(types)) <= 1

    def range_of(self, found: Found) -> tuple[float, float]:
        """First and last driver position of the recipe of a linkage: deg, or mm if a slider drives."""
        low, high = found.drive_range
        if found.linkage.linkage.driven_slider is not None:
            return low, high
        # Rounded, since the conversion from radians leaves noise in the last bits.
        return to_digits(np.degrees(low), 13), to_digits(np.degrees(high), 13)

    def made_of(self, found: F) -> AbstractLinkageRecipe:
        """The recipe of a linkage."""
        return recipe_of(found.linkage, found.branch, self.range_of(found), self.drive, self.stock, self.files)

    @cached_property
    def design(self) -> AbstractLinkageRecipe:
        return self.made_of(self.found)

    @property
    def parts(self) -> tuple[Part, ...]:
        """The plates; DesignError if they cannot be made, with the rank of a linkage whose plates can."""
        try:
            return self.design.parts
        except DesignError as error:
            if not (other := self._first_cut):
                raise
            remedy = f"give choose = {other}, whose parts can be made, or {marked(error.remedy)}"
            raise DesignError(
                "choose", f"found {self.choose}: {marked(error.problem)}", remedy, error.id, other
            ) from None

    @property
    def _first_cut(self) -> int:
        """The first rank of a linkage whose parts can be made, 0 if it is not among those listed."""
        for k, found in enumerate(self.ranked[:LISTED], 1):
            with suppress(DesignError):
                _ = self.made_of(self.shortened(found)).parts
                return k
        return 0

    @abstractmethod
    def met_by(self, found: F) -> tuple[Check, ...]:
        """Checks of how well a linkage meets the requirements; nan if a defect prevents the measurement."""

    @property
    def met(self) -> tuple[Check, ...]:
        """`met_by` for the chosen linkage."""
        return self.met_by(self.found)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        defects = self.found.defects
        # If a defect prevents the measurement of an error, the defect is reported instead of a nan.
        measured = [check for check in self.met if not (defects and np.isnan(check.value))]
        advice = f"it has these defects: {', '.join(defects)}" if defects else ""
        checks = (
            replace(check, advice=self._angle_advice or check.advice) if check.id == "transmission_angle" else check
            for check in super().design_checks
        )
        return (*measured, Check("defects", "defects", len(defects), "at most", 0, "", advice), *checks)

    @property
    def _angle_advice(self) -> str:
        """Advice on the transmission angle that names the limit of the search; empty if it has none or is as high."""
        tables = (name for name in ("limits", "wanted") if hasattr(getattr(self, name, None), LIMIT_OF_ANGLE))
        least = LEAST_TRANSMISSION_ANGLE_DEG
        key = next(tables, "") if self.search_limits[0] < least else ""
        return f"give {key}.{LIMIT_OF_ANGLE} = {least:g}, so that only such linkages are listed" if key else ""

    @property
    def shown(self) -> Sequence[SceneCurve]:
        """The requirements as curves that are drawn with the mechanism."""
        return ()

    @property
    def plotted(self) -> Sequence[Plot]:
        """Plots of the goal's own columns, which come first."""
        return ()

    @property
    def choice(self) -> Choice | None:
        """The other solutions, if they form a family along one quantity."""
        return None

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """The best linkages, moving, with the paths of their traced points."""
        return tuple(
            Candidate("choose", k, _label(k, found), strokes_of(found.linkage, found.branch, found.drive_range))
            for k, found in enumerate(self.ranked[:LISTED], 1)
        )

    @cached_property
    def scene(self) -> Scene:
        """The moving linkage with the requirements."""
        found = self.design.scene
        assert found is not None
        curves, plots = (*found.curves, *self.shown), (*self.plotted, *found.plots)
        # The table of the scene also has columns of the linkage that the goal's own table lacks.
        shown = [column for column in found.table.columns if column.id not in self.table.ids]
        table = Table((*self.table.columns, *shown))
        return replace(found, table=table, curves=curves, plots=plots, choice=self.choice)

    def listed(self, found: F) -> Mapping[str, object]:
        """Entries of a ranked linkage for `summary.json`."""
        return self.shortened(found).summary()

    @property
    def notes(self) -> Mapping[str, object]:
        listed = [self.listed(found) for found in self.ranked[:LISTED]]
        return {"found": self.found.summary(), "number_found": len(self.ranked), "ranked": listed, **super().notes}


def _label(rank: int, found: Found) -> str:
    """A label that distinguishes a linkage from the others."""
    angle = f"transmission angle {found.transmission_angle_deg:.3g} deg, " if not found.defects else ""
    defects = f", with a defect of {' and '.join(found.defects)}" if found.defects else ""
    return f"{rank}: {found.bars} bars, {found.accuracy}{angle}ratio of links {found.ratio:.3g}{defects}"


def strokes_of(linkage: AbstractLinkage, branch: int, drive_range: tuple[float, float]) -> tuple[Complex, ...]:
    """Strokes of a small moving picture, mm: links at all of its positions, frame first, and paths of traced points.

    A link of more than two points is a closed stroke, its pins first.
    """
    motion = move(linkage, np.linspace(*drive_range, PICTURE_FRAMES), branch)
    general, links, paths = motion.linkage, [], []
    for body, points in general.bodies.items():
        pins, traced = (
            [motion.point(name).position for name in points if (name in general.pins) == is_pin]
            for is_pin in (True, False)
        )
        if body == general.ground:
            links.append(np.array([pin[0] for pin in pins]))
            continue
        paths += [kept for path in traced if len(kept := path[np.isfinite(path)]) > 1]
        corners = [*pins, *traced]
        links.append(np.stack([*corners, *corners[: len(corners) > 2]], axis=-1))
    return (*(link for link in links if link.shape[-1] > 1), *paths)


def recipe_of(
    linkage: AbstractLinkage, branch: int, span: tuple[float, float], drive: Drive, stock: LinkStock, files: Files
) -> AbstractLinkageRecipe:
    """The recipe of a linkage whose driver moves over the range `span`, deg, or mm if a slider drives.

    A driving slider takes the time and the number of steps of half a turn at the speed of `drive`. A negative speed
    reverses the motion; a full turn then starts at the same position.
    """
    low, high = span
    if isinstance(linkage, Linkage):
        linkage = BodyList(
            {body: {p: complex(z) for p, z in points.items()} for body, points in linkage.bodies.items()},
            linkage.driver,
            origin=complex(linkage.origin),
            ground_angle_deg=linkage.ground_angle_deg,
            meshes=linkage.meshes,
        )
    if drive.speed_rpm < 0:
        span = (low, low - 360) if linkage.linkage.driven_slider is None and high - low == 360 else (high, low)
    given: dict[str, Any] = {"linkage": linkage, "branch": branch, "stock": stock, "files": files}
    if linkage.linkage.driven_slider is None:
        given["drive"] = Turn(drive.speed_rpm, drive.step_deg, *span, drive.acceleration_rad_per_s2)
    else:
        length = high - low
        speed, acceleration = (
            to_digits(length * rate, 10) for rate in (drive.speed_rpm / 30, drive.acceleration_rad_per_s2 / np.pi)
        )
        step = float(rounded_up(length * drive.step_deg / 180))
        given["stroke"] = Stroke(*span, speed, step, acceleration)
    kinds: dict[type, type[AbstractLinkageRecipe]] = {
        FourBar: FourBarRecipe,
        BodyList: LinkageRecipe,
        SliderCrank: SliderCrankRecipe,
        EllipticTrammel: EllipticTrammelRecipe,
    }
    return kinds[type(linkage)](**given)
