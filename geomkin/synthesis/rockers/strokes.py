"""Slider-cranks from the slider's stroke and the crank's turn meanwhile: all of them, and the best."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, ClassVar

import numpy as np

from ...core.arguments import between, checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, Size, rounded_down, rounded_up
from ...core.records import record
from ...linkage.named_linkages import SliderCrank
from ...plane.vec import Real
from ..rounding import Rounding
from .crank_rockers import CLEAR_DEG, MISSED, free_range, no_such_turn, reach
from .families import (
    TURNING_RATIO,
    AbstractMember,
    Family,
    FullTurn,
    full_turn,
    highest,
    members,
    the_choice,
    within_sizes,
)

Offset = Annotated[float, between(-FARTHEST, FARTHEST, "mm")]
# Of a connecting rod to its crank: the least ratio that leaves a slider-crank which can be moved, with a hair of room.
Ratio = Annotated[float, between(1.001, 1e6)]


@record(eq=False, kw_only=True)
class StrokeCrank(AbstractMember):
    """The slider-crank of a stroke and a crank's turn that was chosen, and what it does as it is moved.

    linkage: its crank turns fully. branch: always +1. drive: the crank at the start and end of the stroke towards +x,
    rad. transmission_angle_deg: the least over the full turn. stroke (mm), crank_turn_deg, crank_start_deg: of that
    stroke, as the simulated full turn has them. defects: "circuit" where the simulated turn does not show the stroke
    and the turn that were wanted.
    """

    measured: ClassVar = ("stroke", "crank_turn_deg", "crank_start_deg")

    linkage: SliderCrank
    stroke: float
    crank_turn_deg: float
    crank_start_deg: float

    @property
    def time_ratio(self) -> float:
        """Of the stroke towards +x to the stroke back, at steady speed."""
        return self.crank_turn_deg / (360 - self.crank_turn_deg)

    def rounded(self, rounding: Rounding) -> StrokeCrank:
        linkage = rounding.linkage(self.linkage)
        return replace(self, linkage=linkage, **_measured(full_turn(linkage)))


@checked
def slider_crank_stroke(
    stroke: Size,
    crank_turn_deg: float = 180.0,
    *,
    offset: Offset | None = None,
    crank: Size | None = None,
    coupler: Size | None = None,
    free_angle_deg: float | None = None,
    largest_ratio: Ratio | None = None,
) -> StrokeCrank:
    """The slider-crank of a stroke and a crank's turn whose least transmission angle over the full turn is largest.

    stroke: of the slider, mm. crank_turn_deg: the crank's turn, counterclockwise, while the slider goes towards +x;
    360 k/(1 + k) of a time ratio k. More than 180 makes that the slow stroke, and the offset negative: the slide line
    then passes below the crank's pivot. One more size may be given, mm, and takes the linkage that has it instead of
    the best: the offset, the crank or the coupler; or free_angle_deg does, whose tangent is crank over coupler, as in
    `family`. largest_ratio: coupler over crank of the best, 6 where it is left out.

    There are linkages for turns of more than 90 and less than 270 deg; DesignError for others, and for a size that
    none of them has. At 180 deg, where the offset is 0 and the crank half the stroke, the best has an endless coupler:
    `largest_ratio` ends it, and `at_largest_ratio` says so. Each linkage is moved through its full turn, and what it
    does there is told. Derived here, from the linkage in its two dead centres: with the stroke h, the turn f and the
    free angle z, crank and coupler are h/2w times sin z and cos z, the offset h cos 2z sin f/4w2, where w is
    |cos(f/2) cos z + i sin(f/2) sin z|.
    """
    check_turn(crank_turn_deg)
    turn = float(np.radians(crank_turn_deg))
    low, high = free_range(0.0, turn)
    all_of_them = _family(stroke, turn, (low, high))
    given = {"offset": offset, "crank": crank, "coupler": coupler, "free_angle_deg": free_angle_deg}
    choice, at_largest = the_choice(given), False
    ratio = TURNING_RATIO if largest_ratio is None else largest_ratio
    if choice is not None and not (offset == 0 and turn == np.pi):
        free = _free_of(*choice, stroke, turn, (low, high))
    else:
        start = max(low, float(np.arctan2(1.0, ratio)))
        free = highest(lambda places: _transmission(turn, places), start, high)
        at_largest = start > low and free <= start * (1 + 1e-9)
    sizes = {name: float(size) for name, size in _sizes(stroke, turn, np.array(free)).items()}
    # What was given is kept to the last digit.
    linkage = SliderCrank(
        sizes["crank"] if crank is None else crank,
        sizes["coupler"] if coupler is None else coupler,
        sizes["offset"] if offset is None else offset,
    )
    moved = full_turn(linkage)
    sound = abs(moved.extent - stroke) <= MISSED * stroke and abs(moved.turn - turn) <= MISSED
    return StrokeCrank(
        linkage=linkage,
        branch=1,
        **_measured(moved),
        defects=() if sound else ("circuit",),
        free_angle_deg=float(np.degrees(free)),
        largest_ratio=ratio,
        at_largest_ratio=at_largest,
        family=all_of_them,
    )


def _measured(moved: FullTurn) -> dict[str, Any]:
    """What a full turn shows of the stroke."""
    return {
        "drive": np.array([moved.start, moved.start + moved.turn]),
        "transmission_angle_deg": float(np.degrees(moved.least)),
        "stroke": moved.extent,
        "crank_turn_deg": float(np.degrees(moved.turn)),
        "crank_start_deg": float(np.degrees(moved.start)),
    }


def check_turn(crank_turn_deg: float, field: str = "crank_turn_deg") -> None:
    """Refuse a crank's turn that no slider-crank has; under `field`, as a time ratio where it is one."""
    ends = 90 + CLEAR_DEG, 270 - CLEAR_DEG
    if not ends[0] <= crank_turn_deg <= ends[1]:
        raise no_such_turn(field, crank_turn_deg, "no slider-crank has", ends)


def _sizes(stroke: float, turn: float, free: Real) -> dict[str, Real]:
    w = reach(0.5 * turn, free)
    return {
        "crank": 0.5 * stroke * np.sin(free) / w,
        "coupler": 0.5 * stroke * np.cos(free) / w,
        "offset": _lean(turn) * stroke * np.cos(2 * free) / (4 * w**2),
    }


def _lean(turn: float) -> float:
    """The sine of the turn, 0 at half a turn: there rounding would raise the slide line by a hair."""
    return float(np.sin(turn)) if turn != np.pi else 0.0


def _transmission(turn: float, free: Real) -> Real:
    """The least transmission angle, rad: where the crank stands at right angles to the slide line."""
    size = _sizes(1.0, turn, free)
    cosine = (size["crank"] + np.abs(size["offset"])) / size["coupler"]
    return np.arccos(np.minimum(cosine, 1.0))


def _free_of(name: str, size: float, stroke: float, turn: float, ends: tuple[float, float]) -> float:
    """The free angle, rad, of the linkage that has a size; DesignError where none has."""
    if name == "free_angle_deg":
        reached, wanted, unit = np.degrees(np.array(ends)), size, " deg"
    else:
        reached, wanted, unit = _sizes(stroke, turn, np.array(ends))[name], size, " mm"
        if name == "offset":
            reached[1] = 0.0
    low, high = np.sort(reached)
    if turn == np.pi and name in ("crank", "offset"):
        one = "0" if name == "offset" else f"{0.5 * stroke:.7g} mm"
        problem = f"found {size:g} mm, but where both strokes take half a turn it is {one}"
        raise DesignError(name, problem, "leave it out, give another turn, or give the coupler")
    if not low < wanted < high:
        ends_told = f"more than {rounded_up(low)} and less than {rounded_down(high)}{unit}"
        raise DesignError(name, f"found {size:g}{unit}, which no such slider-crank has", f"give {ends_told}")
    if name == "free_angle_deg":
        return float(np.radians(size))
    # The cosine s of twice the free angle: 2 w2 = 1 + s cos f turns each of the three into a linear equation.
    cosine, share = float(np.cos(turn)), size / stroke
    if name == "offset":
        s = 2 * share / (float(np.sin(turn)) - 2 * share * cosine)
    elif name == "crank":
        s = (1 - 4 * share**2) / (1 + 4 * share**2 * cosine)
    else:
        s = (4 * share**2 - 1) / (1 - 4 * share**2 * cosine)
    return 0.5 * float(np.arccos(np.clip(s, 0.0, 1.0)))


def _family(stroke: float, turn: float, ends: tuple[float, float]) -> Family:
    free = members(*ends)
    sizes = _sizes(stroke, turn, free)
    fit = within_sizes(sizes["crank"], sizes["coupler"])
    crank, coupler, offset = (np.asarray(size[fit], dtype=np.float64) for size in sizes.values())
    return Family(
        linkage=SliderCrank(crank, coupler, offset),
        free_angle_deg=np.degrees(free[fit]),
        transmission_angle_deg=np.degrees(_transmission(turn, free[fit])),
        range_deg=(float(np.degrees(ends[0])), float(np.degrees(ends[1]))),
    )
