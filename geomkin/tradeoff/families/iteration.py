"""A linkage that no dyads place, since its last link drives: iteration, and closed forms run backwards."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...linkage.moving import move
from ...plane.vec import Array, Complex, Real
from ..exact import ENTRIES, Track, count, many_digits, misses
from ..family import Method, MethodFamily
from .six_bar import by_circles, exact_output, first_angles, newton_all, newton_each, with_estimate

# Angles of the crank, rad, between which the output turns one way, and how many there are.
FIRST, LAST, FRAMES = 0.2, 1.2, 100
Call = Callable[[], Array]


def _problem() -> Track:
    """Angles of the output that belong to known ones of the crank."""
    crank = np.linspace(FIRST, LAST, FRAMES)
    with many_digits():
        found = [exact_output(angle) for angle in crank.tolist()]
    output = np.array([float(np.arctan2(float(z.y), float(z.x))) for z in found])
    return Track(with_estimate("output", crank), output, np.exp(1j * crank))


def _library(track: Track, _: float) -> Call:
    def call() -> Array:
        # Made anew each time: the path that was followed last is kept with the plan.
        fresh = with_estimate("output", np.array([FIRST]))
        return move(fresh, track.drive).crank.direction

    return call


def _newton_cold(track: Track, steps: float) -> Call:
    start = first_angles(np.array([FIRST]))
    return lambda: np.exp(1j * newton_all(start, track.drive, 4, int(steps))[:, 0])


def _newton_warm(track: Track, tolerance: float) -> Call:
    start = first_angles(np.array([FIRST]))
    return lambda: np.exp(1j * newton_each(start, track.drive, 4, tolerance)[:, 0])


def _halving(track: Track, steps: float) -> Call:
    wanted = np.exp(-1j * track.drive)

    def call() -> Array:
        low, high = np.full(FRAMES, FIRST - 0.05), np.full(FRAMES, LAST + 0.05)
        for _ in range(int(steps)):
            middle = 0.5 * (low + high)
            # The output turns ahead with the crank.
            beyond = (by_circles(middle) * wanted).imag > 0
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
        found: Array = np.exp(0.5j * (low + high))
        return found

    return call


def _secants(track: Track, steps: float) -> Call:
    wanted = np.exp(-1j * track.drive)

    def off(crank: Real) -> Real:
        way: Complex = by_circles(crank) * wanted
        return way.imag

    def call() -> Array:
        before, here = np.full(FRAMES, FIRST), np.full(FRAMES, LAST)
        off_before, off_here = off(before), off(here)
        for _ in range(int(steps)):
            with np.errstate(invalid="ignore", divide="ignore"):
                step = off_here * (here - before) / (off_here - off_before)
            # Where nothing is left to mend, both are alike.
            before, here, off_before = here, here - np.nan_to_num(step, posinf=0.0, neginf=0.0), off_here
            off_here = off(here)
        return np.exp(1j * here)

    return call


def _backwards(track: Track, entries: float) -> Call:
    crank = np.linspace(FIRST - 0.05, LAST + 0.05, int(entries))
    output = np.unwrap(np.angle(by_circles(crank)))
    order = np.argsort(output)
    output, crank = output[order], crank[order]
    return lambda: np.exp(1j * np.interp(track.drive, output, crank))


ITERATION: MethodFamily[Track, Array] = MethodFamily(
    name="iteration",
    title="A linkage that no closed form places",
    about="Stephenson's six-bar of the gallery, driven by its last link: no two of its members stand on known ones, "
    f"so that all loops are solved at once. Found is the direction of the crank at {FRAMES} places of the output.",
    per="pose",
    unit="rad",
    reference="the output's places, which were worked out from known ones of the crank in decimals of 110 digits",
    floor=1e-14,
    problem=_problem,
    count=count,
    error=misses,
    methods=(
        Method(
            "geomkin.move",
            "The path of poses is followed by its own length, and every frame is found on it by Newton's method.",
            _library,
            rationale="it needs one rough pose, finds the branch that the motion leads to from there, whatever the "
            "steps, and finds the limits of the motion.",
            caveat="It takes longer because of this safety: the others are given the range of the crank, and do not "
            "report a change of branch.",
        ),
        Method(
            "Newton, cold",
            "All frames at once from the pose of the first, by so many steps on four equations.",
            _newton_cold,
            "steps",
            (2.0, 4.0, 6.0, 8.0, 12.0),
        ),
        Method(
            "root finder per frame",
            "newton_raphson on the four equations, each frame from the one before.",
            _newton_warm,
            "tolerance",
            (1e-3, 1e-6, 1e-13),
        ),
        Method(
            "dyads backwards, by halving",
            "The closed form from the crank, in whose known range the crank is found by halving so many times.",
            _halving,
            "steps",
            (10.0, 20.0, 35.0, 50.0),
        ),
        Method(
            "dyads backwards, by secants",
            "The same by the secant method, from the ends of the crank's range.",
            _secants,
            "steps",
            (3.0, 5.0, 7.0, 10.0),
        ),
        Method(
            "table read backwards",
            "Outputs at so many even steps of the crank, got ready beforehand, and straight lines between.",
            _backwards,
            "entries",
            ENTRIES,
        ),
    ),
)
