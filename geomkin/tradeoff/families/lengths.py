"""Four-bars of other lengths: new ones at each call, derivatives by the lengths, and the deviation of tolerances."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from decimal import Decimal
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from ...linkage.moving import move
from ...linkage.named_linkages import FourBar
from ...linkage.tolerance_analysis import DEVIATIONS, tolerances
from ...plane.vec import Array, Complex, Real
from ..family import FRAMES, STEP, Method, MethodFamily, Track, coupler_point, exact, method, turn

COUPLER_POINT = 40 + 25j
# Lengths of ground, crank, coupler and rocker, mm, and the number of linkages of other lengths.
SIZES = {"ground": 100.0, "crank": 30.0, "coupler": 90.0, "rocker": 70.0}
LENGTHS, LINKAGES = np.array(list(SIZES.values())), 10
# Frames from one with a reference to the next; one takes a millisecond for each linkage.
REFERENCE_STEP = 6


def four_bar(lengths: Any) -> FourBar:
    """The four-bar of ground, crank, coupler and rocker, mm."""
    ground, crank, coupler, rocker = lengths
    return FourBar(ground, crank, coupler, rocker, COUPLER_POINT)


# New lengths


def _new_lengths() -> Track:
    """Lengths (linkages, 4) in place of a linkage; exact position, first and second derivative of the coupler point."""
    lengths = LENGTHS + 10 * np.random.default_rng(1).random((LINKAGES, 4))
    places = [partial(coupler_point, sizes, COUPLER_POINT) for sizes in lengths.tolist()]
    return Track(lengths, turn(), np.array([exact(place, turn()[::REFERENCE_STEP]) for place in places]))


@method(
    "geomkin.move",
    rationale="one call serves any linkage, checks its sizes, and keeps all digits near toggles.",
    caveat="The rest is the overhead of a call, which matters less with more poses per call; arrays of lengths avoid "
    "it.",
)
def _library(track: Track) -> Array:
    """A FourBar is made and moved for each set of lengths; its formulas are recorded once for all."""
    points = [move(four_bar(sizes), track.drive).point("coupler_point") for sizes in track.linkage.tolist()]
    return np.array([(point.position, point.first, point.second) for point in points])


@method("geomkin.move, arrays of lengths")
def _library_at_once(track: Track) -> Array:
    """One FourBar whose lengths are arrays, moved once."""
    point = move(four_bar(track.linkage.T), track.drive).point("coupler_point")
    return np.array([point.position, point.first, point.second]).transpose(2, 0, 1)


@method("plain NumPy")
def _textbook(track: Track) -> Array:
    """The textbooks' formulas for this one linkage, without checks: two circles intersect in the rocker pin, and the
    loop equation is differentiated once and twice.
    """
    return np.array([intersected_circles(sizes, track.drive) for sizes in track.linkage.tolist()])


@method("plain NumPy, arrays of lengths")
def _textbook_at_once(track: Track) -> Array:
    """The same formulas once for all lengths."""
    return np.array(intersected_circles(track.linkage.T[:, :, None], track.drive)).transpose(1, 0, 2)


@method("single precision", prepared=True)
def _single(track: Track) -> Callable[[], Array]:
    """The same formulas for one linkage after the other in 32-bit numbers."""
    lengths, drive = track.linkage.astype(np.float32), track.drive.astype(np.float32)
    return lambda: np.array([intersected_circles(sizes, drive) for sizes in lengths])


@method("frame by frame", prepared=True, slow=True)
def _frame_by_frame(track: Track) -> Callable[[], Array]:
    """The same formulas with Python's own complex numbers, one pose after the other."""
    point = partial(intersected_circles, exp=cmath.exp, sqrt=math.sqrt)
    lengths, drive = track.linkage.tolist(), track.drive.tolist()
    return lambda: np.array([[point(sizes, angle) for angle in drive] for sizes in lengths]).transpose(0, 2, 1)


def intersected_circles(lengths: Any, drive: Any, exp: Any = np.exp, sqrt: Any = np.sqrt) -> tuple[Any, Any, Any]:
    """Position of the coupler point and its first and second derivative by the crank angle, as in textbooks.

    Two circles intersect in the rocker pin; the loop equation is differentiated once and twice.
    """
    ground, crank, coupler, rocker = lengths
    crank_pin = crank * exp(1j * drive)
    diagonal = ground - crank_pin
    square = diagonal.real * diagonal.real + diagonal.imag * diagonal.imag
    along = 0.5 + 0.5 * (coupler * coupler - rocker * rocker) / square
    bar = diagonal * (along + 1j * sqrt(coupler * coupler / square - along * along))
    arm = bar - diagonal
    bar_conjugate, arm_conjugate = bar.conjugate(), arm.conjugate()
    determinant = (bar_conjugate * arm).imag
    h3, h4 = (arm_conjugate * crank_pin).imag / determinant, (bar_conjugate * crank_pin).imag / determinant
    h3_prime = (arm_conjugate * (crank_pin + h3 * h3 * bar - h4 * h4 * arm)).real / determinant
    local = COUPLER_POINT / coupler * bar
    return crank_pin + local, 1j * (crank_pin + h3 * local), (1j * h3_prime - h3 * h3) * local - crank_pin


def _new_error(track: Track, found: Array) -> Real:
    scale = np.abs(track.right).max(axis=(0, 2))[:, None]
    return np.asarray((np.abs(found[:, :, ::REFERENCE_STEP] - track.right) / scale).max(axis=1).ravel())


NEW_LENGTHS = MethodFamily(
    name="new-lengths", title="Four-bars of new lengths", per="pose", unit="share of the largest", floor=1e-15,
    problem=_new_lengths, error=_new_error, count=lambda _, found: found.shape[0] * found.shape[2],
    about=f"{LINKAGES} crank-rockers of random lengths, about 105, 35, 95 and 75 mm, made and moved one after the "
    f"other. Computed are position, velocity and acceleration of a coupler point at {FRAMES} even steps of a whole "
    "turn at a speed of 1 rad/s. The error is the largest one of the three, as a share of its largest value.",
    reference="intersecting circles, and differences of these, in decimal arithmetic of 110 digits, at every "
    f"{REFERENCE_STEP}th pose",
    methods=(_library, _library_at_once, _textbook, _textbook_at_once, _single, _frame_by_frame),
)  # fmt: skip


# Derivatives by the lengths

# Imaginary step, mm: it takes no difference and so may be as small as numbers are.
COMPLEX_STEP = 1e-30
# Weights of central differences, by the number of steps.
WEIGHTS = {2: {1: 1 / 2}, 4: {1: 2 / 3, 2: -1 / 12}}
STEPS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)


def _derivatives() -> Track:
    """Exact derivatives by each length, (sizes, frames), by central differences in decimals."""

    def rate(j: int, angle: Decimal) -> Any:
        above, below = (
            [Decimal(v) + sign * STEP * (k == j) for k, v in enumerate(LENGTHS.tolist())] for sign in (1, -1)
        )
        return (coupler_point(above, COUPLER_POINT, angle) - coupler_point(below, COUPLER_POINT, angle)) * (
            1 / (2 * STEP)
        )

    return Track(None, turn(), np.array([exact(partial(rate, j), turn()[::REFERENCE_STEP])[0] for j in range(4)]))


@method(
    "motion.sensitivity",
    rationale="it is exact for any quantity, size and linkage, and chooses no step.",
    caveat="A formula derived by hand for this one linkage takes less time.",
)
def _sensitivity(track: Track) -> Complex:
    """The conditions of all joints, differentiated: a linear system at each pose (implicit function theorem)."""
    motion = move(four_bar(LENGTHS.tolist()), track.drive)
    return np.array([motion.sensitivity("coupler_point", by=size) for size in SIZES])


@method("loop equation by hand, plain NumPy")
def _loop_equation(track: Track) -> Complex:
    """The loop equation of this one linkage, differentiated by each length on paper, without checks."""
    ground, crank, coupler, rocker = LENGTHS.tolist()
    direction = np.exp(1j * track.drive)
    diagonal = ground - crank * direction
    square = diagonal.real**2 + diagonal.imag**2
    along = 0.5 + 0.5 * (coupler**2 - rocker**2) / square
    bar = diagonal * (along + 1j * np.sqrt(coupler**2 / square - along**2))
    arm = bar - diagonal
    coupler_direction = bar / coupler
    # crank + coupler - rocker - ground = 0, differentiated by each length.
    right = np.array([np.ones(FRAMES), -direction, -coupler_direction, arm / rocker])
    rotation = (np.conj(arm) * right).real / (np.conj(bar) * arm).imag
    rates: Complex = 1j * COUPLER_POINT * coupler_direction * rotation
    rates[1] += direction
    return rates


def real_coordinates(lengths: Array, drive: Real) -> tuple[Array, Array]:
    """Coordinates of the coupler point, mm, for lengths (4, ...): the intersection of two circles, in real arithmetic.

    Every operation is analytic, so that lengths may be complex numbers.
    """
    ground, crank, coupler, rocker = lengths
    pin_x, pin_y = crank * np.cos(drive), crank * np.sin(drive)
    x, y = ground - pin_x, -pin_y
    square = x * x + y * y
    along = 0.5 + 0.5 * (coupler * coupler - rocker * rocker) / square
    across = np.sqrt(coupler * coupler / square - along * along)
    bar_x, bar_y = (along * x - across * y) / coupler, (along * y + across * x) / coupler
    local_x, local_y = COUPLER_POINT.real, COUPLER_POINT.imag
    return pin_x + local_x * bar_x - local_y * bar_y, pin_y + local_x * bar_y + local_y * bar_x


@method("complex step", prepared=True)
def _complex_step(track: Track) -> Callable[[], Complex]:
    """A formula in real coordinates, with an imaginary step of 1e-30 mm in each length. The formula may have no
    absolute values and no complex numbers of its own.
    """
    # Lengths by the size that has the step: (4, sizes, 1).
    lengths = (LENGTHS[:, None] + COMPLEX_STEP * 1j * np.eye(4))[:, :, None]

    def call() -> Complex:
        x, y = real_coordinates(lengths, track.drive)
        return np.asarray((x.imag + 1j * y.imag) / COMPLEX_STEP)

    return call


def _by_formula(lengths: Real, drive: Real) -> Complex:
    x, y = real_coordinates(lengths[..., None], drive)
    return np.asarray(x + 1j * y)


def _by_move(lengths: Real, drive: Real) -> Complex:
    position = move(four_bar(lengths.reshape(4, -1)), drive).point("coupler_point").position
    return position.T.reshape(*lengths.shape[1:], -1)


def _central(name: str, order: int, point: Callable[[Real, Real], Complex], about: str) -> Method:
    def differences(track: Track, share: float) -> Callable[[], Complex]:
        steps, weights = share * LENGTHS, WEIGHTS[order]
        # (4, offsets, sizes)
        lengths = np.stack([LENGTHS[:, None] + k * np.diag(steps) for j in weights for k in (j, -j)], axis=1)

        def call() -> Complex:
            z = point(lengths, track.drive)
            off: Any = sum(weight * (z[2 * k] - z[2 * k + 1]) for k, weight in enumerate(weights.values()))
            return np.asarray(off / steps[:, None])

        return call

    differences.__doc__ = about
    return method(name, "step, share of the length", STEPS, prepared=True)(differences)


def _derivative_error(track: Track, found: Complex) -> Real:
    off = np.abs(found[:, ::REFERENCE_STEP] - track.right) / np.abs(track.right).max(axis=1)[:, None]
    return np.asarray(off.ravel())


DERIVATIVES = MethodFamily(
    name="derivatives", title="Derivatives of a coupler point by the lengths", per="derivative",
    unit="share of the largest", floor=1e-15, problem=_derivatives, error=_derivative_error,
    count=lambda _, found: found.size,
    about="A crank-rocker of 30, 90, 70 and 100 mm, made and moved at each call. Computed are the derivatives of the "
    f"position of a coupler point by each of the four lengths, at {FRAMES} even steps of a whole turn, as a search by "
    "gradients needs them. Small steps do not help differences: below some step the rounding of the positions grows "
    "faster than the rest falls.",
    reference="central differences in decimal arithmetic of 110 digits, with a step of 1e-25 mm",
    methods=(
        _sensitivity,
        _loop_equation,
        _complex_step,
        *(
            _central(f"central differences, order {order}", order, _by_formula,
                     f"{order} evaluations of the same formula in real coordinates for each length.")
            for order in WEIGHTS
        ),
        _central("central differences of geomkin.move", 2, _by_move,
                 "One motion of eight four-bars, whose lengths are arrays: each length a step longer and shorter."),
    ),
)  # fmt: skip


# Tolerances

# Tolerance of each length, mm, and positions of the crank.
TOLERANCE, POSITIONS = 0.1, 36
SIGMA = TOLERANCE / DEVIATIONS
# Share of all linkages that deviate by more.
BEYOND = math.erfc(DEVIATIONS / np.sqrt(2))
# Nodes of the quadrature over each of three lengths, and steps of the secant; with more, less than 1e-9 rad changes.
NODES, SECANT_STEPS = 12, 8


def _tolerance_problem() -> Track:
    """A motion in place of a linkage, and the deviation that a share BEYOND of linkages exceeds, rad, (positions,)."""
    motion = move(FourBar(*LENGTHS.tolist()), np.arange(POSITIONS) * (2 * np.pi / POSITIONS))
    return Track(motion, motion.drive, exact_deviation(motion.drive, np.angle(motion.rocker.direction)))


def exact_deviation(drive: Real, angle: Real) -> Real:
    """The deviation that a share `BEYOND` of the linkages exceeds, rad, for angles of crank and rocker (frames,).

    With ground, crank and rocker given, the rocker's angle is a monotonic function of the coupler's length, which is
    the distance between the two pins. The share of the couplers beyond it is an error function; its mean over the other
    three lengths follows from Gauss-Hermite quadrature.
    """
    node, weight = np.polynomial.hermite_e.hermegauss(NODES)
    steps, weights = np.array(list(product(node, repeat=3))).T, np.prod(list(product(weight, repeat=3)), axis=1)
    ground, crank, rocker = (SIZES[name] + SIGMA * step for name, step in zip(("ground", "crank", "rocker"), steps))
    crank_pin = crank * np.exp(1j * drive[:, None])
    share_beyond = np.vectorize(math.erfc)

    def excess(deviation: Real) -> Real:
        """Logarithm of the share of the linkages that deviate by more, over that of `BEYOND`."""
        share = np.zeros(len(deviation))
        for sign in (1, -1):
            pin = ground + rocker * np.exp(1j * (angle + sign * deviation)[:, None])
            apart = sign * (np.abs(pin - crank_pin) - SIZES["coupler"]) / (np.sqrt(2) * SIGMA)
            # A longer coupler moves the rocker forwards or backwards.
            share += 0.5 * share_beyond(apart * np.sign(apart.mean(axis=1, keepdims=True))) @ weights / weights.sum()
        return np.asarray(np.log(share / BEYOND))

    before, now = np.full(len(drive), 1.5e-3), np.full(len(drive), 2.5e-3)
    excess_before, excess_now = excess(before), excess(now)
    for _ in range(SECANT_STEPS):
        change = excess_now - excess_before
        step = excess_now * (now - before) / np.where(change == 0, np.inf, change)
        before, excess_before, now = now, excess_now, now - step
        excess_now = excess(now)
    return now


@method(
    "linearised (geomkin.tolerances)",
    rationale="A thousandth of the error of 100,000 random linkages, in a hundredth of their time.",
    caveat="For a four-bar differences are faster and as exact, but their step has to suit the linkage.",
)
def _linearised(track: Track) -> Real:
    """Root sum square of the exact derivatives by all lengths."""
    # A motion keeps its derivatives: each call solves it anew.
    return tolerances(move(track.linkage.given, track.drive), "rocker_angle", TOLERANCE).root_sum_square


@method("differences", "step, mm", (10.0, 1.0, 0.1, 1e-6, 1e-10))
def _by_differences(track: Track, step: float) -> Real:
    """The same with central differences of eight linkages moved at once."""
    lengths = LENGTHS[:, None] + 0.5 * step * np.concatenate([np.eye(4), -np.eye(4)]).T
    direction = move(FourBar(*lengths), track.drive).rocker.direction
    slopes = np.angle(direction[:, :4] * np.conj(direction[:, 4:])) / step
    return np.asarray(TOLERANCE * np.sqrt(np.sum(slopes**2, axis=1)))


@method("Monte Carlo", "linkages", (100.0, 1e3, 1e4, 1e5), prepared=True)
def _monte_carlo(track: Track, linkages: float) -> Callable[[], Real]:
    """Random linkages, each solved exactly, and the deviation that 99.73 % of them keep
    (`ToleranceAnalysis.monte_carlo`).
    """
    analysis = tolerances(track.linkage, "rocker_angle", TOLERANCE)
    return lambda: analysis.monte_carlo(int(linkages)).largest(1 - BEYOND)


TOLERANCE_BAND = MethodFamily(
    name="tolerance", title="Tolerance band", per="position", unit="rad", floor=1e-12, problem=_tolerance_problem,
    error=lambda track, found: np.abs(found - track.right),
    about="The deviation of the rocker of a crank-rocker of 30, 90, 70 and 100 mm that 99.73 % of all linkages keep, "
    f"each length being {TOLERANCE:g} mm off at three standard deviations; at {POSITIONS} positions of the crank.",
    reference="the share of the couplers within the deviation in closed form, its mean over ground, crank and rocker "
    f"by quadrature of {NODES} nodes each",
    methods=(_linearised, _by_differences, _monte_carlo),
)  # fmt: skip
