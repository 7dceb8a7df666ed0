"""Crank-rockers from the rocker's swing and the crank rotation during it: the whole family, and the best member."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from ...core.arguments import between, checked
from ...core.errors import DesignError
from ...core.fields import Size, inside, rounded_down, rounded_up
from ...core.records import record
from ...linkage.named_linkages import FourBar
from ...plane.vec import Real
from ..found import Rounding
from .families import (
    TURNING_RATIO,
    AbstractMember,
    Family,
    FullTurn,
    four_bars,
    full_turn,
    given_choice,
    maximise,
    member_angles,
    scale_for_link,
    turn_of,
    within_size_limits,
)

Swing = Annotated[float, between(0.1, 179, "deg")]
Ratio = Annotated[float, between(1, 1e6)]
Sense = Literal["same", "opposite"]
# Margin, deg, from the ends of the range of crank rotations. Closer to an end all linkages are so near a change point
# that rounding decides how they move.
CLEAR_DEG = 0.05
# Largest relative error of a simulated swing or crank rotation. Rounding alone stays far below it (it is larger for
# small swings); a dead centre on the other circuit exceeds it at least a hundred times.
MISSED = 1e-6


@record(eq=False, kw_only=True)
class CrankRocker(AbstractMember):
    """The crank-rocker chosen by `crank_rocker`, with its simulated motion.

    Parameters
    ----------
    linkage : FourBar
        The linkage; its crank turns fully.
    branch : int
        Always +1.
    drive : array, shape (2,)
        Crank angles at the start and end of the stroke to which `crank_turn_deg` belongs, rad.
    transmission_angle_deg : float
        Least transmission angle over the full turn.
    swing_deg : float
        Swing of the rocker in the simulated full turn.
    crank_turn_deg : float
        Rotation of the crank during the stroke in the chosen sense, from the simulation.
    crank_start_deg : float
        Crank angle at the start of that stroke, from the simulation.
    defects : tuple of str
        `("circuit",)` if the simulation does not show the wanted swing and crank rotation, else empty.
    free_angle_deg, largest_ratio, at_largest_ratio, family
        The position in the family and the limit of the search, see `Family` and `crank_rocker`.
    """

    measured: ClassVar = ("swing_deg", "crank_turn_deg", "crank_start_deg")

    linkage: FourBar
    swing_deg: float
    crank_turn_deg: float
    crank_start_deg: float

    @property
    def time_ratio(self) -> float:
        """Time of the stroke over the time of the return stroke, at constant crank speed."""
        return self.crank_turn_deg / (360 - self.crank_turn_deg)

    def rounded(self, rounding: Rounding) -> CrankRocker:
        linkage = rounding.linkage(self.linkage)
        moved = full_turn(linkage)
        start, rotation = moved.start, moved.turn
        # Of both strokes, the one in the chosen sense starts nearest to its start before rounding.
        if np.cos(start - self.drive[0]) < np.cos(start + rotation - self.drive[0]):
            start, rotation = (start + rotation) % (2 * np.pi), 2 * np.pi - rotation
        return replace(self, linkage=linkage, **_measured(moved, start, rotation))


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
    """Find the crank-rocker with a given swing and crank rotation that has the best transmission angle.

    The best linkage has the largest least transmission angle over the full turn. The crank rotation sets the time
    ratio of the two strokes.

    Parameters
    ----------
    swing_deg : float
        Swing of the rocker from dead centre to dead centre, 0.1 to 179 deg.
    crank_turn_deg : float, optional
        Rotation of the crank, deg, during the stroke in which the rocker swings in the given `sense`. 200 in the same
        sense is 160 in the opposite sense. 180 if neither this nor `time_ratio` is given.
    ground, crank, coupler, rocker : float, optional
        One length, mm, which sets the size; `ground=1` if none is given.
    sense : {"same", "opposite"}
        Sense of the rocker in that stroke, relative to the sense of the crank.
    free_angle_deg : float, optional
        Selects another member of the family than the best: the angle whose tangent is crank/coupler.
    largest_ratio : float, optional
        Largest ratio of the longest link to the shortest in the search for the best, 1 to 1e6. By default 6, or twice
        the least possible ratio for swings below 39 deg.
    time_ratio : float, optional
        Time of the stroke over the time of the return stroke, instead of `crank_turn_deg`, 1e-6 to 1e6; a ratio k is a
        rotation of 360 k/(1 + k) deg.

    Returns
    -------
    CrankRocker
        The linkage, moved through its full turn, with its `family`. `at_largest_ratio` is true if only `largest_ratio`
        keeps the transmission angle from growing.

    Raises
    ------
    DesignError
        If no crank-rocker has this crank rotation: it must be between 90 and 270 deg, plus half the swing for the same
        sense, minus half the swing for the opposite one. Also if `largest_ratio` is too small for the swing, or a size
        is out of range.

    See Also
    --------
    FourBar, function_generator, path_generator

    Notes
    -----
    At a rotation of 180 deg and near it the transmission angle grows with the ratio of the links without end. It then
    approaches 90 deg minus half the swing, which is more than at any other rotation: no crank-rocker that swings 100
    deg or more reaches 40 deg.

    The formulas are derived here from the linkage in its two dead centres (problem: Alt, Der Übertragungswinkel,
    Werkstattstechnik 26, 1932). With the swing p, the crank rotation f and the free angle z, crank : coupler : rocker :
    ground are `sin(p/2) sin z : sin(p/2) cos z : |cos(f/2) cos z + i sin(f/2) sin z| : |cos(f/2 - p/2) cos z
    + i sin(f/2 - p/2) sin z|`.

    Examples
    --------
    >>> import geomkin as gk
    >>> best = gk.crank_rocker(50, 200, ground=100)
    >>> round(best.swing_deg, 6), round(best.crank_turn_deg, 6), best.defects
    (50.0, 200.0, ())
    """
    turn_deg = turn_of(crank_turn_deg, time_ratio)
    check_swing_rotation(swing_deg, turn_deg, sense, "crank_turn_deg" if time_ratio is None else "time_ratio")
    lengths_given = {"ground": ground, "crank": crank, "coupler": coupler, "rocker": rocker}
    name, length = given_choice(lengths_given) or ("ground", 1.0)
    swing, turn = np.radians(swing_deg), np.radians(turn_deg if sense == "same" else 360 - turn_deg)
    low, high = free_range(float(swing), float(turn))
    ratio = _ratio(swing_deg, largest_ratio)
    family = _family(float(swing), float(turn), (low, high), name, length)

    def least(free: Real) -> Real:
        return _transmission(float(swing), float(turn), free)

    at_largest = False
    if free_angle_deg is None:
        start = max(low, _free_at(float(swing), float(turn), ratio))
        free = maximise(least, start, high)
        at_largest = start > low and free <= start * (1 + 1e-9)
    else:
        free = float(np.radians(free_angle_deg))
        if not low < free < high:
            ends = f"more than {rounded_up(family.range_deg[0])} deg and less than 45"
            least_free = inside(family.range_deg[0], -1)
            raise DesignError("free_angle_deg", f"found {free_angle_deg:g}", f"give {ends}", "out-of-range", least_free)
    sizes = {k: float(size) for k, size in _sizes(float(swing), float(turn), np.array(free)).items()}
    scale = scale_for_link(sizes, name, length)
    lengths = {k: length if k == name else scale * size for k, size in sizes.items()}
    linkage = FourBar(lengths["ground"], lengths["crank"], lengths["coupler"], lengths["rocker"])
    moved = full_turn(linkage)
    return _crank_rocker(linkage, moved, sense, float(swing), float(turn), np.degrees(free), ratio, at_largest, family)


def _crank_rocker(
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
    start, rotation = moved.start, moved.turn
    if sense == "opposite":
        start, rotation = (start + rotation) % (2 * np.pi), 2 * np.pi - rotation
    is_as_wanted = abs(moved.extent - swing) <= MISSED * swing and abs(moved.turn - turn) <= MISSED
    return CrankRocker(
        linkage=linkage,
        branch=1,
        **_measured(moved, start, rotation),
        defects=() if is_as_wanted else ("circuit",),
        free_angle_deg=float(free_deg),
        largest_ratio=largest_ratio,
        at_largest_ratio=at_largest,
        family=family,
    )


def _measured(moved: FullTurn, start: float, rotation: float) -> dict[str, Any]:
    """Fields that a simulated full turn gives for the stroke from `start` over `rotation`, rad."""
    return {
        "drive": np.array([start, start + rotation]),
        "transmission_angle_deg": float(np.degrees(moved.least)),
        "swing_deg": float(np.degrees(moved.extent)),
        "crank_turn_deg": float(np.degrees(rotation)),
        "crank_start_deg": float(np.degrees(start)),
    }


def crank_turns(swing_deg: float, sense: Sense) -> tuple[float, float]:
    """Range of the crank rotation, deg, during the stroke of the given sense."""
    half = 0.5 * swing_deg if sense == "same" else -0.5 * swing_deg
    return 90 + half + CLEAR_DEG, 270 + half - CLEAR_DEG


def check_swing_rotation(swing_deg: float, crank_turn_deg: float, sense: Sense, field: str = "crank_turn_deg") -> None:
    """Raise DesignError, under the name `field`, for a crank rotation that no crank-rocker of this swing has."""
    ends = crank_turns(swing_deg, sense)
    if ends[0] <= crank_turn_deg <= ends[1]:
        return
    other: Sense = "opposite" if sense == "same" else "same"
    others = crank_turns(swing_deg, other)
    alternative = f', or sense = "{other}", which allows it' if others[0] <= crank_turn_deg <= others[1] else ""
    raise no_such_turn(field, crank_turn_deg, f"no crank-rocker that swings {swing_deg:g} deg has", ends, alternative)


def no_such_turn(
    field: str, turn_deg: float, problem: str, ends: tuple[float, float], alternative: str = ""
) -> DesignError:
    """The error for a crank rotation, deg, outside a range; in time ratios unless the field ends in `_deg`."""
    in_deg = field.endswith("_deg")
    found, low, high = (turn if in_deg else turn / (360 - turn) for turn in (turn_deg, *ends))
    unit = " deg" if in_deg else ""
    remedy = f"give {rounded_up(low)} to {rounded_down(high)}{unit}{alternative}"
    nearest = rounded_up(low) if found < low else rounded_down(high)
    return DesignError(field, f"found {found:.7g}{unit}, which {problem}", remedy, value=nearest)


def free_range(swing: float, turn: float) -> tuple[float, float]:
    """Ends of the free angle, rad: a crank of zero length or in line with the ground in a dead centre, and a kite.

    `turn` belongs to the stroke in the same sense. In both dead centres the rocker must be on the same side of the
    ground line, which means the same circuit, since closed dead centres alone make the crank the shortest link of a
    Grashof linkage. A swing of 0 gives the range of the slider-crank.
    """
    near, far = np.cos(swing / 2), -np.cos(turn - swing / 2)
    return float(np.pi / 4 - np.arctan(min(near / far, far / near))), float(np.pi / 4)


def _sizes(swing: float, turn: float, free: Real) -> dict[str, Real]:
    s = np.sin(swing / 2)
    return {
        "ground": pivot_distance(0.5 * (turn - swing), free),
        "crank": s * np.sin(free),
        "coupler": s * np.cos(free),
        "rocker": pivot_distance(0.5 * turn, free),
    }


def pivot_distance(half: float, free: Real) -> Real:
    """|cos half cos free + i sin half sin free|, by which the closed form gives the distance of a ground pivot."""
    distance: Real = np.hypot(np.cos(half) * np.cos(free), np.sin(half) * np.sin(free))
    return distance


def _transmission(swing: float, turn: float, free: Real) -> Real:
    """Least transmission angle, rad; it occurs with the crank on the ground line."""
    size, s = _sizes(swing, turn, free), np.sin(swing / 2)
    offset_term = 0.5 * np.abs(np.cos(2 * free) * s * (s - np.sin(turn - swing / 2)))
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = (offset_term + size["crank"] * size["ground"]) / (size["coupler"] * size["rocker"])
    least: Real = np.nan_to_num(np.arccos(np.minimum(cosine, 1.0)))
    return least


def _ratio(swing_deg: float, largest: float | None) -> float:
    least = 1 / np.sin(np.radians(swing_deg) / 2)
    if largest is None:
        return float(max(TURNING_RATIO, 2 * least))
    if largest <= least * 1.0001:
        found = f"found {largest:g}, but with a swing of {swing_deg:g} deg rocker over crank is larger"
        enough = rounded_up(least * 1.0002, 4)
        raise DesignError("largest_ratio", found, f"give at least {enough}", value=enough)
    return largest


def _free_at(swing: float, turn: float, ratio: float) -> float:
    """Least free angle, rad, at which no link is longer than `ratio` cranks; the ratio falls as the angle grows."""
    cotangent = ratio
    for half in (0.5 * turn, 0.5 * (turn - swing)):
        margin = ratio**2 * np.sin(swing / 2) ** 2 - np.sin(half) ** 2
        with np.errstate(divide="ignore"):
            cotangent = min(cotangent, np.sqrt(np.divide(margin, np.cos(half) ** 2)))
    return float(np.arctan2(1.0, cotangent))


def _family(swing: float, turn: float, ends: tuple[float, float], name: str, length: float) -> Family:
    free = member_angles(*ends)
    sizes = _sizes(swing, turn, free)
    scale = length / sizes[name]
    sizes = {k: np.full_like(free, length) if k == name else scale * size for k, size in sizes.items()}
    fit = within_size_limits(*sizes.values())
    return Family(
        linkage=four_bars({k: size[fit] for k, size in sizes.items()}),
        free_angle_deg=np.degrees(free[fit]),
        transmission_angle_deg=np.degrees(_transmission(swing, turn, free[fit])),
        range_deg=(float(np.degrees(ends[0])), float(np.degrees(ends[1]))),
    )
