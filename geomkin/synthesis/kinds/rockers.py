"""Recipes whose linkages form a family: crank-rockers, double rockers and slider-cranks from their strokes."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Literal, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError
from ...core.fields import FARTHEST, Ratio, entry, quantity, to_digits
from ...core.records import record
from ...core.units import marked, mm
from ...linkage.checks import LEAST_TRANSMISSION_ANGLE_DEG
from ...linkage.parts.stock import LinkStock
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Choice, Limit, Plot, SceneHandle, circle_handle, point_handle
from ...model.table import Column, Table
from ...plane.vec import Real, rounded
from ...recipe.settings import Drive, Files
from ..found import Found, ten_digits
from ..rockers import strokes as strokes
from ..rockers.crank_rockers import CrankRocker, check_swing_rotation, crank_rocker
from ..rockers.double_rockers import DoubleRocker, double_rocker
from ..rockers.families import LINKS, AbstractMember, turn_of
from ..rockers.strokes import StrokeCrank, slider_crank_stroke
from .linkage_goals import NEAR, AbstractLinkageGoal, choose_entry

# The result type of a search in a family.
M = TypeVar("M", bound=AbstractMember)
M_co = TypeVar("M_co", bound=AbstractMember, covariant=True)
# Largest error of a simulated swing or rotation, deg. Rounding is smaller, even for linkages at the edge of the
# possible; manufacturing errors are a thousand times larger. Derived here.
MISSED_DEG = 1e-4
# Members of a family that are ranked besides the best. More would only lie between these.
OTHERS = 19
RATIO_OF_LINKS = "longest link over the shortest"
# Compared limits of the ratio of links, and a limit above which the reported digits of the transmission angle no longer
# change.
RATIOS, LARGEST_RATIO = (3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0), 1e6


def ratio_entry(left_out: str = "6 if left out") -> Any:
    """The field `largest_ratio`."""
    return quantity(f"longest link over the shortest; {left_out}", default=None, example=None, above=1, at_most=1e6)


def free_angle_entry(meaning: str, below: float) -> Any:
    """The field `free_angle_deg`."""
    meaning = f"selects another member than the best: {meaning}"
    return quantity(meaning, "deg", default=None, above=0, below=below)


def turn_entry(example: float) -> Any:
    """The field `crank_turn_deg`."""
    meaning = "rotation of the crank during that stroke; 180 if neither this nor time_ratio is given"
    return quantity(meaning, "deg", default=None, example=example, above=0, below=360)


def time_ratio_entry() -> Any:
    """The field `time_ratio`."""
    return quantity("time of that stroke over the time of the return stroke", default=None, above=0, at_most=1e6)


class AbstractTimed:
    """Base of wanted strokes whose duration is given as a crank rotation or as a time ratio."""

    crank_turn_deg: float | None
    time_ratio: float | None

    @property
    def turn_key(self) -> str:
        """The key that was given."""
        return "crank_turn_deg" if self.time_ratio is None else "time_ratio"

    @property
    def turn_deg(self) -> float:
        """Rotation of the crank during the stroke, deg."""
        return turn_of(self.crank_turn_deg, self.time_ratio)


def rounded_error(found: float, wanted: float) -> float:
    """Error of a simulated value, rounded to digits that all processors agree on."""
    return float(rounded(abs(found - wanted), 9))


class FamilyGoal(Protocol[M_co]):
    """Requirements on a linkage, if all solutions form a family with one free angle."""

    @property
    def largest_ratio(self) -> float | None: ...

    @property
    def is_free(self) -> bool:
        """Whether the best member is searched for, because no further size is given."""

    def search(self, free_angle_deg: float | None = None) -> M_co:
        """The best linkage, the one with the given size, or the one at a given free angle, deg."""


@record(checked=True, kw_only=True)
class AbstractFamilyGoal(AbstractLinkageGoal[M]):
    """A goal that takes the best member of a family and ranks others."""

    # Sizes of `wanted` that select a member.
    sizes_of_members: ClassVar[tuple[str, ...]] = ()

    kind: str
    wanted: FamilyGoal[M]
    choose: int = choose_entry()
    drive: Drive = entry("how the crank turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.drive.check_rows()

    @cached_property
    def ranked(self) -> Sequence[M]:
        best = self.wanted.search()
        if not self.wanted.is_free:
            return (best,)
        step = -(-len(best.family.free_angle_deg) // OTHERS)
        others = [self.wanted.search(float(angle)) for angle in best.family.free_angle_deg[step // 2 :: step]]
        largest_ratio = best.largest_ratio
        return best, *sorted(
            (member for member in others if member.ratio <= largest_ratio and not member.defects), key=self.rank
        )

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        """The lengths that are given: the second pivot, and the circle of the crank about the first one."""
        ground, crank = (getattr(self.wanted, name, None) for name in ("ground", "crank"))
        pivot = () if ground is None else (point_handle("wanted.ground", at=ground),)
        return pivot if crank is None else (*pivot, circle_handle("wanted.crank", radius=crank))

    @property
    def size_bounds(self) -> Mapping[str, tuple[float, float]]:
        given = {name: getattr(self.wanted, name, None) for name in self.ranked[0].lengths}
        return {name: (size, size) for name, size in given.items() if size is not None}

    @property
    def search_limits(self) -> tuple[float, float]:
        return 0.0, self.ranked[0].largest_ratio

    def rank(self, member: M) -> tuple[float, ...]:
        """Sort key of the members; the smallest one comes first."""
        return (-float(member.transmission_angle_deg),)

    def range_of(self, found: Found) -> tuple[float, float]:
        """The full turn."""
        return 0.0, 360.0

    @property
    @abstractmethod
    def remedy(self) -> str:
        """Advice if no linkage of the family has a sufficient transmission angle."""

    @property
    def design_checks(self) -> tuple[Check, ...]:
        """Adds the ratio of links, and the reason if the ratio or the family limits the transmission angle."""
        checks = super().design_checks
        if not self.wanted.is_free:
            return checks
        ratio, largest = self.found.ratio, self.found.largest_ratio
        ratio_check = Check(
            "link_ratio",
            RATIO_OF_LINKS,
            min(ratio, largest) if ratio <= largest * (1 + NEAR) else ratio,
            "at most",
            largest,
        )
        advised = (replace(c, advice=self.why_low or c.advice) if c.id == "transmission_angle" else c for c in checks)
        return (*advised, ratio_check)

    @property
    def why_low(self) -> str:
        """The reason for a low transmission angle of the best linkage, with a remedy; empty if it is sufficient."""
        best = self.ranked[0]
        if best.transmission_angle_deg >= LEAST_TRANSMISSION_ANGLE_DEG or self.choose > 1:
            return ""
        best_angle = self.at_ratio(LARGEST_RATIO).transmission_angle_deg
        if best_angle >= LEAST_TRANSMISSION_ANGLE_DEG:
            limit = f"largest_ratio = {best.largest_ratio:g}"
            return f"{limit} limits it; longer links reach {best_angle:.4g} deg: give a larger ratio"
        return f"no linkage with this motion has more than {best_angle:.4g} deg, however long its links: {self.remedy}"

    def at_ratio(self, largest_ratio: float) -> M:
        """The best linkage with another limit of the ratio of links."""
        return replace(self.wanted, largest_ratio=largest_ratio).search()  # type: ignore[type-var]

    @property
    def trade_off(self) -> list[Mapping[str, object]]:
        """The best linkage for several limits of the ratio of links, which shows the benefit of longer links."""
        entries: list[Mapping[str, object]] = []
        for ratio in sorted({*RATIOS, self.ranked[0].largest_ratio}):
            with suppress(DesignError):
                best = self.at_ratio(ratio)
                angle, longest = (to_digits(value, 6) for value in (best.transmission_angle_deg, best.size))
                entries.append(
                    {"largest_ratio": ten_digits(ratio), "transmission_angle_deg": angle, "longest_link_mm": longest}
                )
                if not best.at_largest_ratio:
                    break
        return entries

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        try:
            return super().parts
        except DesignError as error:
            given = {name: getattr(self.wanted, name, None) for name in ("stroke", *LINKS)}
            if error.field not in self.found.lengths or given.get(error.field) is not None:
                raise
            # The length of this link follows from another key.
            key = next(name for name, size in given.items() if size is not None)
            link = (
                f"the resulting {error.field} is {mm(self.found.lengths[error.field]):g} long: {marked(error.problem)}"
            )
            is_ratio_limited = self.found.at_largest_ratio and key != "stroke"
            ratio_advice = f", a largest_ratio below {self.found.largest_ratio:g}" if is_ratio_limited else ""
            remedy = f"give a larger {key} than {mm(given[key]):g}{ratio_advice}, or a smaller stock.pin_diameter"
            raise DesignError(f"wanted.{key}", link, remedy, error.id) from None

    @property
    def choice(self) -> Choice:
        # A member at an angle has no other size given, and no rank.
        sizes = [name for name in self.sizes_of_members if getattr(self.wanted, name) is not None]
        instead = (*(f"wanted.{name}" for name in sizes), *["choose"] * (self.choose > 1))
        return replace(family_choice(self.found), key="wanted.free_angle_deg", instead_of=instead)

    @property
    def notes(self) -> Mapping[str, object]:
        ends = [to_digits(end, 10) for end in self.ranked[0].family.range_deg]
        family: dict[str, object] = {"free_angle_deg": ends}
        if self.wanted.is_free:
            family["trade_off"] = self.trade_off
        return {"family": family, **super().notes}


def family_choice(found: AbstractMember) -> Choice:
    """Transmission angle, ratio of links and lengths along the family, with the chosen linkage."""
    family = found.family
    angle = np.append(family.free_angle_deg, found.free_angle_deg)
    order = np.argsort(angle, kind="stable")
    chosen = int(np.flatnonzero(order == len(angle) - 1)[0])

    def with_chosen(members: ArrayLike, chosen_value: float) -> Real:
        values: Real = np.append(np.broadcast_to(np.asarray(members), family.free_angle_deg.shape), chosen_value)[order]
        return values

    def only_chosen(values: Real) -> Real:
        return np.where(np.arange(len(values)) == chosen, values, np.nan)

    lengths = {name: with_chosen(getattr(family.linkage, name), length) for name, length in found.lengths.items()}
    links = np.array([row for name, row in lengths.items() if name != "offset"])
    ratio = links.max(axis=0) / links.min(axis=0)
    transmission = with_chosen(family.transmission_angle_deg, found.transmission_angle_deg)
    columns = (
        Column("free_angle", "deg", "free angle of the family", angle[order]),
        Column("every_one", "deg", "least transmission angle of every member", transmission),
        Column("made", "deg", "least transmission angle of the chosen linkage", only_chosen(transmission)),
        Column("ratio_of_every_one", "", "longest link over the shortest, of every member", ratio),
        Column("ratio_of_the_made", "", "longest link over the shortest, of the chosen linkage", only_chosen(ratio)),
        *(Column(name, "mm", name, row) for name, row in lengths.items()),
    )
    least = LEAST_TRANSMISSION_ANGLE_DEG
    plots = (
        Plot(
            "least transmission angle", ("every_one", "made"), (Limit("every_one", least, f"at least {least:g} deg"),)
        ),
        Plot(
            RATIO_OF_LINKS,
            ("ratio_of_every_one", "ratio_of_the_made"),
            (Limit("ratio_of_every_one", found.largest_ratio, f"largest_ratio = {found.largest_ratio:g}"),),
        ),
        Plot("lengths", tuple(lengths)),
    )
    return Choice(Table(columns), chosen, plots)


# Largest relative error of the simulated stroke; rounding is smaller. Derived here.
MISSED = 1e-6


@record(checked=True, kw_only=True)
class WantedSwing(AbstractTimed):
    """The swing of a rocker and the crank rotation during one stroke; one length sets the size."""

    swing_deg: float = quantity(
        "swing of the rocker between its dead centres", "deg", example=50, at_least=0.1, at_most=179
    )
    crank_turn_deg: float | None = turn_entry(200)
    time_ratio: Ratio | None = time_ratio_entry()
    sense: Literal["same", "opposite"] = entry(
        "sense of the rocker in that stroke, relative to the crank", default="same"
    )
    ground: float | None = quantity(
        "distance of the ground pivots; give one length", "mm", default=None, example=100, above=0, at_most=FARTHEST
    )
    crank: float | None = quantity(
        "length of the crank, instead of the ground", "mm", default=None, above=0, at_most=FARTHEST
    )
    coupler: float | None = quantity(
        "length of the coupler, instead of the ground", "mm", default=None, above=0, at_most=FARTHEST
    )
    rocker: float | None = quantity(
        "length of the rocker, instead of the ground", "mm", default=None, above=0, at_most=FARTHEST
    )
    free_angle_deg: float | None = free_angle_entry("the angle whose tangent is crank over coupler", 45)
    largest_ratio: Ratio | None = ratio_entry("6 if left out, more for swings below 39 deg")

    def __post_init__(self) -> None:
        check_swing_rotation(self.swing_deg, self.turn_deg, self.sense, self.turn_key)
        if all(length is None for length in (self.ground, self.crank, self.coupler, self.rocker)):
            raise DesignError(
                "ground", "no length is given", "give one of ground, crank, coupler, rocker, in mm", "missing-key"
            )

    @property
    def is_free(self) -> bool:
        """Whether the best member is searched for."""
        return self.free_angle_deg is None

    def search(self, free_angle_deg: float | None = None) -> CrankRocker:
        """The best linkage or the one at the given angle; with an argument, the one at that free angle, deg."""
        return crank_rocker(
            self.swing_deg,
            self.turn_deg,
            self.ground,
            self.sense,
            crank=self.crank,
            coupler=self.coupler,
            rocker=self.rocker,
            free_angle_deg=self.free_angle_deg if free_angle_deg is None else free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@record(kw_only=True)
class CrankRockerRecipe(AbstractFamilyGoal[CrankRocker]):
    """A crank-rocker with a given swing and time ratio and the best transmission angle, with its plates and motion."""

    kind: Literal["crank-rocker-synthesis"] = "crank-rocker-synthesis"
    wanted: WantedSwing

    @property
    def remedy(self) -> str:
        return f"give a smaller swing_deg{', or a time ratio nearer to 1' if self.wanted.turn_deg != 180 else ''}"

    def met_by(self, found: CrankRocker) -> tuple[Check, ...]:
        wanted = self.wanted
        swing, turn = (
            rounded_error(found.swing_deg, wanted.swing_deg),
            rounded_error(found.crank_turn_deg, wanted.turn_deg),
        )
        return (
            Check("missed_swing", "missed swing", swing, "at most", MISSED_DEG, "deg"),
            Check("missed_crank_rotation", "missed turn of the crank", turn, "at most", MISSED_DEG, "deg"),
        )


@record(checked=True, kw_only=True)
class WantedSwings:
    """Start directions and swings of two rockers, deg from the ground line, counterclockwise positive."""

    crank_start_deg: float = quantity(
        "driving rocker's direction at the start, from its pivot", "deg", example=60, at_least=-360, at_most=360
    )
    crank_swing_deg: float = quantity(
        "swing of the driving rocker, signed", "deg", example=60, at_least=-359, at_most=359
    )
    rocker_start_deg: float = quantity(
        "driven rocker's direction at the start, from its pivot", "deg", example=80, at_least=-360, at_most=360
    )
    rocker_swing_deg: float = quantity(
        "swing of the driven rocker, signed", "deg", example=40, at_least=-359, at_most=359
    )
    ground: float = quantity("distance of the ground pivots", "mm", example=100, above=0, at_most=FARTHEST)
    crank: float | None = quantity(
        "length of the driving rocker, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    rocker: float | None = quantity(
        "length of the driven rocker, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    free_angle_deg: float | None = free_angle_entry(
        "its position between the ends of the family, instead of a length", 90
    )
    largest_ratio: Ratio | None = ratio_entry("100 if left out")

    @property
    def is_free(self) -> bool:
        """Whether the best member is searched for."""
        return self.crank is None and self.rocker is None and self.free_angle_deg is None

    def search(self, free_angle_deg: float | None = None) -> DoubleRocker:
        """The best linkage or the one with the given length or angle; with an argument, the one at that angle, deg."""
        return double_rocker(
            self.crank_start_deg,
            self.crank_swing_deg,
            self.rocker_start_deg,
            self.rocker_swing_deg,
            self.ground,
            crank=self.crank,
            rocker=self.rocker,
            free_angle_deg=self.free_angle_deg if free_angle_deg is None else free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@record(checked=True, kw_only=True)
class DoubleRockerRecipe(AbstractFamilyGoal[DoubleRocker]):
    """A four-bar that moves two rockers together between given positions with the best transmission angle."""

    kind: Literal["double-rocker-synthesis"] = "double-rocker-synthesis"
    wanted: WantedSwings
    drive: Drive = entry("how the driving rocker turns", default=Drive())

    sizes_of_members = ("crank", "rocker")
    remedy = "give smaller swings or other starts"

    def __post_init__(self) -> None:
        super().__post_init__()
        self.drive.check_rows(abs(self.wanted.crank_swing_deg) / 360)

    def rank(self, member: DoubleRocker) -> tuple[float, ...]:
        # As in the search, linkages whose rocker leaves the range between its two positions come last.
        return member.overshoot_deg > MISSED_DEG, *super().rank(member)

    def range_of(self, found: Found) -> tuple[float, float]:
        """The given range of the crank, deg."""
        start, end = self.wanted.crank_start_deg, self.wanted.crank_start_deg + self.wanted.crank_swing_deg
        return min(start, end), max(start, end)

    def met_by(self, found: DoubleRocker) -> tuple[Check, ...]:
        swing, overshoot = (
            rounded_error(found.rocker_swing_deg, self.wanted.rocker_swing_deg),
            rounded_error(found.overshoot_deg, 0.0),
        )
        return (
            Check("missed_swing", "missed swing", swing, "at most", MISSED_DEG, "deg"),
            Check(
                "rocker_overshoot",
                "rotation of the rocker beyond its positions",
                overshoot,
                "at most",
                MISSED_DEG,
                "deg",
            ),
        )


@record(checked=True, kw_only=True)
class WantedStroke(AbstractTimed):
    """The stroke of a slider, and the counterclockwise crank rotation while it moves towards +x."""

    stroke: float = quantity(
        "stroke of the slider between its dead centres", "mm", example=80, above=0, at_most=FARTHEST
    )
    crank_turn_deg: float | None = turn_entry(190)
    time_ratio: Ratio | None = time_ratio_entry()
    offset: float | None = quantity(
        "height of the slide line above the crank's pivot, instead of the best", "mm", default=None,
        at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    crank: float | None = quantity(
        "length of the crank, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    coupler: float | None = quantity(
        "length of the connecting rod, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    free_angle_deg: float | None = free_angle_entry(
        "the angle whose tangent is crank over coupler, instead of a size", 45
    )
    largest_ratio: Ratio | None = ratio_entry()

    def __post_init__(self) -> None:
        strokes.check_stroke_rotation(self.turn_deg, self.turn_key)

    @property
    def is_free(self) -> bool:
        """Whether the best member is searched for."""
        return self.offset is None and self.crank is None and self.coupler is None and self.free_angle_deg is None

    def search(self, free_angle_deg: float | None = None) -> StrokeCrank:
        """The best linkage or the one with the given size or angle; with an argument, the one at that angle, deg."""
        return slider_crank_stroke(
            self.stroke,
            self.turn_deg,
            offset=self.offset,
            crank=self.crank,
            coupler=self.coupler,
            free_angle_deg=self.free_angle_deg if free_angle_deg is None else free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@record(kw_only=True)
class SliderCrankStrokeRecipe(AbstractFamilyGoal[StrokeCrank]):
    """A slider-crank with a given stroke and time ratio and the best transmission angle, with its plates and motion."""

    kind: Literal["slider-crank-stroke"] = "slider-crank-stroke"
    wanted: WantedStroke

    sizes_of_members = ("offset", "crank", "coupler")
    remedy = "give a time ratio nearer to 1"

    def met_by(self, found: StrokeCrank) -> tuple[Check, ...]:
        wanted = self.wanted
        stroke = rounded_error(found.stroke / wanted.stroke, 1.0) * wanted.stroke
        turn = rounded_error(found.crank_turn_deg, wanted.turn_deg)
        return (
            Check("missed_stroke", "missed stroke", stroke, "at most", MISSED * wanted.stroke, "mm"),
            Check("missed_crank_rotation", "missed turn of the crank", turn, "at most", MISSED_DEG, "deg"),
        )
