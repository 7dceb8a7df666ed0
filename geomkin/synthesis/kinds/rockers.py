"""What goals have in common whose linkages are a family: their keys, the best of it, and what it was chosen from."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any, Literal, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity
from ...core.records import record
from ...linkage.checks import LEAST_TRANSMISSION_ANGLE_DEG
from ...linkage.parts.stock import LinkStock
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Choice, Limit, Plot
from ...model.table import Column, Table
from ...plane.vec import Real, rounded
from ...recipe.settings import Drive, Files
from ..found import ten_digits
from ..rockers import strokes as strokes
from ..rockers.crank_rockers import CrankRocker, check_turn, crank_rocker
from ..rockers.double_rockers import DoubleRocker, double_rocker
from ..rockers.families import LINKS, AbstractMember, turn_of
from ..rockers.strokes import StrokeCrank, slider_crank_stroke
from .linkage_goals import NEAR, AbstractLinkageGoal, choose_entry

# What a search in a family finds.
M = TypeVar("M", bound=AbstractMember)
M_co = TypeVar("M_co", bound=AbstractMember, covariant=True)
# deg. What a simulated swing or turn may miss of the one wanted: rounding is less, of linkages at the edge of what
# there is a little less; whoever cuts them misses more by a thousand times. Derived here.
MISSED_DEG = 1e-4
# Members of a family that are ranked besides the best. More are only more of the same between them.
OTHERS = 19
RATIO_OF_LINKS = "longest link over the shortest"
# Largest ratios of links whose best linkages are compared, and one beyond which no angle grows by what is told.
RATIOS, LARGEST_RATIO = (3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0), 1e6


def ratio_entry(left_out: str = "6 where left out") -> Any:
    """How unlike the links of the best may be."""
    return quantity(f"longest link over the shortest; {left_out}", default=None, example=None, above=1, at_most=1e6)


def turn_entry(example: float) -> Any:
    """The crank's turn in the stroke that is told."""
    meaning = "crank's turn in that stroke; 180 where neither this nor time_ratio is given"
    return quantity(meaning, "deg", default=None, example=example, above=0, below=360)


def time_ratio_entry() -> Any:
    """The same as a ratio of times."""
    return quantity("time of that stroke over the time of the stroke back", default=None, above=0, at_most=1e6)


class AbstractTimed:
    """What is wanted of a crank that takes its time for a stroke: its turn, or a ratio of times."""

    crank_turn_deg: float | None
    time_ratio: float | None

    @property
    def turn_key(self) -> str:
        """The key that tells the turn."""
        return "crank_turn_deg" if self.time_ratio is None else "time_ratio"

    @property
    def turn_deg(self) -> float:
        """The crank's turn in that stroke, deg."""
        return turn_of(self.crank_turn_deg, self.time_ratio)


def missed(found: float, wanted: float) -> float:
    """How far what was simulated is off, without the last digits, in which processors differ."""
    return float(rounded(abs(found - wanted), 9))


class Wanted(Protocol[M_co]):
    """What is wanted of a linkage that has a family: all that do it, told apart by one angle."""

    @property
    def largest_ratio(self) -> float | None: ...

    @property
    def is_free(self) -> bool:
        """Whether the best of the family is looked for."""

    def search(self, free_angle_deg: float | None = None) -> M_co:
        """The best or the one with the sizes that are given, or the one at a free angle."""


@record(checked=True, kw_only=True)
class AbstractFamilyGoal(AbstractLinkageGoal[M]):
    """A goal that takes the best of a family, and ranks others of it."""

    kind: str
    wanted: Wanted[M]
    choose: int = choose_entry()
    drive: Drive = entry("how the crank turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        self.drive.check_rows()

    @cached_property
    def ranked(self) -> Sequence[M]:
        best = self.wanted.search()
        if not self.wanted.is_free:
            return (best,)
        step = -(-len(best.family.free_angle_deg) // OTHERS)
        others = [self.wanted.search(float(angle)) for angle in best.family.free_angle_deg[step // 2 :: step]]
        most = best.largest_ratio
        return best, *sorted((one for one in others if one.ratio <= most and not one.defects), key=self.rank)

    @property
    def size_bounds(self) -> Mapping[str, tuple[float, float]]:
        given = {name: getattr(self.wanted, name, None) for name in self.ranked[0].lengths}
        return {name: (size, size) for name, size in given.items() if size is not None}

    @property
    def search_limits(self) -> tuple[float, float]:
        return 0.0, self.ranked[0].largest_ratio

    def rank(self, one: M) -> tuple[float, ...]:
        """The less, the better."""
        return (-float(one.transmission_angle_deg),)

    @property
    def way(self) -> tuple[float, float]:
        """The full turn."""
        return 0.0, 360.0

    @property
    @abstractmethod
    def remedy(self) -> str:
        """What to do if no linkage of the family drives well."""

    @property
    def design_checks(self) -> tuple[Check, ...]:
        """With the bound of the links' ratio, and the reason if it or the family keeps the transmission angle low."""
        checks = super().design_checks
        if not self.wanted.is_free:
            return checks
        ratio, largest = self.found.ratio, self.found.largest_ratio
        bound = Check(
            "link_ratio",
            RATIO_OF_LINKS,
            min(ratio, largest) if ratio <= largest * (1 + NEAR) else ratio,
            "at most",
            largest,
        )
        told = (replace(c, advice=self.why_low or c.advice) if c.id == "transmission_angle" else c for c in checks)
        return (*told, bound)

    @property
    def why_low(self) -> str:
        """What keeps the best below the transmission angle that it should have, and what to do; empty if it is not."""
        best = self.ranked[0]
        if best.transmission_angle_deg >= LEAST_TRANSMISSION_ANGLE_DEG or self.choose > 1:
            return ""
        most = self.at_ratio(LARGEST_RATIO).transmission_angle_deg
        if most >= LEAST_TRANSMISSION_ANGLE_DEG:
            held = f"largest_ratio = {best.largest_ratio:g}"
            return f"{held} keeps it low, longer links reach {most:.4g} deg: give a larger one"
        return (
            f"no linkage that does what is wanted has more than {most:.4g} deg, however long its links: {self.remedy}"
        )

    def at_ratio(self, largest_ratio: float) -> M:
        """The best with another bound of the links' ratio."""
        return replace(self.wanted, largest_ratio=largest_ratio).search()  # type: ignore[type-var]

    @property
    def trade_off(self) -> list[Mapping[str, object]]:
        """The best of several bounds of the links' ratio: how much transmission angle longer links bring."""
        told: list[Mapping[str, object]] = []
        for ratio in sorted({*RATIOS, self.ranked[0].largest_ratio}):
            with suppress(DesignError):
                best = self.at_ratio(ratio)
                angle, longest = (float(f"{value:.6g}") for value in (best.transmission_angle_deg, best.size))
                told.append(
                    {"largest_ratio": ten_digits(ratio), "transmission_angle_deg": angle, "longest_link_mm": longest}
                )
                if not best.at_largest_ratio:
                    break
        return told

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        try:
            return super().parts
        except DesignError as error:
            given = {name: getattr(self.wanted, name, None) for name in ("stroke", *LINKS)}
            if error.field not in self.found.lengths or given.get(error.field) is not None:
                raise
            # The link was found: what sets its length is another key.
            key = next(name for name, size in given.items() if size is not None)
            link = f"the {error.field} that was found is {self.found.lengths[error.field]:g} mm long: {error.problem}"
            held = self.found.at_largest_ratio and key != "stroke"
            ratio = f", a largest_ratio below {self.found.largest_ratio:g}" if held else ""
            remedy = f"give a larger {key} than {given[key]:g} mm{ratio}, or a smaller stock.pin_diameter"
            raise DesignError(f"wanted.{key}", link, remedy) from None

    @property
    def choice(self) -> Choice:
        return family_choice(self.found)

    @property
    def notes(self) -> Mapping[str, object]:
        ends = [float(f"{end:.10g}") for end in self.ranked[0].family.range_deg]
        family: dict[str, object] = {"free_angle_deg": ends}
        if self.wanted.is_free:
            family["trade_off"] = self.trade_off
        return {"family": family, **super().notes}


def family_choice(found: AbstractMember) -> Choice:
    """Transmission angles, ratios of the links and their lengths along the family, with the one that was found."""
    family = found.family
    angle = np.append(family.free_angle_deg, found.free_angle_deg)
    order = np.argsort(angle, kind="stable")
    chosen = int(np.flatnonzero(order == len(angle) - 1)[0])

    def along(members: ArrayLike, own: float) -> Real:
        every: Real = np.append(np.broadcast_to(np.asarray(members), family.free_angle_deg.shape), own)[order]
        return every

    def made(values: Real) -> Real:
        return np.where(np.arange(len(values)) == chosen, values, np.nan)

    lengths = {name: along(getattr(family.linkage, name), length) for name, length in found.lengths.items()}
    links = np.array([row for name, row in lengths.items() if name != "offset"])
    ratio = links.max(axis=0) / links.min(axis=0)
    transmission = along(family.transmission_angle_deg, found.transmission_angle_deg)
    columns = (
        Column("free_angle", "deg", "angle that stays free", angle[order]),
        Column("every_one", "deg", "least transmission angle of each", transmission),
        Column("made", "deg", "least transmission angle of the one that is made", made(transmission)),
        Column("ratio_of_every_one", "", "longest link over the shortest, of each", ratio),
        Column("ratio_of_the_made", "", "longest link over the shortest, of the one that is made", made(ratio)),
        *(Column(name, "mm", name, row) for name, row in lengths.items()),
    )
    least = LEAST_TRANSMISSION_ANGLE_DEG
    plots = (
        Plot(
            "least transmission angle",
            ("every_one", "made"),
            (Limit("every_one", least, f"at least {least:g} deg"),),
        ),
        Plot(
            RATIO_OF_LINKS,
            ("ratio_of_every_one", "ratio_of_the_made"),
            (Limit("ratio_of_every_one", found.largest_ratio, f"largest_ratio = {found.largest_ratio:g}"),),
        ),
        Plot("lengths", tuple(lengths)),
    )
    return Choice(Table(columns), chosen, plots)


# Share of the stroke that the simulated one may miss: rounding is less. Derived here.
MISSED = 1e-6


@record(checked=True, kw_only=True)
class WantedSwing(AbstractTimed):
    """How a rocker swings, and how far a crank turns meanwhile; one length sets the size."""

    swing_deg: float = quantity("of the rocker, there and back", "deg", example=50, at_least=0.1, at_most=179)
    crank_turn_deg: float | None = turn_entry(200)
    time_ratio: float | None = time_ratio_entry()
    sense: Literal["same", "opposite"] = entry("of the rocker in that stroke, against the crank's", default="same")
    ground: float | None = quantity(
        "distance of the ground pivots; give one length", "mm", default=None, example=100, above=0, at_most=FARTHEST
    )
    crank: float | None = quantity("length of the crank, or this", "mm", default=None, above=0, at_most=FARTHEST)
    coupler: float | None = quantity("length of the coupler, or this", "mm", default=None, above=0, at_most=FARTHEST)
    rocker: float | None = quantity("length of the rocker, or this", "mm", default=None, above=0, at_most=FARTHEST)
    free_angle_deg: float | None = quantity(
        "another than the best: the angle whose tangent is crank over coupler", "deg", default=None, above=0, below=45
    )
    largest_ratio: float | None = ratio_entry("6 where left out, more for swings below 39 deg")

    def __post_init__(self) -> None:
        check_turn(self.swing_deg, self.turn_deg, self.sense, self.turn_key)
        if all(length is None for length in (self.ground, self.crank, self.coupler, self.rocker)):
            raise DesignError("ground", "no length is given", "give one of ground, crank, coupler, rocker, in mm")

    @property
    def is_free(self) -> bool:
        """Whether the best is looked for."""
        return self.free_angle_deg is None

    def search(self, free_angle_deg: float | None = None) -> CrankRocker:
        """The best or the one at the angle that is given, or the one at a free angle."""
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
    """The crank-rocker of a swing and a time ratio that drives best, found and made: plates and motion."""

    kind: Literal["crank-rocker-synthesis"] = "crank-rocker-synthesis"
    wanted: WantedSwing

    @property
    def remedy(self) -> str:
        return f"give a smaller swing_deg{', or a time ratio nearer to 1' if self.wanted.turn_deg != 180 else ''}"

    def met_by(self, found: CrankRocker) -> tuple[Check, ...]:
        wanted = self.wanted
        swing, turn = missed(found.swing_deg, wanted.swing_deg), missed(found.crank_turn_deg, wanted.turn_deg)
        return (
            Check("missed_swing", "missed swing", swing, "at most", MISSED_DEG, "deg"),
            Check("missed_crank_rotation", "missed turn of the crank", turn, "at most", MISSED_DEG, "deg"),
        )


@record(checked=True, kw_only=True)
class WantedSwings:
    """Where two rockers begin and how far they swing, deg from the ground line, counterclockwise positive."""

    crank_start_deg: float = quantity(
        "driving rocker's direction at the start, from its pivot", "deg", example=60, at_least=-360, at_most=360
    )
    crank_swing_deg: float = quantity("its swing, signed", "deg", example=60, at_least=-359, at_most=359)
    rocker_start_deg: float = quantity(
        "driven rocker's direction at the start, from its pivot", "deg", example=80, at_least=-360, at_most=360
    )
    rocker_swing_deg: float = quantity("its swing, signed", "deg", example=40, at_least=-359, at_most=359)
    ground: float = quantity("distance of the ground pivots", "mm", example=100, above=0, at_most=FARTHEST)
    crank: float | None = quantity(
        "length of the driving rocker, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    rocker: float | None = quantity(
        "length of the driven rocker, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    largest_ratio: float | None = ratio_entry("100 where left out")

    @property
    def is_free(self) -> bool:
        """Whether the best is looked for."""
        return self.crank is None and self.rocker is None

    def search(self, free_angle_deg: float | None = None) -> DoubleRocker:
        """The best or the one with the length that is given, or, where none is, the one at a free angle."""
        return double_rocker(
            self.crank_start_deg,
            self.crank_swing_deg,
            self.rocker_start_deg,
            self.rocker_swing_deg,
            self.ground,
            crank=self.crank,
            rocker=self.rocker,
            free_angle_deg=free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@record(checked=True, kw_only=True)
class DoubleRockerRecipe(AbstractFamilyGoal[DoubleRocker]):
    """Two rockers that swing together from given places, as the four-bar that drives best: found and made."""

    kind: Literal["double-rocker-synthesis"] = "double-rocker-synthesis"
    wanted: WantedSwings
    drive: Drive = entry("how the driving rocker turns", default=Drive())

    remedy = "give smaller swings or other starts"

    def __post_init__(self) -> None:
        self.drive.check_rows(abs(self.wanted.crank_swing_deg) / 360)

    def rank(self, one: DoubleRocker) -> tuple[float, ...]:
        # As the search does: those that go beyond their places come behind those that do not.
        return one.overshoot_deg > MISSED_DEG, *super().rank(one)

    @property
    def way(self) -> tuple[float, float]:
        """The crank's, as it was given."""
        start, end = self.wanted.crank_start_deg, self.wanted.crank_start_deg + self.wanted.crank_swing_deg
        return min(start, end), max(start, end)

    def met_by(self, found: DoubleRocker) -> tuple[Check, ...]:
        swing, beyond = missed(found.rocker_swing_deg, self.wanted.rocker_swing_deg), missed(found.overshoot_deg, 0.0)
        return (
            Check("missed_swing", "missed swing", swing, "at most", MISSED_DEG, "deg"),
            Check("rocker_overshoot", "rocker's way beyond its places", beyond, "at most", MISSED_DEG, "deg"),
        )


@record(checked=True, kw_only=True)
class WantedStroke(AbstractTimed):
    """How far a slider goes, and how far the crank turns, counterclockwise, while it goes towards +x."""

    stroke: float = quantity("of the slider, there and back", "mm", example=80, above=0, at_most=FARTHEST)
    crank_turn_deg: float | None = turn_entry(190)
    time_ratio: float | None = time_ratio_entry()
    offset: float | None = quantity(
        "height of the slide line above the crank's pivot, instead of the best",
        "mm",
        default=None,
        at_least=-FARTHEST,
        at_most=FARTHEST,
    )
    crank: float | None = quantity(
        "length of the crank, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    coupler: float | None = quantity(
        "length of the connecting rod, instead of the best", "mm", default=None, above=0, at_most=FARTHEST
    )
    largest_ratio: float | None = ratio_entry()

    def __post_init__(self) -> None:
        strokes.check_turn(self.turn_deg, self.turn_key)

    @property
    def is_free(self) -> bool:
        """Whether the best is looked for."""
        return self.offset is None and self.crank is None and self.coupler is None

    def search(self, free_angle_deg: float | None = None) -> StrokeCrank:
        """The best or the one with the size that is given, or, where none is, the one at a free angle."""
        return slider_crank_stroke(
            self.stroke,
            self.turn_deg,
            offset=self.offset,
            crank=self.crank,
            coupler=self.coupler,
            free_angle_deg=free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@record(kw_only=True)
class SliderCrankStrokeRecipe(AbstractFamilyGoal[StrokeCrank]):
    """The slider-crank of a stroke and a time ratio that drives best, found and made: plates and motion."""

    kind: Literal["slider-crank-stroke"] = "slider-crank-stroke"
    wanted: WantedStroke

    remedy = "give a time ratio nearer to 1"

    def met_by(self, found: StrokeCrank) -> tuple[Check, ...]:
        wanted = self.wanted
        stroke = missed(found.stroke / wanted.stroke, 1.0) * wanted.stroke
        turn = missed(found.crank_turn_deg, wanted.turn_deg)
        return (
            Check("missed_stroke", "missed stroke", stroke, "at most", MISSED * wanted.stroke, "mm"),
            Check("missed_crank_rotation", "missed turn of the crank", turn, "at most", MISSED_DEG, "deg"),
        )
