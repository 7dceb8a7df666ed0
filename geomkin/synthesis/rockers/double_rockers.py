"""What a four-bar that stands at two places does between them: defects, the way back, the transmission angle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar

import numpy as np

from ...core.arguments import between, checked
from ...core.errors import DesignError
from ...core.fields import Size, last_fit, rounded_down, rounded_up
from ...core.records import record
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Mask, Real, Whole, cross
from ..rounding import Rounding
from .families import RATIO, AbstractMember, Family, four_bars, highest, members, scale_of, the_choice, within_sizes

# rad by which a rocker's real swing may miss the wanted one: rounding misses by far less, another turn by 2 pi.
MISSED = 1e-6
# Share of the longest link by which a four-bar may be Grashof's and still have but one circuit: a change point.
# Smaller, and rounding makes two circuits of a parallelogram's one; larger, and it joins two that do not meet.
MEETS = 1e-12
# rad of the transmission angle, below which a place is a dead centre, from which nothing tells the way on. Smaller, and
# rounding decides, which is the root of a number's last digit there; larger, and it takes poor drives for none.
DEAD = 1e-6


@record
class TwoPlaces:
    """The two places, rad."""

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
        """Coefficients, of 1/ground, 1/crank and 1/rocker, whose sum is 0. As products: differences lose digits."""
        (one, other), (first, second) = self.crank, self.rocker
        relative = self.crank_swing - self.rocker_swing
        return np.array([
            np.sin(0.5 * (one + other - first - second)) * np.sin(0.5 * relative),
            -np.sin(0.5 * (first + second)) * np.sin(0.5 * self.rocker_swing),
            np.sin(0.5 * (one + other)) * np.sin(0.5 * self.crank_swing),
        ])  # fmt: skip


@record(eq=False)
class Between:
    """What four-bars do between the two places, (linkages,): masks, the branch, and the least transmission, rad."""

    circuit: Mask
    branch: Mask
    order: Mask
    turns_back: Mask
    sign: Whole
    least: Real
    at_places: Real

    @property
    def sound(self) -> Mask:
        return ~(self.circuit | self.branch | self.order)

    def defects(self, k: int) -> tuple[str, ...]:
        return tuple(name for name in ("circuit", "branch", "order") if getattr(self, name)[k])


def between_places(wanted: TwoPlaces, sizes: Mapping[str, Real]) -> Between:
    """Of four-bars that stand at both places. Circuits by the joint that faces the shortest link; derived here."""
    with np.errstate(all="ignore"):
        return _of_lengths(wanted, *(sizes[name] for name in ("ground", "crank", "coupler", "rocker")))


def _of_lengths(wanted: TwoPlaces, ground: Real, crank: Real, coupler: Real, rocker: Real) -> Between:
    start, end = sorted(wanted.crank)
    spans = [_square(ground, crank, turn) for turn in wanted.crank]
    # Crank and ground in line, if they are on the way: the diagonal is least, or greatest.
    for turn in (0.0, np.pi):
        if _inside(turn, start, end):
            spans.append(_square(ground, crank, turn))
    least_span, most_span = np.min(spans, axis=0), np.max(spans, axis=0)
    closed = (least_span > (coupler - rocker) ** 2) & (most_span < (coupler + rocker) ** 2)
    cosines = [(coupler**2 + rocker**2 - span) / (2 * coupler * rocker) for span in (least_span, most_span)]
    at_places = [(coupler**2 + rocker**2 - span) / (2 * coupler * rocker) for span in spans[:2]]
    signs, joints = zip(*(_joints(ground, crank, rocker, *place) for place in zip(wanted.crank, wanted.rocker)))
    shortest = np.argmin([ground, crank, coupler, rocker], axis=0)
    lengths = np.sort([ground, crank, coupler, rocker], axis=0)
    grashof = lengths[1] + lengths[2] - lengths[0] - lengths[3] > MEETS * lengths[3]
    # The joint that is not at the shortest link: ground or crank, rocker pin; coupler, crank pivot; rocker, crank pin.
    facing = [np.choose(shortest, [joint[0], joint[0], joint[1], joint[2]]) for joint in joints]
    circuit = grashof & (np.sign(facing[0]) != np.sign(facing[1]))
    at_least = np.arccos(np.minimum(np.abs(at_places).max(axis=0), 1.0))
    branch = ~circuit & ((signs[0] != signs[1]) | (at_least < DEAD))
    swing = _swing(wanted, ground, crank, coupler, rocker, signs[0])
    order = ~circuit & ~branch & (~closed | (np.abs(swing - wanted.rocker_swing) > MISSED))
    back = np.zeros_like(closed)
    for reach, side in ((coupler + crank, 1), (crank - coupler, -1)):
        cosine = (ground**2 + reach**2 - rocker**2) / (2 * ground * reach)
        at = side * signs[0] * np.arccos(cosine)
        back |= _inside(at, start, end)
    return Between(
        circuit=circuit,
        branch=branch,
        order=order,
        turns_back=back,
        sign=np.where(signs[0] < 0, -1, 1),
        least=np.where(closed, np.arccos(np.minimum(np.abs(cosines).max(axis=0), 1.0)), np.nan),
        at_places=at_least,
    )


def _square(ground: Real, crank: Real, turn: float) -> Real:
    """Of the diagonal from the crank pin to the rocker's pivot."""
    square: Real = (ground - crank) ** 2 + 4 * ground * crank * np.sin(0.5 * turn) ** 2
    return square


def _inside(turn: Real | float, start: float, end: float) -> Mask:
    """Whether an angle, or the same some turns on, lies on the way."""
    return np.asarray(np.mod(np.asarray(turn) - start, 2 * np.pi) < end - start)


def _joints(ground: Real, crank: Real, rocker: Real, turn: float, out: float) -> tuple[Real, tuple[Real, Real, Real]]:
    """The branch, and the sines at rocker pin, crank pivot and crank pin, of which the signs count."""
    ahead: Complex = crank * np.exp(1j * turn)
    arm: Complex = rocker * np.exp(1j * out)
    rod = ground + arm - ahead
    side = cross(rod, arm)
    return np.sign(side), (side, np.sin(turn) + 0 * ground, cross(ahead, rod))


def _swing(wanted: TwoPlaces, ground: Real, crank: Real, coupler: Real, rocker: Real, sign: Real) -> Real:
    """The rocker's way from the first place, on its branch, while the crank goes all its way, rad."""

    def out(turn: float) -> Real:
        # The diagonal from the rocker's pivot turns about the shorter of ground and crank, and the rocker leans on it.
        behind = np.angle(1 - crank / ground * np.exp(1j * turn))
        ahead = turn + np.angle(1 - ground / crank * np.exp(-1j * turn))
        square = _square(ground, crank, turn)
        lean = (square + rocker**2 - coupler**2) / (2 * rocker * np.sqrt(square))
        angle: Real = np.where(crank < ground, behind, ahead) - sign * np.arccos(np.clip(lean, -1, 1))
        return angle

    swing: Real = out(wanted.crank[1]) - out(wanted.crank[0])
    return swing


Start = Annotated[float, between(-360, 360, "deg")]
Swing = Annotated[float, between(-359, 359, "deg")]
Ratio = Annotated[float, between(1, 1e6)]
# Least swing, deg. Of smaller ones the two places are so alike that rounding decides the lengths.
LEAST_SWING_DEG = 0.1
# Of the three coefficients that tie the lengths together, the share of 1 below which one is 0: what is left of places
# that mirror each other in the ground line, or of like directions. Larger, and it is taken for a number that is meant.
NOTHING = 1e-12
# Frames of the way in which the chosen one is simulated.
FRAMES = 721


@record(eq=False, kw_only=True)
class DoubleRocker(AbstractMember):
    """The four-bar that was chosen to swing two rockers together, and what it does as it is moved.

    drive: the crank at the start and end of its swing, rad. transmission_angle_deg: the least on the way, nan where
    it does not close all the way. defects: "circuit" or "branch" where the end is reached only by taking it apart, or
    past a dead centre; "order" where the crank cannot go there in the sense that was asked, or the rocker goes there
    the other way round. rocker_swing_deg: from the first to the last place, as simulated; overshoot_deg: how far the
    rocker goes beyond either on the way.
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
    """The four-bar that swings two rockers together, from where they begin, with the best transmission on the way.

    The crank drives. Angles are deg from the ground line, which goes from the crank's pivot to the rocker's, each of
    the direction from a ground pivot to its pin; swings counterclockwise positive. ground: mm. One length stays free:
    the best has the largest least transmission angle of those without a defect, and rather of those whose rocker goes
    beyond neither of its places. crank or rocker, mm, takes the linkage with that length instead, whatever its defects,
    and free_angle_deg, 0 to 90, the one at that place in `family`. largest_ratio: longest link over the shortest of
    the best, 100 where it is left out.

    A linkage with a defect is told as such at once, by the exact rule, and returned where the family has none without.
    DesignError where no lengths above 0 fit; where the two places mirror each other in the ground line, which all
    lengths fit and all go through a dead centre; and where the family's links are all too unlike. Derived here: that
    the coupler is as long in both places is linear in 1/ground, 1/crank and 1/rocker (Freudenstein, Approximate
    synthesis of four-bar linkages, Transactions of the ASME 77, 1955), so the family runs from one end, where one of
    the three has no end, to another, and tan(free angle) weighs the two.
    """
    for name, swing in (("crank_swing_deg", crank_swing_deg), ("rocker_swing_deg", rocker_swing_deg)):
        if abs(swing) < LEAST_SWING_DEG:
            raise DesignError(name, f"found {swing:g} deg", f"give at least {LEAST_SWING_DEG:g} deg either way")
    wanted = TwoPlaces(*np.radians([crank_start_deg, crank_swing_deg, rocker_start_deg, rocker_swing_deg]).tolist())
    ends = _ends(wanted)
    family = _family(wanted, ends, ground)
    given = {"crank": crank, "rocker": rocker, "free_angle_deg": free_angle_deg}
    choice = the_choice(given)
    ratio = RATIO if largest_ratio is None else largest_ratio
    if choice is None:
        free, at_largest = _best(wanted, ends, ratio)
        weights = np.cos(free), np.sin(free)
    else:
        # Of very long links the weights keep more digits than the angle.
        weights, at_largest = _weights_of(*choice, ground, ends), False
        free = float(np.arctan2(weights[1], weights[0]))
    inverse = weights[0] * ends[0] + weights[1] * ends[1]
    sizes = {k: float(size[0]) for k, size in _lengths(wanted, inverse[:, None]).items()}
    scale = scale_of(sizes, "ground", ground)
    told = between_places(wanted, {k: np.array([size]) for k, size in sizes.items()})
    # What was given is kept to the last digit.
    lengths = crank or scale * sizes["crank"], scale * sizes["coupler"], rocker or scale * sizes["rocker"]
    linkage, branch = FourBar(ground, *lengths), int(told.sign[0])
    return DoubleRocker(
        linkage=linkage,
        branch=branch,
        drive=np.array(wanted.crank),
        defects=told.defects(0),
        **_measured(linkage, branch, *wanted.crank),
        free_angle_deg=float(np.degrees(free)),
        largest_ratio=ratio,
        at_largest_ratio=at_largest,
        family=family,
    )


def _ends(wanted: TwoPlaces) -> tuple[Real, Real]:
    """The two ends of the family as 1/ground : 1/crank : 1/rocker, each of its largest as unit; DesignError for none.

    What the tie leaves of the three being positive is a wedge between two rays, on each of which one of them is 0.
    """
    tie = np.where(np.abs(wanted.tie) < NOTHING, 0.0, wanted.tie)
    if not tie.any():
        problem = "the two places mirror each other in the ground line: all lengths fit, and all pass a dead centre"
        raise DesignError("rocker_start_deg", problem, "move one of the starts, or change a swing")
    if not ((tie > 0).any() and (tie < 0).any()):
        raise DesignError(
            "rocker_start_deg",
            f"found {np.degrees(wanted.rocker_start):g} deg, from which no lengths above 0 fit both swings",
            _another_start(wanted),
        )
    rays = [np.eye(3)[k] for k in range(3) if tie[k] == 0]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if tie[i] * tie[j] < 0:
            ray = np.zeros(3)
            ray[i], ray[j] = abs(tie[j]), abs(tie[i])
            rays.append(ray / ray.max())
    return rays[0], rays[1]


def _another_start(wanted: TwoPlaces) -> str:
    """The nearest whole degree at which the rocker may begin, as a remedy."""
    for step in range(1, 181):
        for way in (1, -1):
            start = round(np.degrees(wanted.rocker_start)) + way * step
            turned = TwoPlaces(wanted.crank_start, wanted.crank_swing, np.radians(start), wanted.rocker_swing)
            tie = turned.tie
            if abs(start) <= 360 and (tie > 1e-3).any() and (tie < -1e-3).any():
                return f"give {start} deg, the nearest at which there are some, or another swing"
    return "give another start of the crank, or another swing"


def _sizes(wanted: TwoPlaces, ends: tuple[Real, Real], free: Real) -> dict[str, Real]:
    """Lengths, ground 1, at free angles inside the family; nan and infinity at its ends."""
    return _lengths(wanted, ends[0][:, None] * np.cos(free) + ends[1][:, None] * np.sin(free))


def _lengths(wanted: TwoPlaces, inverse: Real) -> dict[str, Real]:
    """The same from 1/ground : 1/crank : 1/rocker, (3, linkages)."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        crank, rocker = inverse[0] / inverse[1], inverse[0] / inverse[2]
        couplers = [
            np.abs(1 + rocker * np.exp(1j * out) - crank * np.exp(1j * turn))
            for turn, out in zip(wanted.crank, wanted.rocker)
        ]
        return {
            "ground": np.ones_like(crank),
            "crank": crank,
            "coupler": 0.5 * (couplers[0] + couplers[1]),
            "rocker": rocker,
        }


def _weights_of(name: str, value: float, ground: float, ends: tuple[Real, Real]) -> tuple[float, float]:
    """How much of each end is in the linkage that is asked for; DesignError where there is none."""
    if name == "free_angle_deg":
        if not 0 < value < 90:
            raise DesignError(name, f"found {value:g}", "give more than 0 and less than 90 deg")
        return float(np.cos(np.radians(value))), float(np.sin(np.radians(value)))
    k, length = 1 if name == "crank" else 2, value / ground
    weights = [float(end[k] * length - end[0]) for end in ends]
    if weights[0] * weights[1] < 0 and min(map(abs, weights)) > NOTHING * (1 + length):
        return abs(weights[1]), abs(weights[0])
    # At an end where ground and link vanish beside the third, their ratio is that of all the others.
    told = [ground * float(end[0] / end[k]) if end[k] else np.inf for end in ends if end[0] or end[k]]
    low, high = min(told), max(told)
    if high - low <= NOTHING * low:
        remedy = f"leave it out: it is {low:.7g} mm in all of them"
    elif np.isfinite(high):
        remedy = f"give more than {rounded_up(low)} and less than {rounded_down(high)} mm"
    else:
        remedy = f"give more than {rounded_up(low)} mm"
    raise DesignError(name, f"found {value:g} mm, which fits no other lengths", remedy)


def _best(wanted: TwoPlaces, ends: tuple[Real, Real], largest: float) -> tuple[float, bool]:
    """The best free angle, and whether it stands at the largest ratio."""

    def ratio(free: Real) -> Real:
        sizes = np.array(list(_sizes(wanted, ends, free).values()))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = sizes.max(axis=0) / sizes.min(axis=0)
        return np.where(np.isnan(ratios), np.inf, ratios)

    def score(free: Real) -> Real:
        """Rad, and a step above that for each thing that is in order; what is too unlike comes last."""
        told = between_places(wanted, _sizes(wanted, ends, free))
        steps = np.where(told.sound, np.where(told.turns_back, 10.0, 20.0) + told.least, told.at_places)
        return np.where(ratio(free) <= largest, np.nan_to_num(steps), -np.inf)

    start, end = 0.0, 0.5 * np.pi
    alike = highest(lambda free: -ratio(free), start, end)
    least = float(ratio(np.array([alike]))[0])
    if not least < largest:
        found = f"found {largest:g}, but of the lengths that fit the longest is {least:.6g} times the shortest and more"
        raise DesignError("largest_ratio", found, f"give at least {rounded_up(1.001 * least, 4)}")
    # The search starts from looks over all, and again over the part about the most alike, where a hard limit leaves
    # but a sliver between two looks.

    def fits(free: float) -> bool:
        return bool(ratio(np.array([free]))[0] <= largest)

    sides = [out if fits(out) else last_fit(fits, alike, out) for out in (start, end)]
    tops = [highest(score, start, end), highest(score, *sides)]
    best = max(tops, key=lambda free: float(score(np.array([free]))[0]))
    return best, bool(float(ratio(np.array([best]))[0]) > (1 - 1e-6) * largest)


def _measured(linkage: FourBar, branch: int, start: float, end: float) -> dict[str, Any]:
    """What the crank's way from `start` to `end`, rad, shows: all nan if the linkage does not close all the way."""
    names = "transmission_angle_deg", "rocker_swing_deg", "overshoot_deg"
    size = {name: float(getattr(linkage, name)) / float(linkage.ground) for name in ("crank", "coupler", "rocker")}
    # Besides even frames: crank and ground in line, where it drives worst, and crank and coupler, where it goes back.
    special = [0.0, np.pi]
    for reach in (size["coupler"] + size["crank"], size["crank"] - size["coupler"]):
        cosine = (1 + reach**2 - size["rocker"] ** 2) / (2 * reach) if reach else np.inf
        special += [np.arccos(cosine), -np.arccos(cosine)] if abs(cosine) <= 1 else []
    way = np.sign(end - start)
    after = np.mod(way * (np.array(special) - start), 2 * np.pi)
    frames = np.sort(np.concatenate([np.linspace(0, abs(end - start), FRAMES), after[after < abs(end - start)]]))
    motion = move(linkage, start + way * frames, branch)
    if not motion.assembled.all():
        return dict.fromkeys(names, np.nan)
    out = np.unwrap(np.angle(motion.bodies["rocker"].direction))
    beyond = float(np.ptp(out)) - abs(float(out[-1] - out[0]))
    return dict(zip(names, np.degrees([np.min(motion.transmission_angle), out[-1] - out[0], beyond]).tolist()))


def _family(wanted: TwoPlaces, ends: tuple[Real, Real], ground: float) -> Family:
    free = members(0.0, 0.5 * np.pi)
    sizes = {name: ground * size for name, size in _sizes(wanted, ends, free).items()}
    fit = within_sizes(*sizes.values())
    told = between_places(wanted, sizes)
    return Family(
        linkage=four_bars({name: size[fit] for name, size in sizes.items()}),
        free_angle_deg=np.degrees(free[fit]),
        transmission_angle_deg=np.degrees(np.where(told.sound, told.least, np.nan)[fit]),
        range_deg=(0.0, 90.0),
    )
