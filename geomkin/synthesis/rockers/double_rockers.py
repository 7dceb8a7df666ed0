"""Double rockers: a four-bar that moves between two given positions, its defects, and the best of the family."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar

import numpy as np

from ...core.arguments import between, checked
from ...core.errors import DesignError
from ...core.fields import Size, inside, last_fit, rounded_up
from ...core.records import record
from ...core.units import bare_mm, mm
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Mask, Real, Whole, cross
from ..found import Rounding
from .families import (
    RATIO,
    AbstractMember,
    Family,
    four_bars,
    given_choice,
    maximise,
    member_angles,
    scale_for_link,
    within_size_limits,
)

# Largest error of a rocker's simulated swing, rad. Rounding is far smaller; a different number of turns is 2 pi.
MISSED = 1e-6
# A four-bar that satisfies Grashof's condition by at most this share of its longest link has a change point, hence one
# circuit. A smaller value splits the circuit of a parallelogram by rounding; a larger one joins two separate circuits.
CHANGE_POINT = 1e-12
# Transmission angle, rad, below which a position counts as a dead centre, where the direction of motion is
# undetermined. Below this value rounding decides (it is the square root of a number's last digit); above it poor
# linkages are refused.
DEAD = 1e-6


@record
class TwoPositions:
    """Directions of both rockers in the two positions, rad."""

    crank_start: float
    crank_swing: float
    rocker_start: float
    rocker_swing: float

    @property
    def crank(self) -> tuple[float, float]:
        return self.crank_start, self.crank_start + self.crank_swing

    @property
    def rocker(self) -> tuple[float, float]:
        return self.rocker_start, self.rocker_start + self.rocker_swing

    @property
    def tie(self) -> Real:
        """Coefficients of 1/ground, 1/crank and 1/rocker in the loop condition, as products that keep their digits.

        Their sum is 0.
        """
        (crank_1, crank_2), (rocker_1, rocker_2) = self.crank, self.rocker
        relative = self.crank_swing - self.rocker_swing
        return np.array([
            np.sin(0.5 * (crank_1 + crank_2 - rocker_1 - rocker_2)) * np.sin(0.5 * relative),
            -np.sin(0.5 * (rocker_1 + rocker_2)) * np.sin(0.5 * self.rocker_swing),
            np.sin(0.5 * (crank_1 + crank_2)) * np.sin(0.5 * self.crank_swing),
        ])  # fmt: skip


@record(eq=False)
class MotionBetween:
    """Motion of four-bars between the two positions, as arrays (linkages,): defects, branch, angles, rad."""

    circuit: Mask
    branch: Mask
    order: Mask
    turns_back: Mask
    sign: Whole
    least: Real
    transmission_at_ends: Real

    @property
    def is_sound(self) -> Mask:
        return ~(self.circuit | self.branch | self.order)

    def defects(self, k: int) -> tuple[str, ...]:
        return tuple(name for name in ("circuit", "branch", "order") if getattr(self, name)[k])


def motion_between(wanted: TwoPositions, sizes: Mapping[str, Real]) -> MotionBetween:
    """Motion of four-bars that reach both positions. The joint opposite the shortest link identifies the circuit."""
    with np.errstate(all="ignore"):
        return _motion_between(wanted, *(sizes[name] for name in ("ground", "crank", "coupler", "rocker")))


def _motion_between(wanted: TwoPositions, ground: Real, crank: Real, coupler: Real, rocker: Real) -> MotionBetween:
    start, end = sorted(wanted.crank)
    spans = [_square(ground, crank, angle) for angle in wanted.crank]
    # The diagonal is extreme with crank and ground in line, if that happens during the motion.
    for angle in (0.0, np.pi):
        if _inside(angle, start, end):
            spans.append(_square(ground, crank, angle))
    least_span, most_span = np.min(spans, axis=0), np.max(spans, axis=0)
    closed = (least_span > (coupler - rocker) ** 2) & (most_span < (coupler + rocker) ** 2)
    cosines = [(coupler**2 + rocker**2 - span) / (2 * coupler * rocker) for span in (least_span, most_span)]
    transmission_at_ends = [(coupler**2 + rocker**2 - span) / (2 * coupler * rocker) for span in spans[:2]]
    signs, joints = zip(*(_joints(ground, crank, rocker, *place) for place in zip(wanted.crank, wanted.rocker)))
    shortest = np.argmin([ground, crank, coupler, rocker], axis=0)
    lengths = np.sort([ground, crank, coupler, rocker], axis=0)
    grashof = lengths[1] + lengths[2] - lengths[0] - lengths[3] > CHANGE_POINT * lengths[3]
    # Opposite the shortest link: rocker pin for ground or crank, crank pivot for coupler, crank pin for rocker.
    facing = [np.choose(shortest, [joint[0], joint[0], joint[1], joint[2]]) for joint in joints]
    circuit = grashof & (np.sign(facing[0]) != np.sign(facing[1]))
    at_least = np.arccos(np.minimum(np.abs(transmission_at_ends).max(axis=0), 1.0))
    branch = ~circuit & ((signs[0] != signs[1]) | (at_least < DEAD))
    swing = _swing(wanted, ground, crank, coupler, rocker, signs[0])
    order = ~circuit & ~branch & (~closed | (np.abs(swing - wanted.rocker_swing) > MISSED))
    turns_back = np.zeros_like(closed)
    for reversal_length, side in ((coupler + crank, 1), (crank - coupler, -1)):
        cosine = (ground**2 + reversal_length**2 - rocker**2) / (2 * ground * reversal_length)
        reversal_angle = side * signs[0] * np.arccos(cosine)
        turns_back |= _inside(reversal_angle, start, end)
    return MotionBetween(
        circuit=circuit,
        branch=branch,
        order=order,
        turns_back=turns_back,
        sign=np.where(signs[0] < 0, -1, 1),
        least=np.where(closed, np.arccos(np.minimum(np.abs(cosines).max(axis=0), 1.0)), np.nan),
        transmission_at_ends=at_least,
    )


def _square(ground: Real, crank: Real, angle: float) -> Real:
    """Square of the diagonal from the crank pin to the rocker's pivot."""
    square: Real = (ground - crank) ** 2 + 4 * ground * crank * np.sin(0.5 * angle) ** 2
    return square


def _inside(angle: Real | float, start: float, end: float) -> Mask:
    """Whether an angle, or the same angle some turns later, lies between start and end."""
    return np.asarray(np.mod(np.asarray(angle) - start, 2 * np.pi) < end - start)


def _joints(
    ground: Real, crank: Real, rocker: Real, crank_angle: float, rocker_angle: float
) -> tuple[Real, tuple[Real, Real, Real]]:
    """The branch, and the sines at rocker pin, crank pivot and crank pin, whose signs identify the circuit."""
    crank_pin: Complex = crank * np.exp(1j * crank_angle)
    arm: Complex = rocker * np.exp(1j * rocker_angle)
    rod = ground + arm - crank_pin
    side = cross(rod, arm)
    return np.sign(side), (side, np.sin(crank_angle) + 0 * ground, cross(crank_pin, rod))


def _swing(wanted: TwoPositions, ground: Real, crank: Real, coupler: Real, rocker: Real, sign: Real) -> Real:
    """Swing of the rocker, rad, on the branch of the first position while the crank moves to the second one."""

    def rocker_angle(angle: float) -> Real:
        # The direction of the diagonal oscillates about the longer of ground and crank; the rocker's angle to it
        # follows from the triangle.
        about_ground = np.angle(1 - crank / ground * np.exp(1j * angle))
        about_crank = angle + np.angle(1 - ground / crank * np.exp(-1j * angle))
        square = _square(ground, crank, angle)
        cosine = (square + rocker**2 - coupler**2) / (2 * rocker * np.sqrt(square))
        direction: Real = np.where(crank < ground, about_ground, about_crank) - sign * np.arccos(np.clip(cosine, -1, 1))
        return direction

    swing: Real = rocker_angle(wanted.crank[1]) - rocker_angle(wanted.crank[0])
    return swing


Start = Annotated[float, between(-360, 360, "deg")]
Swing = Annotated[float, between(-359, 359, "deg")]
Ratio = Annotated[float, between(1, 1e6)]
# Smallest swing, deg. For smaller ones the two positions are so alike that rounding decides the lengths.
MIN_SWING_DEG = 0.1
# A loop coefficient below this, relative to 1, counts as 0: it results from the rounding of positions that mirror each
# other in the ground line, or of equal directions. A larger value would discard true coefficients.
ZERO_COEFFICIENT = 1e-12
# Frames of the simulated motion of the chosen linkage.
FRAMES = 721


@record(eq=False, kw_only=True)
class DoubleRocker(AbstractMember):
    """The four-bar chosen by `double_rocker`, with its simulated motion.

    Parameters
    ----------
    linkage : FourBar
        The linkage; its crank is the driving rocker.
    branch : int
        +1 or -1, as `move` takes it.
    drive : array, shape (2,)
        Crank angles at the start and end of its swing, rad.
    transmission_angle_deg : float
        Least transmission angle of the motion; nan if the linkage does not close everywhere.
    defects : tuple of str
        "circuit" or "branch" if the end position is reached only by disassembly or through a dead centre; "order" if
        the crank cannot move there in the given sense, or the rocker moves there in the other sense.
    rocker_swing_deg : float
        Swing of the rocker from the first to the last position, from the simulation.
    overshoot_deg : float
        Angle by which the rocker moves beyond its two positions.
    free_angle_deg, largest_ratio, at_largest_ratio, family
        The position in the family and the limit of the search, see `Family` and `double_rocker`.
    """

    measured: ClassVar = ("rocker_swing_deg", "overshoot_deg")

    linkage: FourBar
    rocker_swing_deg: float
    overshoot_deg: float

    def rounded(self, rounding: Rounding) -> DoubleRocker:
        linkage = rounding.linkage(self.linkage)
        return replace(self, linkage=linkage, **_measured(linkage, self.branch, *self.drive.tolist()))


@checked
def double_rocker(
    crank_start_deg: Start,
    crank_swing_deg: Swing,
    rocker_start_deg: Start,
    rocker_swing_deg: Swing,
    ground: Size = 1.0,
    *,
    crank: Size | None = None,
    rocker: Size | None = None,
    free_angle_deg: float | None = None,
    largest_ratio: Ratio | None = None,
) -> DoubleRocker:
    """Find the four-bar that moves two rockers between given positions with the best transmission angle.

    The crank drives. One length is free: the best linkage has the largest least transmission angle among those without
    defects; linkages whose rocker stays between its two positions come first.

    Parameters
    ----------
    crank_start_deg : float
        Direction of the crank at the start, -360 to 360 deg from the ground line, which points from the crank's pivot
        to the rocker's.
    crank_swing_deg : float
        Swing of the crank, counterclockwise positive, 0.1 to 359 deg in either sense.
    rocker_start_deg, rocker_swing_deg : float
        The same for the rocker, measured at its ground pivot.
    ground : float
        Distance of the ground pivots, mm.
    crank, rocker : float, optional
        One length, mm: selects the linkage that has it, even if it has defects.
    free_angle_deg : float, optional
        Another choice: the member at this position in `family`, 0 to 90 deg.
    largest_ratio : float, optional
        Largest ratio of the longest link to the shortest in the search for the best; 100 by default.

    Returns
    -------
    DoubleRocker
        The linkage with its simulated motion. If the whole family has defects, the best of these, with its `defects`.

    Raises
    ------
    DesignError
        If no positive lengths fit; if the two positions mirror each other in the ground line, which all lengths fit and
        all pass through a dead centre; if all members exceed `largest_ratio`.

    Notes
    -----
    Derived here: equal coupler lengths in both positions are a linear condition for 1/ground, 1/crank and 1/rocker
    (Freudenstein, Approximate synthesis of four-bar linkages, Transactions of the ASME 77, 1955). The family therefore
    runs between two ends, at each of which one of the three is 0, and the tangent of the free angle is the weight of
    one end over that of the other.

    Examples
    --------
    >>> from geomkin.synthesis import double_rocker
    >>> best = double_rocker(60, 60, 80, 40, ground=100)
    >>> best.defects, round(best.rocker_swing_deg, 6)
    ((), 40.0)
    """
    for name, swing in (("crank_swing_deg", crank_swing_deg), ("rocker_swing_deg", rocker_swing_deg)):
        if abs(swing) < MIN_SWING_DEG:
            raise DesignError(
                name, f"found {swing:g} deg", f"give at least {MIN_SWING_DEG:g} deg in either sense", "out-of-range"
            )
    wanted = TwoPositions(*np.radians([crank_start_deg, crank_swing_deg, rocker_start_deg, rocker_swing_deg]).tolist())
    ends = _ends(wanted)
    family = _family(wanted, ends, ground)
    given = {"crank": crank, "rocker": rocker, "free_angle_deg": free_angle_deg}
    choice = given_choice(given)
    ratio = RATIO if largest_ratio is None else largest_ratio
    if choice is None:
        free, at_largest = _best(wanted, ends, ratio)
        weights = np.cos(free), np.sin(free)
    else:
        # With very long links the weights keep more digits than the angle.
        weights, at_largest = _weights_for_size(*choice, ground, ends), False
        free = float(np.arctan2(weights[1], weights[0]))
    inverse = weights[0] * ends[0] + weights[1] * ends[1]
    sizes = {k: float(size[0]) for k, size in _lengths(wanted, inverse[:, None]).items()}
    scale = scale_for_link(sizes, "ground", ground)
    between = motion_between(wanted, {k: np.array([size]) for k, size in sizes.items()})
    # A given size keeps all its digits.
    lengths = crank or scale * sizes["crank"], scale * sizes["coupler"], rocker or scale * sizes["rocker"]
    linkage, branch = FourBar(ground, *lengths), int(between.sign[0])
    return DoubleRocker(
        linkage=linkage,
        branch=branch,
        drive=np.array(wanted.crank),
        defects=between.defects(0),
        **_measured(linkage, branch, *wanted.crank),
        free_angle_deg=float(np.degrees(free)),
        largest_ratio=ratio,
        at_largest_ratio=at_largest,
        family=family,
    )


def _ends(wanted: TwoPositions) -> tuple[Real, Real]:
    """Both ends of the family as 1/ground : 1/crank : 1/rocker, the largest being 1; DesignError if there is no family.

    The positive solutions of the loop condition form a wedge between two rays, on each of which one of the three is 0.
    """
    tie = np.where(np.abs(wanted.tie) < ZERO_COEFFICIENT, 0.0, wanted.tie)
    if not tie.any():
        problem = "the two positions mirror each other in the ground line, so every linkage passes a dead centre"
        raise DesignError("rocker_start_deg", problem, "move one of the starts, or change a swing")
    if not ((tie > 0).any() and (tie < 0).any()):
        problem = f"found {np.degrees(wanted.rocker_start):g} deg, with which no positive lengths fit both swings"
        raise DesignError("rocker_start_deg", problem, _another_start(wanted))
    rays = [np.eye(3)[k] for k in range(3) if tie[k] == 0]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if tie[i] * tie[j] < 0:
            ray = np.zeros(3)
            ray[i], ray[j] = abs(tie[j]), abs(tie[i])
            rays.append(ray / ray.max())
    return rays[0], rays[1]


def _another_start(wanted: TwoPositions) -> str:
    """The nearest whole degree at which the rocker may start, as a remedy."""
    for step in range(1, 181):
        for sense in (1, -1):
            start = round(np.degrees(wanted.rocker_start)) + sense * step
            changed = TwoPositions(wanted.crank_start, wanted.crank_swing, np.radians(start), wanted.rocker_swing)
            tie = changed.tie
            if abs(start) <= 360 and (tie > 1e-3).any() and (tie < -1e-3).any():
                return f"give {start} deg, the nearest start with a solution, or another swing"
    return "give another start of the crank, or another swing"


def _sizes(wanted: TwoPositions, ends: tuple[Real, Real], free: Real) -> dict[str, Real]:
    """Lengths, ground 1, at free angles inside the family; nan and infinity at its ends."""
    return _lengths(wanted, ends[0][:, None] * np.cos(free) + ends[1][:, None] * np.sin(free))


def _lengths(wanted: TwoPositions, inverse: Real) -> dict[str, Real]:
    """Lengths from 1/ground : 1/crank : 1/rocker, (3, linkages)."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        crank, rocker = inverse[0] / inverse[1], inverse[0] / inverse[2]
        couplers = [
            np.abs(1 + rocker * np.exp(1j * rocker_angle) - crank * np.exp(1j * crank_angle))
            for crank_angle, rocker_angle in zip(wanted.crank, wanted.rocker)
        ]
        return {
            "ground": np.ones_like(crank),
            "crank": crank,
            "coupler": 0.5 * (couplers[0] + couplers[1]),
            "rocker": rocker,
        }


def _weights_for_size(name: str, value: float, ground: float, ends: tuple[Real, Real]) -> tuple[float, float]:
    """Weights of both ends in the linkage that has a given size; DesignError if there is none."""
    if name == "free_angle_deg":
        if not 0 < value < 90:
            raise DesignError(name, f"found {value:g}", "give more than 0 and less than 90 deg", "out-of-range")
        return float(np.cos(np.radians(value))), float(np.sin(np.radians(value)))
    k, length = 1 if name == "crank" else 2, value / ground
    weights = [float(end[k] * length - end[0]) for end in ends]
    if weights[0] * weights[1] < 0 and min(map(abs, weights)) > ZERO_COEFFICIENT * (1 + length):
        return abs(weights[1]), abs(weights[0])
    # If ground and link both vanish at an end, their ratio is the same in the whole family.
    end_values = [ground * float(end[0] / end[k]) if end[k] else np.inf for end in ends if end[0] or end[k]]
    low, high = min(end_values), max(end_values)
    if high - low <= ZERO_COEFFICIENT * low:
        remedy = f"leave it out: it is {mm(low):.7g} in the whole family"
    elif np.isfinite(high):
        remedy = f"give more than {bare_mm(low):up} and less than {mm(high):down}"
    else:
        remedy = f"give more than {mm(low):up}"
    nearest = inside(low, -1) if value <= low or not np.isfinite(high) else inside(high, 1)
    raise DesignError(name, f"found {mm(value):g}, which no linkage of the family has", remedy, value=nearest)


def _best(wanted: TwoPositions, ends: tuple[Real, Real], largest: float) -> tuple[float, bool]:
    """The best free angle, and whether `largest` limits it."""

    def ratio(free: Real) -> Real:
        sizes = np.array(list(_sizes(wanted, ends, free).values()))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = sizes.max(axis=0) / sizes.min(axis=0)
        return np.where(np.isnan(ratios), np.inf, ratios)

    def score(free: Real) -> Real:
        """Transmission angle, rad, plus a step for each condition that holds; excessive ratios come last."""
        between = motion_between(wanted, _sizes(wanted, ends, free))
        steps = np.where(
            between.is_sound, np.where(between.turns_back, 10.0, 20.0) + between.least, between.transmission_at_ends
        )
        return np.where(ratio(free) <= largest, np.nan_to_num(steps), -np.inf)

    start, end = 0.0, 0.5 * np.pi
    least_ratio_at = maximise(lambda free: -ratio(free), start, end)
    least = float(ratio(np.array([least_ratio_at]))[0])
    if not least < largest:
        found = f"found {largest:g}, but the least ratio of all linkages that fit is {least:.6g}"
        enough = rounded_up(1.001 * least, 4)
        raise DesignError("largest_ratio", found, f"give at least {enough}", value=enough)

    def fits(free: float) -> bool:
        return bool(ratio(np.array([free]))[0] <= largest)

    # A second search covers only the interval within the limit, which may be narrower than the step of the first one.
    interval = [
        end_of_range if fits(end_of_range) else last_fit(fits, least_ratio_at, end_of_range)
        for end_of_range in (start, end)
    ]
    candidates = [maximise(score, start, end), maximise(score, *interval)]
    best = max(candidates, key=lambda free: float(score(np.array([free]))[0]))
    return best, bool(float(ratio(np.array([best]))[0]) > (1 - 1e-6) * largest)


def _measured(linkage: FourBar, branch: int, start: float, end: float) -> dict[str, Any]:
    """Simulated fields of the motion from `start` to `end`, rad; all nan if the linkage does not close everywhere."""
    names = "transmission_angle_deg", "rocker_swing_deg", "overshoot_deg"
    size = {name: float(getattr(linkage, name)) / float(linkage.ground) for name in ("crank", "coupler", "rocker")}
    # Extra frames: crank and ground in line (extreme transmission angle), crank and coupler in line (reversal).
    special = [0.0, np.pi]
    for reversal_length in (size["coupler"] + size["crank"], size["crank"] - size["coupler"]):
        cosine = (1 + reversal_length**2 - size["rocker"] ** 2) / (2 * reversal_length) if reversal_length else np.inf
        special += [np.arccos(cosine), -np.arccos(cosine)] if abs(cosine) <= 1 else []
    sense = np.sign(end - start)
    offsets = np.mod(sense * (np.array(special) - start), 2 * np.pi)
    frames = np.sort(np.concatenate([np.linspace(0, abs(end - start), FRAMES), offsets[offsets < abs(end - start)]]))
    motion = move(linkage, start + sense * frames, branch)
    if not motion.assembled.all():
        return dict.fromkeys(names, np.nan)
    rocker_angle = np.unwrap(np.angle(motion.bodies["rocker"].direction))
    overshoot = float(np.ptp(rocker_angle)) - abs(float(rocker_angle[-1] - rocker_angle[0]))
    return dict(
        zip(
            names,
            np.degrees([np.min(motion.transmission_angle), rocker_angle[-1] - rocker_angle[0], overshoot]).tolist(),
        )
    )


def _family(wanted: TwoPositions, ends: tuple[Real, Real], ground: float) -> Family:
    free = member_angles(0.0, 0.5 * np.pi)
    sizes = {name: ground * size for name, size in _sizes(wanted, ends, free).items()}
    fit = within_size_limits(*sizes.values())
    between = motion_between(wanted, sizes)
    return Family(
        linkage=four_bars({name: size[fit] for name, size in sizes.items()}),
        free_angle_deg=np.degrees(free[fit]),
        transmission_angle_deg=np.degrees(np.where(between.is_sound, between.least, np.nan)[fit]),
        range_deg=(0.0, 90.0),
    )
