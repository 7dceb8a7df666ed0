"""Slider-cranks from the slider's stroke and the crank rotation during it: the whole family, and the best member."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, ClassVar

import numpy as np

from ...core.arguments import between, checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, Size, inside
from ...core.records import record
from ...core.units import bare_mm, converted_power, mm
from ...linkage.named_linkages import SliderCrank
from ...plane.vec import Real
from ..found import Rounding
from .crank_rockers import CLEAR_DEG, MISSED, free_range, no_such_turn, pivot_distance
from .families import (
    TURNING_RATIO,
    AbstractMember,
    Family,
    FullTurn,
    full_turn,
    given_choice,
    maximise,
    member_angles,
    within_size_limits,
)

Offset = Annotated[float, between(-FARTHEST, FARTHEST, "mm")]
# Least ratio of connecting rod to crank, slightly above 1: the least that leaves a slider-crank that can move.
Ratio = Annotated[float, between(1.001, 1e6)]


@record(eq=False, kw_only=True)
class StrokeCrank(AbstractMember):
    """The slider-crank chosen by `slider_crank_stroke`, with its simulated motion.

    Parameters
    ----------
    linkage : SliderCrank
        The linkage; its crank turns fully.
    branch : int
        Always +1.
    drive : array, shape (2,)
        Crank angles at the start and end of the stroke towards +x, rad.
    transmission_angle_deg : float
        Least transmission angle over the full turn.
    stroke : float
        Stroke of the slider in the simulated full turn, mm.
    crank_turn_deg : float
        Rotation of the crank during the stroke towards +x, from the simulation.
    crank_start_deg : float
        Crank angle at the start of that stroke, from the simulation.
    defects : tuple of str
        `("circuit",)` if the simulation does not show the wanted stroke and crank rotation, else empty.
    free_angle_deg, largest_ratio, at_largest_ratio, family
        The position in the family and the limit of the search, see `Family` and `slider_crank_stroke`.
    """

    measured: ClassVar = ("stroke", "crank_turn_deg", "crank_start_deg")

    linkage: SliderCrank
    stroke: float
    crank_turn_deg: float
    crank_start_deg: float

    @property
    def time_ratio(self) -> float:
        """Time of the stroke towards +x over the time of the return stroke, at constant crank speed."""
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
    """Find the slider-crank with a given stroke and crank rotation that has the best transmission angle.

    The best linkage has the largest least transmission angle over the full turn.

    Parameters
    ----------
    stroke : float
        Stroke of the slider, mm.
    crank_turn_deg : float
        Counterclockwise rotation of the crank while the slider moves towards +x, between 90 and 270 deg; 360 k/(1 + k)
        for a time ratio k. More than 180 makes this the slow stroke and the offset negative, so that the slide line
        passes below the crank's pivot.
    offset, crank, coupler : float, optional
        At most one size, mm: selects the member of the family that has it, instead of the best.
    free_angle_deg : float, optional
        Another choice of a member: the angle whose tangent is crank/coupler, as in `Family.free_angle_deg`.
    largest_ratio : float, optional
        Largest ratio of coupler to crank in the search for the best, 1.001 to 1e6; 6 by default.

    Returns
    -------
    StrokeCrank
        The linkage, moved through its full turn, with its `family`. `at_largest_ratio` is true if only `largest_ratio`
        keeps the transmission angle from growing.

    Raises
    ------
    DesignError
        If no slider-crank has this crank rotation, or none of the family has the given size.

    Notes
    -----
    At 180 deg the offset is 0 and the crank is half the stroke; the transmission angle then grows with the coupler
    without end, and `largest_ratio` limits it.

    Derived here from the linkage in its two dead centres: with the stroke h, the crank rotation f and the free angle z,
    crank and coupler are h/2w times sin z and cos z, and the offset is h cos 2z sin f/4w2, with w = |cos(f/2) cos z + i
    sin(f/2) sin z|.

    Examples
    --------
    >>> from geomkin.synthesis import slider_crank_stroke
    >>> best = slider_crank_stroke(80, 190)
    >>> round(best.stroke, 6), round(best.crank_turn_deg, 6)
    (80.0, 190.0)
    """
    check_stroke_rotation(crank_turn_deg)
    turn = float(np.radians(crank_turn_deg))
    low, high = free_range(0.0, turn)
    family = _family(stroke, turn, (low, high))
    given = {"offset": offset, "crank": crank, "coupler": coupler, "free_angle_deg": free_angle_deg}
    choice, at_largest = given_choice(given), False
    ratio = TURNING_RATIO if largest_ratio is None else largest_ratio
    if choice is not None and not (offset == 0 and turn == np.pi):
        free = _free_of(*choice, stroke, turn, (low, high))
    else:
        start = max(low, float(np.arctan2(1.0, ratio)))
        free = maximise(lambda angles: _transmission(turn, angles), start, high)
        at_largest = start > low and free <= start * (1 + 1e-9)
    sizes = {name: float(size) for name, size in _sizes(stroke, turn, np.array(free)).items()}
    # A given size keeps all its digits.
    linkage = SliderCrank(
        sizes["crank"] if crank is None else crank,
        sizes["coupler"] if coupler is None else coupler,
        sizes["offset"] if offset is None else offset,
    )
    moved = full_turn(linkage)
    is_as_wanted = abs(moved.extent - stroke) <= MISSED * stroke and abs(moved.turn - turn) <= MISSED
    return StrokeCrank(
        linkage=linkage,
        branch=1,
        **_measured(moved),
        defects=() if is_as_wanted else ("circuit",),
        free_angle_deg=float(np.degrees(free)),
        largest_ratio=ratio,
        at_largest_ratio=at_largest,
        family=family,
    )


def _measured(moved: FullTurn) -> dict[str, Any]:
    return {
        "drive": np.array([moved.start, moved.start + moved.turn]),
        "transmission_angle_deg": float(np.degrees(moved.least)),
        "stroke": moved.extent,
        "crank_turn_deg": float(np.degrees(moved.turn)),
        "crank_start_deg": float(np.degrees(moved.start)),
    }


def check_stroke_rotation(crank_turn_deg: float, field: str = "crank_turn_deg") -> None:
    """Raise DesignError, under the name `field`, for a crank rotation that no slider-crank has."""
    ends = 90 + CLEAR_DEG, 270 - CLEAR_DEG
    if not ends[0] <= crank_turn_deg <= ends[1]:
        raise no_such_turn(field, crank_turn_deg, "no slider-crank has", ends)


def _sizes(stroke: float, turn: float, free: Real) -> dict[str, Real]:
    w = pivot_distance(0.5 * turn, free)
    return {
        "crank": 0.5 * stroke * np.sin(free) / w,
        "coupler": 0.5 * stroke * np.cos(free) / w,
        "offset": _sine(turn) * stroke * np.cos(2 * free) / (4 * w**2),
    }


def _sine(turn: float) -> float:
    """Sine of the crank rotation, exactly 0 at half a turn, so that the offset is exactly 0 there."""
    return float(np.sin(turn)) if turn != np.pi else 0.0


def _transmission(turn: float, free: Real) -> Real:
    """Least transmission angle, rad; it occurs with the crank at right angles to the slide line."""
    size = _sizes(1.0, turn, free)
    cosine = (size["crank"] + np.abs(size["offset"])) / size["coupler"]
    return np.arccos(np.minimum(cosine, 1.0))


def _free_of(name: str, size: float, stroke: float, turn: float, ends: tuple[float, float]) -> float:
    """Free angle, rad, of the linkage with a given size; DesignError if there is none."""
    if name == "free_angle_deg":
        range_values, wanted, unit = np.degrees(np.array(ends)), size, "deg"
    else:
        range_values, wanted, unit = _sizes(stroke, turn, np.array(ends))[name], size, "mm"
        if name == "offset":
            range_values[1] = 0.0
    low, high = np.sort(range_values)
    power = converted_power(unit)
    if turn == np.pi and name in ("crank", "offset"):
        only_value = "0" if name == "offset" else f"{mm(0.5 * stroke):.7g}"
        problem = f"found {mm(size):g}, but with equal strokes it is {only_value}"
        raise DesignError(name, problem, "leave it out, give another turn, or give the coupler")
    if not low < wanted < high:
        range_text = f"more than {bare_mm(low, power=power):up} and less than {mm(high, unit=unit):down}"
        problem = f"found {mm(size, unit=unit):g}, which no such slider-crank has"
        nearest = inside(high, 1) if wanted >= high else inside(low, -1)
        raise DesignError(name, problem, f"give {range_text}", value=nearest)
    if name == "free_angle_deg":
        return float(np.radians(size))
    # With s the cosine of twice the free angle, 2 w2 = 1 + s cos f makes each of the three equations linear in s.
    cosine, share = float(np.cos(turn)), size / stroke
    if name == "offset":
        s = 2 * share / (float(np.sin(turn)) - 2 * share * cosine)
    elif name == "crank":
        s = (1 - 4 * share**2) / (1 + 4 * share**2 * cosine)
    else:
        s = (4 * share**2 - 1) / (1 - 4 * share**2 * cosine)
    return 0.5 * float(np.arccos(np.clip(s, 0.0, 1.0)))


def _family(stroke: float, turn: float, ends: tuple[float, float]) -> Family:
    free = member_angles(*ends)
    sizes = _sizes(stroke, turn, free)
    fit = within_size_limits(sizes["crank"], sizes["coupler"])
    crank, coupler, offset = (np.asarray(size[fit], dtype=np.float64) for size in sizes.values())
    return Family(
        linkage=SliderCrank(crank, coupler, offset),
        free_angle_deg=np.degrees(free[fit]),
        transmission_angle_deg=np.degrees(_transmission(turn, free[fit])),
        range_deg=(float(np.degrees(ends[0])), float(np.degrees(ends[1]))),
    )
