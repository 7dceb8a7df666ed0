"""A curve as chords or arcs within a tolerance: equal errors, even parameters, halving, the fewest there can be."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.records import record
from ...plane.arcs import to_arcs
from ...plane.curve import AbstractCurve
from ...plane.flatten import flatten
from ...plane.joined import Path
from ...plane.primitives import Polyline
from ...plane.vec import Complex, Real, cross
from ..family import Method, MethodFamily, Tool
from . import cam_profile as cam_profile
from . import gear_root as gear_root

TOLERANCES = (0.1, 0.01, 1e-3, 1e-4)
# Where a chord is compared with its curve when steps or intervals are halved. Fewer let an S pass for straight.
SHARES = np.array([0.25, 0.5, 0.75])
# Where the greedy search looks along a chord, and its halvings.
LOOKS, HALVINGS = np.linspace(0, 1, 101), 30


@record(eq=False)
class ToolPath:
    """A curve, made anew for each call, and the tool that leaves it."""

    curve: Callable[[], AbstractCurve]
    tool: Tool


def at_even_parameters(curve: AbstractCurve, count: int) -> Complex:
    """Points of a closed curve at so many even steps of the parameter from each break to the next."""
    b = curve.breaks
    return curve.point((b[:-1, None] + np.diff(b)[:, None] * np.arange(count) / count).ravel())


def by_doubling(curve: AbstractCurve, tolerance: float) -> Complex:
    """The same, with twice as many steps until every chord is within the tolerance."""
    b, count = curve.breaks, 2
    while True:
        steps = np.diff(b)[:, None] * np.arange(count + 1) / count
        t = np.append((b[:-1, None] + steps[:, :-1]).ravel(), b[-1])
        z, inside = curve.point(t), curve.point(t[:-1, None] + np.diff(t)[:, None] * SHARES)
        if (_off(z[:-1], z[1:], inside) <= tolerance).all():
            return z[:-1] if curve.closed else z
        count *= 2


def by_halving(curve: AbstractCurve, tolerance: float) -> Complex:
    """Points at the breaks, and half way between two of them wherever their chord is farther off than the tolerance."""
    t = curve.breaks
    new = np.ones(len(t) - 1, dtype=bool)
    while new.any():
        low, step = t[:-1][new], np.diff(t)[new]
        a, b = curve.point(low), curve.point(low + step)
        far = np.zeros(len(new), dtype=bool)
        # What is within the tolerance rests; the others go on as two halves.
        far[new] = _off(a, b, curve.point(low[:, None] + step[:, None] * SHARES)) > tolerance
        t = np.sort(np.concatenate([t, 0.5 * (t[:-1][far] + t[1:][far])]))
        new = np.repeat(far, 1 + far)
    return curve.point(t[:-1] if curve.closed else t)


def _off(a: Complex, b: Complex, z: Complex) -> Real:
    """Farthest of points (n, places) from the lines between a and b, (n,)."""
    off: Real = np.abs(cross((b - a)[:, None], z - a[:, None])).max(axis=1) / np.abs(b - a)
    return off


def greedy(curve: AbstractCurve, tolerance: float) -> Complex:
    """Points from break to break, each chord as long as the tolerance lets it be: the fewest there can be."""
    found: list[float] = []
    for start, last in zip(curve.breaks[:-1].tolist(), curve.breaks[1:].tolist()):
        t = start
        while t < last:
            found.append(t)
            t = _farthest(curve, t, last, tolerance)
    return curve.point(np.array(found if curve.closed else [*found, last]))


def _farthest(curve: AbstractCurve, t: float, last: float, tolerance: float) -> float:
    """The end of the longest chord from t that keeps the tolerance."""

    def off(end: float) -> float:
        z = curve.point(t + (end - t) * LOOKS)
        return float(np.abs(cross(z[-1] - z[0], z - z[0])).max() / np.abs(z[-1] - z[0]))

    if off(last) <= tolerance:
        return last
    near, far = t, last
    for _ in range(HALVINGS):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if off(middle) <= tolerance else (near, middle)
    return near


def _chords(points: Callable[[AbstractCurve, float], Complex]) -> Callable[[ToolPath, float], Callable[[], Polyline]]:
    def make(path: ToolPath, setting: float) -> Callable[[], Polyline]:
        def line() -> Polyline:
            curve = path.curve()
            return Polyline(points(curve, setting), is_closed=curve.closed)

        return line

    return make


def _arcs(path: ToolPath, tolerance: float) -> Callable[[], Polyline]:
    return lambda: to_arcs(path.curve(), tolerance)


METHODS = (
    Method(
        "equal errors",
        "Chords that all have the same error, found by spreading points anew until they do (`flatten`).",
        _chords(flatten),
        "tolerance, mm",
        TOLERANCES,
        rationale="It keeps the tolerance with at most 3 % more chords than the least possible number.",
        caveat="Even steps are as fast, but take two to four times as many vertices, each of which slows down "
        "reading, cutting and meshing; arcs take fewer still, but solids and many programs need chords.",
    ),
    Method(
        "even parameters",
        "Even steps of the parameter on each smooth piece, twice as many until three places of each chord are within "
        "the tolerance.",
        _chords(by_doubling),
        "tolerance, mm",
        TOLERANCES,
    ),
    Method(
        "halving",
        "Pieces halved until three places of each are within the tolerance of its chord.",
        _chords(by_halving),
        "tolerance, mm",
        TOLERANCES,
    ),
    Method(
        "greedy",
        "From one end to the other, each chord as long as a search by halves finds it may be: the fewest there can be.",
        _chords(greedy),
        "tolerance, mm",
        TOLERANCES[:3],
        slow=True,
    ),
    Method(
        "arcs",
        "Tangent arcs that all have the same error (`to_arcs`).",
        _arcs,
        "tolerance, mm",
        TOLERANCES,
    ),
)


def _cam() -> ToolPath:
    roller_cam = cam_profile.problem()
    return ToolPath(lambda: roller_cam.cam().profile, roller_cam.tool)


def _tooth() -> ToolPath:
    cut = gear_root.problem()

    def side() -> Path:
        tooth = cut.gear().tooth
        return Path((tooth.root_curve, tooth.flank))

    return ToolPath(side, cut.tool)


def _family(name: str, title: str, about: str, problem: Callable[[], ToolPath]) -> MethodFamily[ToolPath, Polyline]:
    return MethodFamily(
        name=name,
        title=title,
        about=about,
        per="curve",
        unit="mm",
        reference="brute force: the distance of three places along every chord or arc from the tool that leaves the "
        "curve, the least over all its positions",
        floor=1e-12,
        problem=problem,
        count=lambda _, found: 1,
        error=lambda path, found: path.tool.edge_error(found),
        methods=METHODS,
        weighed="vertices",
        weigh=lambda _, found: len(found.vertices),
    )


CAM_FLATTENING = _family(
    "cam-flattening",
    "Flattening of a cam",
    "The profile of a roller cam, 60 mm across its rise, as chords or arcs.",
    _cam,
)
GEAR_FLATTENING = _family(
    "gear-flattening",
    "Flattening of a tooth",
    "Root and flank of one side of a tooth of a gear of 12 teeth, module 2, as chords or arcs.",
    _tooth,
)
