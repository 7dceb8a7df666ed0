"""Goals of rockers that swing: the crank-rocker of a swing and a crank's turn, and two rockers that swing together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from ..check import Check
from ..errors import DesignError
from ..plane.vec import rounded
from ..recipe.settings import Drive, Files
from ..scene import Choice
from ..shop.linkage.stock import LinkStock
from ..sizes import FARTHEST, check_sizes, entry, quantity
from ..synthesis.rockers.crank_rockers import CrankRocker, check_turn, crank_rocker
from ..synthesis.rockers.double_rockers import DoubleRocker, double_rocker
from ..synthesis.rockers.families import RATIO, Family
from .families import family_choice
from .linkage_goals import AbstractLinkageGoal, choose_entry

# deg. What a simulated swing or turn may miss of the one wanted: rounding is less, of linkages at the edge of what
# there is a little less; whoever cuts them misses more by a thousand times. Derived here.
MISSED_DEG = 1e-4
# Members of a family that are ranked besides the best. More are only more of the same between them.
OTHERS = 19


def ratio_entry() -> Any:
    """How unlike the links of the best may be."""
    return quantity(
        "longest link over the shortest; 100 where left out", default=None, example=None, above=1, at_most=1e6
    )


def turn_entry(example: float) -> Any:
    """The crank's turn in the stroke that is told."""
    meaning = "crank's turn in that stroke; 180 where neither this nor time_ratio is given"
    return quantity(meaning, "deg", default=None, example=example, above=0, below=360)


def time_ratio_entry() -> Any:
    """The same as a ratio of times."""
    return quantity("time of that stroke over the time of the stroke back", default=None, above=0, at_most=1e6)


def crank_turn_of(crank_turn_deg: float | None, time_ratio: float | None) -> float:
    """The crank's turn, deg, from whichever of the two is given."""
    if time_ratio is not None and crank_turn_deg is not None:
        raise DesignError("time_ratio", "is given besides crank_turn_deg", "give one of them, which tells the other")
    if time_ratio is not None:
        return 360 * time_ratio / (1 + time_ratio)
    return 180.0 if crank_turn_deg is None else crank_turn_deg


def missed(found: float, wanted: float) -> float:
    """How far what was simulated is off, without the last digits, in which processors differ."""
    return float(rounded(abs(found - wanted), 9))


def spread(family: Family) -> Sequence[float]:
    """Free angles, deg, of the members that are ranked besides the best."""
    step = -(-len(family.free_angle_deg) // OTHERS)
    return [float(angle) for angle in family.free_angle_deg[step // 2 :: step]]


def told_family(family: Family) -> Mapping[str, object]:
    """The family as `summary.json` tells it."""
    return {"free_angle_deg": [float(f"{end:.10g}") for end in family.range_deg]}


@dataclass(frozen=True, kw_only=True)
class WantedSwing:
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
    largest_ratio: float | None = ratio_entry()

    def __post_init__(self) -> None:
        check_sizes(self)
        field = "crank_turn_deg" if self.time_ratio is None else "time_ratio"
        check_turn(self.swing_deg, self.turn_deg, self.sense, field)
        if all(length is None for length in (self.ground, self.crank, self.coupler, self.rocker)):
            raise DesignError("ground", "no length is given", "give one of ground, crank, coupler, rocker, in mm")

    @property
    def turn_deg(self) -> float:
        """The crank's, in the stroke that is told."""
        return crank_turn_of(self.crank_turn_deg, self.time_ratio)

    def search(self, free_angle_deg: float | None) -> CrankRocker:
        """The best, or the one at a free angle."""
        return crank_rocker(
            self.swing_deg,
            self.turn_deg,
            self.ground,
            self.sense,
            crank=self.crank,
            coupler=self.coupler,
            rocker=self.rocker,
            free_angle_deg=free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@dataclass(frozen=True, kw_only=True)
class CrankRockerRecipe(AbstractLinkageGoal[CrankRocker]):
    """The crank-rocker of a swing and a time ratio that drives best, found and made: plates and motion."""

    kind: Literal["crank-rocker"] = "crank-rocker"
    wanted: WantedSwing
    choose: int = choose_entry()
    drive: Drive = entry("how the crank turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows()

    @cached_property
    def ranked(self) -> Sequence[CrankRocker]:
        best = self.wanted.search(self.wanted.free_angle_deg)
        if self.wanted.free_angle_deg is not None:
            return (best,)
        others = [self.wanted.search(angle) for angle in spread(best.family)]
        return best, *by_transmission(others, self.wanted.largest_ratio)

    @property
    def way(self) -> tuple[float, float]:
        """The full turn."""
        return 0.0, 360.0

    @property
    def met(self) -> tuple[Check, ...]:
        found, wanted = self.found, self.wanted
        swing, turn = missed(found.swing_deg, wanted.swing_deg), missed(found.crank_turn_deg, wanted.turn_deg)
        return (
            Check("missed swing", swing, "at most", MISSED_DEG, "deg"),
            Check("missed turn of the crank", turn, "at most", MISSED_DEG, "deg"),
        )

    @property
    def choice(self) -> Choice:
        return family_choice(self.found, self.wanted.largest_ratio)

    @property
    def notes(self) -> Mapping[str, object]:
        return {"family": told_family(self.ranked[0].family), **super().notes}


def by_transmission(found: Sequence[Any], largest_ratio: float | None) -> Sequence[Any]:
    """Those without a defect whose links are not too unlike, the best drive first."""
    most = RATIO if largest_ratio is None else largest_ratio
    good = [one for one in found if one.ratio <= most and not one.defects]
    return sorted(good, key=lambda one: -float(one.transmission_angle_deg))


@dataclass(frozen=True, kw_only=True)
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
    largest_ratio: float | None = ratio_entry()

    def __post_init__(self) -> None:
        check_sizes(self)

    def search(self, free_angle_deg: float | None = None) -> DoubleRocker:
        """The best or the one with the length that is given, or the one at a free angle."""
        asked = free_angle_deg is None
        return double_rocker(
            self.crank_start_deg,
            self.crank_swing_deg,
            self.rocker_start_deg,
            self.rocker_swing_deg,
            self.ground,
            crank=self.crank if asked else None,
            rocker=self.rocker if asked else None,
            free_angle_deg=free_angle_deg,
            largest_ratio=self.largest_ratio,
        )


@dataclass(frozen=True, kw_only=True)
class DoubleRockerRecipe(AbstractLinkageGoal[DoubleRocker]):
    """Two rockers that swing together from given places, as the four-bar that drives best: found and made."""

    kind: Literal["double-rocker"] = "double-rocker"
    wanted: WantedSwings
    choose: int = choose_entry()
    drive: Drive = entry("how the driving rocker turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows(abs(self.wanted.crank_swing_deg) / 360)

    @cached_property
    def ranked(self) -> Sequence[DoubleRocker]:
        best = self.wanted.search()
        if self.wanted.crank is not None or self.wanted.rocker is not None:
            return (best,)
        others = [self.wanted.search(angle) for angle in spread(best.family)]
        ranked: Sequence[DoubleRocker] = by_transmission(others, self.wanted.largest_ratio)
        # As the search does: those that go beyond their places come behind those that do not.
        return best, *sorted(ranked, key=lambda one: one.overshoot_deg > MISSED_DEG)

    @property
    def way(self) -> tuple[float, float]:
        """The crank's, as it was given."""
        start, end = self.wanted.crank_start_deg, self.wanted.crank_start_deg + self.wanted.crank_swing_deg
        return min(start, end), max(start, end)

    @property
    def met(self) -> tuple[Check, ...]:
        found = self.found
        swing, beyond = missed(found.rocker_swing_deg, self.wanted.rocker_swing_deg), missed(found.overshoot_deg, 0.0)
        return (
            Check("missed swing", swing, "at most", MISSED_DEG, "deg"),
            Check("rocker's way beyond its places", beyond, "at most", MISSED_DEG, "deg"),
        )

    @property
    def choice(self) -> Choice:
        return family_choice(self.found, self.wanted.largest_ratio)

    @property
    def notes(self) -> Mapping[str, object]:
        return {"family": told_family(self.ranked[0].family), **super().notes}
