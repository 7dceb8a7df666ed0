"""The least base circle that keeps the pressure angle in bounds and the profile whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from ..plane.vec import Mask, Real
from .cam import Cam, Direction, check_lifts, turning_sense
from .extrema import exceeds, largest, samples
from .followers.flat import straight_face_base_radius
from .followers.follower import AbstractFollower, Follower
from .program.program import FollowerMotion, Program
from .undercut import Undercut, undercut

# Base radii tried before the least is closed in on. Good ones between bad ones are found where they cover a
# stretch wider than a step: 7 % of the radius, or a 240th of what an arm can reach. Fewer miss more of them, more take
# as much longer.
TRIED = 240
# Halvings that close in on a radius, to 1e-12 of it: fewer lose digits, more only find rounding.
HALVINGS = 36
# Shares of the size of lifts, rates and follower. The least base radius tried: a larger one calls a small cam the
# least, a smaller one is lost in rounding. And one at which flanks that cross on smaller cams no longer do: less
# refuses programmes that a large cam could run.
SMALLEST, FAR = 1e-5, 1e3

Limit = Literal["pressure angle", "undercut", "reach", "nothing"]


@record
class BaseCircle:
    """The least base circle within limits. radius, mm: larger ones keep them too, up to `largest`.

    limit: what forbids a smaller one. "reach": the arm or the offset; "nothing": even one of a 100,000th of the size of
    lifts and follower will do, and the radius is 0. cam_angle: where it would be broken, rad; nan where no angle is to
    blame. Derived here.
    """

    radius: float
    largest: float
    limit: Limit
    cam_angle: float


@checked
def least_base_circle(
    follower: Follower,
    program: Program,
    direction: Direction = "counterclockwise",
    pressure_angle_deg: float = 30.0,
    least_radius: float = 0.0,
) -> BaseCircle:
    """The least base circle whose cam leans on its follower by no more than `pressure_angle_deg`, to either side,
    is undercut nowhere, and where convex has no radius of curvature below `least_radius`, mm.

    `pressure_angle_deg` is above 0 and at most 90. Where good radii lie between bad ones it is the lower end of the
    uppermost such stretch. Raises DesignError where no base circle will do.

    Source: the two limits that size a cam are those of Norton, Cam Design and Manufacturing Handbook; the search for
    the least radius within them is made here.
    """
    if not 0 < pressure_angle_deg <= 90:
        raise DesignError("pressure_angle_deg", f"found {pressure_angle_deg}", "give more than 0 and at most 90 deg")
    if not 0 <= least_radius < np.inf:
        raise DesignError("least_radius", f"found {least_radius}", "give 0 mm or more")
    check_lifts(follower, program)
    places = samples(program.breaks)
    motion = program.motion(places)
    low, high = follower.base_radii(float(motion.lift.max()))
    scale = max(float(np.abs(v).max()) for v in (motion.lift, motion.velocity, motion.acceleration))
    scale = max(scale, 1e-3, follower.size)
    sense = turning_sense(direction)
    follower.check(program, 0.5 * (low + high) if np.isfinite(high) else low + scale, sense)
    rules = _rules(follower, sense, np.radians(pressure_angle_deg), least_radius)

    def excess(radii: Real) -> Real:
        """By how much each rule is broken on the samples, (rules, radii)."""
        return np.array([[rule(motion, radius).max() for radius in radii] for rule in rules.values()])

    tried = _tried(low, high, scale, excess)
    seen = excess(tried)
    good: Mask = np.asarray((seen <= 0).all(axis=0))
    if not good.any():
        raise _hopeless(rules, seen, pressure_angle_deg)
    last = len(good) - 1 - int(good[::-1].argmax())
    first = last - int(np.append(good[last::-1], False).argmin()) + 1
    # A hill of the pressure angle may stand between two samples: a small cam's is narrow.
    fits = _fitting(program, rules)
    while first < last and not fits(float(tried[first])):
        first += 1
    while last > first and not fits(float(tried[last])):
        last -= 1
    most = high if last == len(good) - 1 else _border(program, rules, *tried[[last, last + 1]].tolist())[0]
    if first:
        radius, limit, angle = _border(program, rules, *tried[[first, first - 1]].tolist())
        exact = follower.least_base_radius(program, least_radius)
        radius = exact if limit == "undercut" and exact is not None else radius
    else:
        radius, limit, angle = low, "reach" if low else "nothing", np.nan
    return _uncrossed(follower, program, direction, BaseCircle(radius, most, limit, angle), scale)


@checked
def flat_face_base_radius(program: Program, least_radius: float = 0.0, tilt_deg: float = 0.0) -> float:
    """Least base radius, mm, for which a translating flat face leaves no radius of curvature below `least_radius`.

    It is least_radius - min(s + s'') cos(tilt), exactly. Below 0 any will do.

    Source: Rothbart, Cams (1956), flat-faced follower; the tilted face derived here.
    """
    return straight_face_base_radius(program, least_radius, tilt_deg)


# By how much a rule is broken at each cam angle of a motion, with a base radius in mm; above 0 where it is.
Rule = Callable[[FollowerMotion, float], Real]


def _rules(follower: AbstractFollower, sense: int, steepest: float, least_radius: float) -> dict[Limit, Rule]:
    """What may not exceed 0 anywhere: functions of a motion and a base radius."""

    def leaning(motion: FollowerMotion, radius: float) -> Real:
        return np.abs(follower.contact(motion, radius, sense).pressure_angle) - steepest * (1 + 1e-12)

    def sharp(motion: FollowerMotion, radius: float) -> Real:
        return follower.undercut_violation(motion, radius, sense, least_radius)

    return {"pressure angle": leaning, "undercut": sharp}


def _tried(low: float, high: float, scale: float, excess: Callable[[Real], Real]) -> Real:
    """Rising base radii, mm, over all that the follower allows."""
    if np.isfinite(high):
        return low + (high - low) * (np.arange(TRIED) + 0.5) / TRIED
    top = 8 * scale
    while (excess(np.array([low + top])) > 0).any() and top < 1e6 * scale:
        top *= 2
    return low + np.geomspace(SMALLEST * scale, 4 * top, TRIED)


def _border(program: Program, rules: dict[Limit, Rule], good: float, bad: float) -> tuple[float, Limit, float]:
    """The last good base radius on the way to a bad one, the rule that forbids more, and the cam angle."""
    fits = _fitting(program, rules)
    for _ in range(HALVINGS):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if fits(middle) else (good, middle)
    _, angle, name = max((*_largest(program, rule, bad), name) for name, rule in rules.items())
    return good, name, angle


def _fitting(program: Program, rules: dict[Limit, Rule]) -> Callable[[float], bool]:
    """Tells of a base radius whether it breaks no rule anywhere."""
    places = samples(program.breaks)
    motion = program.motion(places)

    def fits(radius: float) -> bool:
        seen = [rule(motion, radius) for rule in rules.values()]
        # Where the samples show a rule broken, no closer look is needed.
        if not all(values.max() <= 0 for values in seen):
            return False

        def is_broken(rule: Rule, values: Real) -> bool:
            return exceeds(places, values, lambda t: rule(program.motion(t), radius), 0.0)

        return not any(is_broken(rule, values) for rule, values in zip(rules.values(), seen))

    return fits


def _largest(program: Program, rule: Rule, radius: float) -> tuple[float, float]:
    return largest(program.breaks, lambda t: rule(program.motion(t), radius))


def _uncrossed(
    follower: AbstractFollower, program: Program, direction: Direction, found: BaseCircle, scale: float
) -> BaseCircle:
    """The same, or a larger one where flanks of the profile cross or its velocity jumps."""

    def crossed(radius: float) -> Undercut | None:
        cut = undercut(Cam(follower, program, radius, direction))
        return cut if cut.found else None

    # A touch more than the border itself, where rounding decides.
    bad = max(found.radius * (1 + 1e-9), SMALLEST * scale)
    last = crossed(bad) if bad < found.largest else None
    if last is None:
        return found
    good = min(FAR * max(bad, scale), found.largest * (1 - 1e-6))
    if cut := crossed(good):
        raise DesignError(
            "program",
            f"at {np.degrees(cut.worst[1]):.4g} deg the velocity jumps, which undercuts a cam of any size",
            "give a law of motion without such a jump there",
        )
    while good - bad > 1e-9 * good:
        middle = 0.5 * (good + bad)
        if cut := crossed(middle):
            bad, last = middle, cut
        else:
            good = middle
    return replace(found, radius=good, limit="undercut", cam_angle=last.worst[1])


def _hopeless(rules: dict[Limit, Rule], excess: Real, pressure_angle_deg: float) -> DesignError:
    never = [name for name, least in zip(rules, excess.min(axis=1).tolist()) if least > 0]
    what = " and ".join(never) or "one of pressure angle and undercut"
    return DesignError(
        "base_radius",
        f"with any that the follower allows, {what} is beyond its limit (pressure angle {pressure_angle_deg:g} deg)",
        "give longer segments, another follower or a larger pressure angle",
    )
