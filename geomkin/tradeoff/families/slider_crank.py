"""Position of a slider-crank."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from math import cos, sin, sqrt

import numpy as np

from ...linkage.moving import move, placements_for
from ...linkage.named_linkages import SliderCrank
from ...linkage.solve.branch import as_branch_spec
from ...linkage.solve.input_dyads import CrankDriven
from ...linkage.solve.solution import LinkageSolution
from ...plane.vec import Array, Real
from ..exact import ENTRIES, FRAMES, DecimalVector, Track, circling, count, cubic, linear, misses, sliding
from ..family import Method, MethodFamily
from .four_bar_problem import LIBRARY, STEADY

CRANK, ROD, OFFSET = 30.0, 90.0, 10.0
LINKAGE = SliderCrank(CRANK, ROD, OFFSET)
Call = Callable[[], Array]


def _exact(angle: float) -> DecimalVector:
    """The slider's place along its line."""
    return DecimalVector(sliding(circling(CRANK, angle), ROD, OFFSET, 1).at.x, Decimal(0))


def _library(track: Track, _: float) -> Call:
    return lambda: move(track.linkage, track.drive).slider.origin.position.real


def _general_dyad(track: Track, _: float) -> Call:
    general = LINKAGE.linkage
    steps = tuple(one.dyad if isinstance(one, CrankDriven) else one for one in placements_for(general, 1))
    return lambda: (
        LinkageSolution(general, lambda: steps, track.drive, as_branch_spec(1), STEADY).origin("slider", 0).real
    )


def _factors(track: Track, _: float) -> Call:
    def call() -> Array:
        down = OFFSET - CRANK * np.sin(track.drive)
        return CRANK * np.cos(track.drive) + np.sqrt((ROD - down) * (ROD + down))

    return call


def _root(track: Track, _: float) -> Call:
    return lambda: _by_root(track.drive)


def _by_root(drive: Real) -> Real:
    x: Real = CRANK * np.cos(drive) + np.sqrt(ROD**2 - (OFFSET - CRANK * np.sin(drive)) ** 2)
    return x


def _angles(track: Track, _: float) -> Call:
    return lambda: CRANK * np.cos(track.drive) + ROD * np.cos(np.arcsin((OFFSET - CRANK * np.sin(track.drive)) / ROD))


def _single(track: Track, _: float) -> Call:
    drive, a, b, e = track.drive.astype(np.float32), *(np.float32(v) for v in (CRANK, ROD, OFFSET))

    def call() -> Array:
        down = e - a * np.sin(drive)
        return a * np.cos(drive) + np.sqrt((b - down) * (b + down))

    return call


def _series(track: Track, terms: float) -> Call:
    # Of sqrt(1 - y^2): 1 - y^2/2 - y^4/8 - ...
    powers = [1.0]
    for k in range(1, int(terms)):
        powers.append(powers[-1] * (k - 1.5) / k)

    def call() -> Array:
        lean = (OFFSET - CRANK * np.sin(track.drive)) / ROD
        square, found = lean * lean, np.full(FRAMES, powers[-1])
        for power in powers[-2::-1]:
            found = power + square * found
        return CRANK * np.cos(track.drive) + ROD * found

    return call


def _newton_cold(track: Track, steps: float) -> Call:
    def call() -> Array:
        # The rod's angle, from the rod lying level.
        height, angle = OFFSET - CRANK * np.sin(track.drive), np.zeros(FRAMES)
        for _ in range(int(steps)):
            angle = angle - (ROD * np.sin(angle) - height) / (ROD * np.cos(angle))
        return CRANK * np.cos(track.drive) + ROD * np.cos(angle)

    return call


def _by_frame(track: Track, _: float) -> Call:
    drive = track.drive.tolist()

    def call() -> Array:
        return np.array([CRANK * cos(t) + sqrt(ROD**2 - (OFFSET - CRANK * sin(t)) ** 2) for t in drive])

    return call


SLIDER_CRANK: MethodFamily[Track, Array] = MethodFamily(
    name="slider-crank-position",
    title="Position of a slider-crank",
    about=f"A slider-crank of {CRANK:g} and {ROD:g} mm whose line runs {OFFSET:g} mm beside the crank's pivot. "
    f"Found is the slider's place at {FRAMES} even steps of a whole turn of the crank.",
    per="pose",
    unit="mm",
    reference="a circle that meets a line, in decimal arithmetic of 110 digits",
    floor=5e-14,
    problem=lambda: Track.of(LINKAGE, _exact),
    count=count,
    error=misses,
    methods=(
        Method(
            "geomkin.move",
            "The library's call, for any linkage: the rod's direction by the product of factors, and from there the "
            "slider's place.",
            _library,
            rationale=LIBRARY.rationale,
            caveat=LIBRARY.caveat,
        ),
        Method(
            "general dyad solver", "The library's solver of a bar and a slide on any two moving bodies.", _general_dyad
        ),
        Method("product of factors", "The root of (l - n)(l + n), n the crank pin's height over the line.", _factors),
        Method("root of a difference of squares", "The textbooks' root of l^2 - n^2.", _root),
        Method("angle of the rod", "The rod's angle by its sine, the place by its cosine.", _angles),
        Method("single precision", "The product of factors in 32-bit numbers.", _single),
        Method(
            "series",
            "The root as a series in n/l, of so many terms; two are the books' approximation.",
            _series,
            "terms",
            (2.0, 3.0, 4.0, 6.0, 10.0),
        ),
        Method(
            "Newton, cold",
            "All frames at once from a level rod, by so many steps for the rod's angle.",
            _newton_cold,
            "steps",
            (1.0, 2.0, 3.0, 4.0),
        ),
        Method("frame by frame", "The textbooks' root in plain Python, without NumPy.", _by_frame),
        Method(
            "linear table",
            "Places at so many even steps, got ready beforehand, and straight lines between.",
            lambda track, entries: linear(track.drive, _by_root, entries),
            "entries",
            ENTRIES,
        ),
        Method(
            "cubic table",
            "The same table with a cubic through the four nearest entries.",
            lambda track, entries: cubic(track.drive, _by_root, entries),
            "entries",
            ENTRIES,
        ),
    ),
)
