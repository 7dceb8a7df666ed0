"""All four-bars through nine points: the share that is missed by continuation, and from random linkages."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...linkage.moving import move
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Mask, Real
from ...synthesis.path.homotopy import follow, refine
from ...synthesis.path.nine_point_equations import rotations_of
from ...synthesis.path.nine_points import REAL, starts_of, through_nine
from ...synthesis.path.path import path_generator
from ..family import Method, MethodFamily

# Wampler, Morgan and Sommese, Journal of Mechanical Design 114, 1992, problem 3, mm, and its number of real linkages.
POINTS = np.array([0.25, 0.52 + 0.1j, 0.8 + 0.7j, 1.2 + 1j, 1.4 + 1.3j, 1.1 + 1.48j, 0.7 + 1.4j, 0.2 + 1j, 0.02 + 0.4j])
KNOWN = 64
# Distance from the points, as a share of the linkage's size, and relative difference of pivots, that are rounding.
ROUNDING = 1e-6
# Seconds after which a search is cut short: none here takes so long.
PATIENCE = 600.0
# x, y of crank pin, crank pivot, rocker pin and rocker pivot at the first point (s, 8), mm.
Places = Real
Call = Callable[[], Places]


def missed_share(points: Complex, places: Places) -> Real:
    """Share (1,) of the known linkages that are not among those that are found."""
    pin, pivot, other, far = places.view(complex).T[..., None]
    # The crank's pin is where its circle meets that of the coupler point about the point; the rocker has to fit.
    apart = points - pivot
    unit = apart / np.abs(apart)
    along = (np.abs(apart) ** 2 + np.abs(pin - pivot) ** 2 - np.abs(points[0] - pin) ** 2) / (2 * np.abs(apart))
    across = np.sqrt(np.maximum(np.abs(pin - pivot) ** 2 - along**2, 0))
    pins = pivot + unit * (along + 1j * across * np.array([1, -1])[:, None, None])
    ends = pins + (other - pin) / (points[0] - pin) * (points - pins)
    misses = np.abs(np.abs(ends - far) - np.abs(other - far)).min(axis=0).max(axis=-1)
    exact = misses <= ROUNDING * (1 + np.abs(places).max(axis=-1))
    # Cognates have the same three pivots.
    third = pivot + (points[0] - pin) / (other - pin) * (far - pivot)
    pivots = np.stack([pivot + far + third, pivot * far + far * third + third * pivot, pivot * far * third])[
        :, exact, 0
    ]
    size = 1 + np.abs(pivots).max(axis=0)
    same: Mask = (np.abs(pivots[:, :, None] - pivots[:, None, :]) < ROUNDING * size).all(axis=0)
    distinct = ~np.tril(same, -1).any(axis=1)
    return np.array([1 - distinct.sum() / KNOWN])


def _continued(points: Complex, _: float) -> Call:
    return lambda: through_nine(points, lambda share: None)[0]


def _target(points: Complex) -> tuple[Complex, float]:
    """The parameters of the equations, and the size of the points, mm."""
    offsets: Complex = (points - points[0])[1:]
    size = float(np.sqrt(np.mean(np.abs(offsets) ** 2)))
    return np.concatenate([offsets, np.conj(offsets)]) / complex(size), size


def _real_places(points: Complex, x: Complex, size: float) -> Places:
    dyads, conjugates = x[:, 0:8:2], x[:, 1:8:2]
    with np.errstate(invalid="ignore"):
        real = np.all(np.abs(conjugates - np.conj(dyads)) < REAL * (1 + np.abs(dyads)), axis=1)
    places: Real = (size * dyads[real] + points[0]).copy().view(float)
    return places


def _some_paths(points: Complex, count: float) -> Call:
    starts, parameters = starts_of(1)
    chosen = starts[np.random.default_rng(0).permutation(len(starts))[: int(count)]]
    target, size = _target(points)

    def call() -> Places:
        ends = follow(chosen, parameters, target, lambda share: None)
        return _real_places(points, ends.x[ends.reached], size)

    return call


def _newton(points: Complex, count: float) -> Call:
    target, size = _target(points)

    def call() -> Places:
        x, y = np.random.default_rng(0).normal(size=(2, int(count), 4))
        places = np.stack([x + 1j * y, x - 1j * y], axis=2).reshape(-1, 8)
        rotations = rotations_of(places, np.broadcast_to(target, (len(places), 16)))
        ends = refine(np.concatenate([places, rotations], axis=1), target)
        return _real_places(points, ends.x[ends.reached], size)

    return call


def _searched(points: Complex, count: float) -> Call:
    def places_of(seed: int) -> list[Real]:
        # With a limit the search does not use the continuation.
        found = path_generator(points, least_transmission_angle_deg=0, seed=seed, time_limit=PATIENCE)
        places = []
        for one in found.ranked:
            bar = one.linkage
            assert isinstance(bar, FourBar)
            motion = move(bar, one.drive[:1], one.branch)
            far = bar.origin + bar.ground * np.exp(1j * np.radians(bar.ground_angle_deg))
            pins = [motion.point(pin).position[0] for pin in ("crank_pin", "rocker_pin")]
            places.append(np.array([pins[0], bar.origin, pins[1], far]).view(float))
        return places

    return lambda: np.array([row for seed in range(int(count)) for row in places_of(seed)])


NINE_POINTS: MethodFamily[Complex, Places] = MethodFamily(
    name="nine-points",
    title="Nine points of a path",
    about=f"The {KNOWN} four-bars, up to cognates, whose coupler points go through nine points (Wampler, Morgan and "
    "Sommese, 1992, problem 3); how large a share of them is missed.",
    per="search",
    unit="share",
    reference=f"the published number of {KNOWN} real linkages; each one that is found is closed at every point by the "
    "meeting of two circles, and counted once with its cognates",
    floor=0.01,
    problem=lambda: POINTS,
    count=lambda _, found: 1,
    error=missed_share,
    methods=(
        Method(
            "continuation (path_generator)",
            "All 1442 known solutions for nine complex points, followed to the wanted points; doubtful ends again in "
            "double-double.",
            _continued,
            rationale="It finds every linkage, and counts where all paths ended.",
            caveat="These points need no second pass over doubtful ends; others lose linkages without it.",
        ),
        Method(
            "some of the paths",
            "Some of the 1442 paths, chosen at random.",
            _some_paths,
            "paths",
            (50.0, 150.0, 500.0, 1442.0),
        ),
        Method(
            "Newton from random linkages",
            "Twelve Newton steps at most on the same equations from random linkages.",
            _newton,
            "linkages",
            (3e3, 1e4, 3e4),
            slow=True,
        ),
        Method(
            "path search",
            "80,000 random curves compared with the path, the best improved by least squares (`path_generator` with "
            "limits); linkages that leave their branch or pass the points in another order are not wanted.",
            _searched,
            "seeds",
            (1.0, 2.0),
            slow=True,
        ),
    ),
)
