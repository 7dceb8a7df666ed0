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
from .followers.follower import AbstractFollower, Follower
from .program.laws import exceeds, largest, samples
from .program.program import FollowerMotion, Program
from .undercut import Undercut, undercut

# Trial base radii. An interval of valid radii between invalid ones is found if it is wider than one step: 7 % of the
# radius, or 1/240 of the range of an arm. Fewer trials miss more intervals; more take proportionally longer.
TRIALS = 240
# Bisections of a radius, to 1e-12 of it: fewer lose digits, more only resolve rounding.
HALVINGS = 36
# Both are multiples of the size of lifts, rates and follower. SMALLEST is the smallest trial radius: a larger value
# misses small cams, a smaller one is lost in rounding. FAR is a radius at which flanks that cross on smaller cams no
# longer do: a smaller value refuses programmes that a large cam could run.
SMALLEST, FAR = 1e-5, 1e3

Limit = Literal["pressure angle", "undercut", "reach", "nothing"]


@record
class BaseCircle:
    """The least base circle within given limits.

    Parameters
    ----------
    radius : float
        Least base radius, mm.
    largest : float
        Largest base radius up to which all radii are valid, mm; inf if there is no upper limit.
    limit : {"pressure angle", "undercut", "reach", "nothing"}
        The limit that forbids a smaller radius. "reach" means the length of the arm or the offset of the follower.
        "nothing" means that even 1e-5 of the size of lifts and follower is valid; the radius is then 0.
    cam_angle : float
        Cam angle, rad, at which a smaller radius would exceed the limit; nan if no single angle is responsible.

    Notes
    -----
    Derived here.
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
    """Find the least base circle within limits of pressure angle and curvature, without undercut.

    Parameters
    ----------
    follower : AbstractFollower
        The follower of the cam.
    program : Program
        The lift over one turn.
    direction : {"counterclockwise", "clockwise"}, optional
        Direction in which the cam turns.
    pressure_angle_deg : float, optional
        Largest pressure angle to either side, above 0 and at most 90 deg.
    least_radius : float, optional
        Least radius of curvature of the convex parts of the profile, mm, 0 or more.

    Returns
    -------
    BaseCircle
        If valid radii lie in several separate intervals, the result is the lower end of the uppermost one.

    Raises
    ------
    DesignError
        If no base circle keeps the limits.

    Notes
    -----
    The two limits that size a cam are those of Norton, Cam Design and Manufacturing Handbook; the search is derived
    here.

    Examples
    --------
    >>> program = gk.Program((gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360)))
    >>> gk.cam.least_base_circle(gk.TranslatingRoller(10), program).limit
    'pressure angle'
    """
    if not 0 < pressure_angle_deg <= 90:
        problem = f"found {pressure_angle_deg}"
        raise DesignError("pressure_angle_deg", problem, "give more than 0 and at most 90 deg", "out-of-range")
    if not 0 <= least_radius < np.inf:
        raise DesignError("least_radius", f"found {least_radius}", "give 0 mm or more", "out-of-range")
    check_lifts(follower, program)
    motion = program.motion(samples(program.breaks))
    low, high = follower.base_radius_range(float(motion.lift.max()))
    scale = max(float(np.abs(v).max()) for v in (motion.lift, motion.velocity, motion.acceleration))
    scale = max(scale, 1e-3, follower.size)
    sense = turning_sense(direction)
    follower.check(program, 0.5 * (low + high) if np.isfinite(high) else low + scale, sense)
    rules = _rules(follower, sense, np.radians(pressure_angle_deg), least_radius)

    def violations(radii: Real) -> Real:
        """Largest violation of each rule at the sampled cam angles, shape (rules, radii)."""
        return np.array([[rule(motion, radius).max() for radius in radii] for rule in rules.values()])

    trials = _trial_radii(low, high, scale, violations)
    trial_violations = violations(trials)
    good: Mask = np.asarray((trial_violations <= 0).all(axis=0))
    if not good.any():
        raise _no_base_circle(rules, trial_violations, pressure_angle_deg)
    first, last = _uppermost_run(good)
    # On a small cam a peak of the pressure angle is narrow and may lie between two samples.
    fits = _rule_test(program, rules)
    while first < last and not fits(float(trials[first])):
        first += 1
    while last > first and not fits(float(trials[last])):
        last -= 1
    upper = high if last == len(good) - 1 else _boundary(program, rules, *trials[[last, last + 1]].tolist())[0]
    if first:
        radius, limit, angle = _boundary(program, rules, *trials[[first, first - 1]].tolist())
        exact = follower.least_base_radius(program, least_radius)
        radius = exact if limit == "undercut" and exact is not None else radius
    else:
        radius, limit, angle = low, "reach" if low else "nothing", np.nan
    return _without_crossings(follower, program, direction, BaseCircle(radius, upper, limit, angle), scale)


# Violation of a rule at each cam angle of a motion, for a base radius in mm; above 0 if the rule is broken.
Rule = Callable[[FollowerMotion, float], Real]


def _rules(follower: AbstractFollower, sense: int, steepest: float, least_radius: float) -> dict[Limit, Rule]:
    def pressure(motion: FollowerMotion, radius: float) -> Real:
        return np.abs(follower.contact(motion, radius, sense).pressure_angle) - steepest * (1 + 1e-12)

    def curvature(motion: FollowerMotion, radius: float) -> Real:
        return follower.undercut_violation(motion, radius, sense, least_radius)

    return {"pressure angle": pressure, "undercut": curvature}


def _trial_radii(low: float, high: float, scale: float, violations: Callable[[Real], Real]) -> Real:
    """Rising base radii, mm, over the range that the follower allows."""
    if np.isfinite(high):
        return low + (high - low) * (np.arange(TRIALS) + 0.5) / TRIALS
    top = 8 * scale
    while (violations(np.array([low + top])) > 0).any() and top < 1e6 * scale:
        top *= 2
    return low + np.geomspace(SMALLEST * scale, 4 * top, TRIALS)


def _uppermost_run(good: Mask) -> tuple[int, int]:
    """First and last index of the last run of true values."""
    last = int(np.flatnonzero(good)[-1])
    invalid = np.flatnonzero(~good[:last])
    return (int(invalid[-1]) + 1 if len(invalid) else 0), last


def _boundary(program: Program, rules: dict[Limit, Rule], good: float, bad: float) -> tuple[float, Limit, float]:
    """The last valid base radius between a valid and an invalid one, the violated rule, and its cam angle."""
    fits = _rule_test(program, rules)
    for _ in range(HALVINGS):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if fits(middle) else (good, middle)
    _, angle, name = max((*_largest(program, rule, bad), name) for name, rule in rules.items())
    return good, name, angle


def _rule_test(program: Program, rules: dict[Limit, Rule]) -> Callable[[float], bool]:
    """A function that returns whether a base radius keeps all rules at every cam angle."""
    angles = samples(program.breaks)
    motion = program.motion(angles)

    def fits(radius: float) -> bool:
        sampled = [rule(motion, radius) for rule in rules.values()]
        # If a sample already breaks a rule, the peaks need not be refined.
        if not all(values.max() <= 0 for values in sampled):
            return False

        def is_broken(rule: Rule, values: Real) -> bool:
            return exceeds(angles, values, lambda t: rule(program.motion(t), radius), 0.0)

        return not any(is_broken(rule, values) for rule, values in zip(rules.values(), sampled))

    return fits


def _largest(program: Program, rule: Rule, radius: float) -> tuple[float, float]:
    return largest(program.breaks, lambda t: rule(program.motion(t), radius))


def _without_crossings(
    follower: AbstractFollower, program: Program, direction: Direction, circle: BaseCircle, scale: float
) -> BaseCircle:
    """The same base circle, or a larger one if flanks of the profile cross or its velocity jumps."""

    def crossed(radius: float) -> Undercut | None:
        cut = undercut(Cam(follower, program, radius, direction))
        return cut if cut.found else None

    # Slightly above the boundary, where rounding would decide.
    bad = max(circle.radius * (1 + 1e-9), SMALLEST * scale)
    last = crossed(bad) if bad < circle.largest else None
    if last is None:
        return circle
    good = min(FAR * max(bad, scale), circle.largest * (1 - 1e-6))
    if cut := crossed(good):
        problem = f"the velocity jumps at {np.degrees(cut.worst[1]):.4g} deg, which undercuts a cam of any size"
        raise DesignError("program", problem, "give a law of motion without a velocity jump there")
    while good - bad > 1e-9 * good:
        middle = 0.5 * (good + bad)
        if cut := crossed(middle):
            bad, last = middle, cut
        else:
            good = middle
    return replace(circle, radius=good, limit="undercut", cam_angle=last.worst[1])


def _no_base_circle(rules: dict[Limit, Rule], violations: Real, pressure_angle_deg: float) -> DesignError:
    always_broken = [name for name, least in zip(rules, violations.min(axis=1).tolist()) if least > 0]
    limit = " and ".join(always_broken) or "pressure angle or undercut"
    return DesignError(
        "base_radius",
        f"every base radius that the follower allows exceeds the limit of {limit} "
        f"(pressure angle {pressure_angle_deg:g} deg)",
        "give longer segments, another follower or a larger pressure angle",
    )
