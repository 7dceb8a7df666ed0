"""Crank-rockers from the rocker's swing and the crank's turn meanwhile: all of them, and the best."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from ...core.arguments import between, checked
from ...core.errors import DesignError
from ...core.fields import Size, rounded_down, rounded_up
from ...core.records import record
from ...linkage.named_linkages import FourBar
from ...plane.vec import Real
from ..rounding import Rounding
from .families import (
    TURNING_RATIO,
    AbstractMember,
    Family,
    FullTurn,
    four_bars,
    full_turn,
    highest,
    members,
    scale_of,
    the_choice,
    turn_of,
    within_sizes,
)

Swing = Annotated[float, between(0.1, 179, "deg")]
Ratio = Annotated[float, between(1, 1e6)]
Sense = Literal["same", "opposite"]
# deg by which a crank's turn must keep clear of those that no linkage has. Nearer, all of them are so close to a
# change point that rounding decides how they move.
CLEAR_DEG = 0.05
# Share by which a simulated swing or turn may miss the one wanted. Rounding alone misses by far less, but of small
# swings by more than of large ones; a dead centre on the other circuit by a hundred times this and more.
MISSED = 1e-6


@record(eq=False, kw_only=True)
class CrankRocker(AbstractMember):
    """The crank-rocker of a swing and a crank's turn that was chosen, and what it does as it is moved.

    linkage: its crank turns fully. branch: always +1. drive: the crank at the start and end of the stroke that
    `crank_turn_deg` is the turn of, rad. transmission_angle_deg: the least over the full turn. swing_deg,
    crank_turn_deg, crank_start_deg: of that stroke, as the simulated full turn has them. defects: "circuit" where the
    simulated turn does not show the swing and the turn that were wanted.
    """

    measured: ClassVar = ("swing_deg", "crank_turn_deg", "crank_start_deg")

    linkage: FourBar
    swing_deg: float
    crank_turn_deg: float
    crank_start_deg: float

    @property
    def time_ratio(self) -> float:
        """Of the stroke to the stroke back, at steady speed."""
        return self.crank_turn_deg / (360 - self.crank_turn_deg)

    def rounded(self, rounding: Rounding) -> CrankRocker:
        linkage = rounding.linkage(self.linkage)
        moved = full_turn(linkage)
        start, way = moved.start, moved.turn
        # The sense that was asked for is that of the stroke that begins where this one does.
        if np.cos(start - self.drive[0]) < np.cos(start + way - self.drive[0]):
            start, way = (start + way) % (2 * np.pi), 2 * np.pi - way
        return replace(self, linkage=linkage, **_measured(moved, start, way))


@checked
def crank_rocker(
    swing_deg: Swing,
    crank_turn_deg: float | None = None,
    ground: Size | None = None,
    sense: Sense = "same",
    *,
    crank: Size | None = None,
    coupler: Size | None = None,
    rocker: Size | None = None,
    free_angle_deg: float | None = None,
    largest_ratio: Ratio | None = None,
    time_ratio: Annotated[float, between(1e-6, 1e6)] | None = None,
) -> CrankRocker:
    """The crank-rocker of a swing and a crank's turn whose least transmission angle over the full turn is largest.

    swing_deg: of the rocker, from dead centre to dead centre. crank_turn_deg: the crank's turn while the rocker swings
    in the same `sense` as the crank turns, or in the opposite one: 200 in the same sense is 160 in the opposite one.
    time_ratio: instead of that turn, the time of this stroke over that of the stroke back; the turn is 360 k/(1 + k) of
    a ratio k, and 180 where neither is given. ground, crank, coupler, rocker: one of the lengths, mm, the ground's 1
    where none is given. free_angle_deg: takes another of the linkages that there are, all of them in `family`; its
    tangent is crank over coupler. largest_ratio: longest link over the shortest of the best, 6 where it is left out, or
    of swings below 39 deg twice the least that they need.

    There are linkages where the crank's turn is more than 90 deg and less than 270 deg, both and half the swing, in the
    same sense, or less half the swing in the opposite one; DesignError where there are none, and for a ratio too small
    for the swing. At a turn of 180 deg and near it the best runs to an endless ratio: `largest_ratio` ends it, and
    `at_largest_ratio` says so. Its transmission angle then comes near to 90 deg less half the swing, which is more than
    at any other turn: no crank-rocker that swings 100 deg or more has 40 deg. Each linkage is moved through its full
    turn, and what it does there is told. Derived here, from the linkage in its two dead centres (Alt, Der
    Übertragungswinkel, Werkstattstechnik 26, 1932): with the swing p, the turn f and the free angle z,
    crank : coupler : rocker : ground are sin(p/2) sin z : sin(p/2) cos z : |cos(f/2) cos z + i sin(f/2) sin z| :
    |cos(f/2 - p/2) cos z + i sin(f/2 - p/2) sin z|.
    """
    turn_deg = turn_of(crank_turn_deg, time_ratio)
    check_turn(swing_deg, turn_deg, sense, "crank_turn_deg" if time_ratio is None else "time_ratio")
    lengths_given = {"ground": ground, "crank": crank, "coupler": coupler, "rocker": rocker}
    name, length = the_choice(lengths_given) or ("ground", 1.0)
    swing, turn = np.radians(swing_deg), np.radians(turn_deg if sense == "same" else 360 - turn_deg)
    low, high = free_range(float(swing), float(turn))
    ratio = _ratio(swing_deg, largest_ratio)
    all_of_them = _family(float(swing), float(turn), (low, high), name, length)

    def least(free: Real) -> Real:
        return _transmission(float(swing), float(turn), free)

    at_largest = False
    if free_angle_deg is None:
        start = max(low, _free_at(float(swing), float(turn), ratio))
        free = highest(least, start, high)
        at_largest = start > low and free <= start * (1 + 1e-9)
    else:
        free = float(np.radians(free_angle_deg))
        if not low < free < high:
            ends = f"more than {rounded_up(all_of_them.range_deg[0])} deg and less than 45"
            raise DesignError("free_angle_deg", f"found {free_angle_deg:g}", f"give {ends}")
    sizes = {k: float(size) for k, size in _sizes(float(swing), float(turn), np.array(free)).items()}
    scale = scale_of(sizes, name, length)
    lengths = {k: length if k == name else scale * size for k, size in sizes.items()}
    linkage = FourBar(lengths["ground"], lengths["crank"], lengths["coupler"], lengths["rocker"])
    moved = full_turn(linkage)
    return _told(linkage, moved, sense, float(swing), float(turn), np.degrees(free), ratio, at_largest, all_of_them)


def _told(
    linkage: FourBar,
    moved: FullTurn,
    sense: Sense,
    swing: float,
    turn: float,
    free_deg: float,
    largest_ratio: float,
    at_largest: bool,
    family: Family,
) -> CrankRocker:
    start, way = moved.start, moved.turn
    if sense == "opposite":
        start, way = (start + way) % (2 * np.pi), 2 * np.pi - way
    sound = abs(moved.extent - swing) <= MISSED * swing and abs(moved.turn - turn) <= MISSED
    return CrankRocker(
        linkage=linkage,
        branch=1,
        **_measured(moved, start, way),
        defects=() if sound else ("circuit",),
        free_angle_deg=float(free_deg),
        largest_ratio=largest_ratio,
        at_largest_ratio=at_largest,
        family=family,
    )


def _measured(moved: FullTurn, start: float, way: float) -> dict[str, Any]:
    """What a full turn shows of the stroke that begins at `start` and takes a turn of `way`, rad."""
    return {
        "drive": np.array([start, start + way]),
        "transmission_angle_deg": float(np.degrees(moved.least)),
        "swing_deg": float(np.degrees(moved.extent)),
        "crank_turn_deg": float(np.degrees(way)),
        "crank_start_deg": float(np.degrees(start)),
    }


def crank_turns(swing_deg: float, sense: Sense) -> tuple[float, float]:
    """Between which a crank-rocker's turn lies, deg, in the stroke in which its rocker swings in that sense."""
    half = 0.5 * swing_deg if sense == "same" else -0.5 * swing_deg
    return 90 + half + CLEAR_DEG, 270 + half - CLEAR_DEG


def check_turn(swing_deg: float, crank_turn_deg: float, sense: Sense, field: str = "crank_turn_deg") -> None:
    """Refuse a crank's turn that no crank-rocker of the swing has; under `field`, as a time ratio where it is one."""
    ends = crank_turns(swing_deg, sense)
    if ends[0] <= crank_turn_deg <= ends[1]:
        return
    other: Sense = "opposite" if sense == "same" else "same"
    others = crank_turns(swing_deg, other)
    more = f', or sense = "{other}", in which there are some' if others[0] <= crank_turn_deg <= others[1] else ""
    raise no_such_turn(field, crank_turn_deg, f"no crank-rocker that swings {swing_deg:g} deg has", ends, more)


def no_such_turn(field: str, turn_deg: float, whose: str, ends: tuple[float, float], more: str = "") -> DesignError:
    """The refusal of a turn, deg, that is not between two others; as ratios of times where the field is one."""
    in_deg = field.endswith("_deg")
    found, low, high = (turn if in_deg else turn / (360 - turn) for turn in (turn_deg, *ends))
    unit = " deg" if in_deg else ""
    remedy = f"give {rounded_up(low)} to {rounded_down(high)}{unit}{more}"
    return DesignError(field, f"found {found:.7g}{unit}, which {whose}", remedy)


def free_range(swing: float, turn: float) -> tuple[float, float]:
    """Ends of the free angle, rad: a crank of no length, or on the ground line in a dead centre; and a kite.

    turn: in the stroke in the same sense. In both dead centres the rocker must stand on one side of the ground line;
    that is the one circuit there is, since the closed dead centres alone make the crank the shortest of a Grashof
    linkage. A swing of 0 is the slider-crank's.
    """
    near, far = np.cos(swing / 2), -np.cos(turn - swing / 2)
    return float(np.pi / 4 - np.arctan(min(near / far, far / near))), float(np.pi / 4)


def _sizes(swing: float, turn: float, free: Real) -> dict[str, Real]:
    s = np.sin(swing / 2)
    return {
        "ground": reach(0.5 * (turn - swing), free),
        "crank": s * np.sin(free),
        "coupler": s * np.cos(free),
        "rocker": reach(0.5 * turn, free),
    }


def reach(half: float, free: Real) -> Real:
    """|cos half cos free + i sin half sin free|: a pivot's distance in the closed form of the dead centres."""
    far: Real = np.hypot(np.cos(half) * np.cos(free), np.sin(half) * np.sin(free))
    return far


def _transmission(swing: float, turn: float, free: Real) -> Real:
    """The least transmission angle, rad: where the crank lies on the ground line, to one side or the other."""
    size, s = _sizes(swing, turn, free), np.sin(swing / 2)
    lean = 0.5 * np.abs(np.cos(2 * free) * s * (s - np.sin(turn - swing / 2)))
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = (lean + size["crank"] * size["ground"]) / (size["coupler"] * size["rocker"])
    least: Real = np.nan_to_num(np.arccos(np.minimum(cosine, 1.0)))
    return least


def _ratio(swing_deg: float, largest: float | None) -> float:
    least = 1 / np.sin(np.radians(swing_deg) / 2)
    if largest is None:
        return float(max(TURNING_RATIO, 2 * least))
    if largest <= least * 1.0001:
        found = f"found {largest:g}, but the rocker is longer than the crank by more where it swings {swing_deg:g} deg"
        raise DesignError("largest_ratio", found, f"give at least {rounded_up(least * 1.0002, 4)}")
    return largest


def _free_at(swing: float, turn: float, ratio: float) -> float:
    """The least free angle at which no link is longer than `ratio` cranks, rad: it only falls as the angle grows."""
    cotangent = ratio
    for half in (0.5 * turn, 0.5 * (turn - swing)):
        more = ratio**2 * np.sin(swing / 2) ** 2 - np.sin(half) ** 2
        with np.errstate(divide="ignore"):
            cotangent = min(cotangent, np.sqrt(np.divide(more, np.cos(half) ** 2)))
    return float(np.arctan2(1.0, cotangent))


def _family(swing: float, turn: float, ends: tuple[float, float], name: str, length: float) -> Family:
    free = members(*ends)
    sizes = _sizes(swing, turn, free)
    scale = length / sizes[name]
    sizes = {k: np.full_like(free, length) if k == name else scale * size for k, size in sizes.items()}
    fit = within_sizes(*sizes.values())
    return Family(
        linkage=four_bars({k: size[fit] for k, size in sizes.items()}),
        free_angle_deg=np.degrees(free[fit]),
        transmission_angle_deg=np.degrees(_transmission(swing, turn, free[fit])),
        range_deg=(float(np.degrees(ends[0])), float(np.degrees(ends[1]))),
    )
