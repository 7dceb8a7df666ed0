"""Basic shapes: segment, arc, circle, polyline with bulges, slot, rounded hull."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import ComplexRow, FloatRow, PositiveFloat, checked
from ..core.errors import DesignError
from ..core.records import record
from .curve import AbstractCurve, Mirrored, Moved
from .joined import Path
from .vec import Complex, Pose, Real, Whole, cross


@record(checked=True, eq=False)
class Segment(AbstractCurve):
    """Straight line; 0 <= t <= 1.

    Parameters
    ----------
    start, end : complex
        mm.
    """

    start: complex
    end: complex

    def point(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        return self.start * (1 - t) + self.end * t

    def velocity(self, t: ArrayLike) -> Complex:
        return np.full(np.shape(t), self.end - self.start, dtype=complex)

    def curvature(self, t: ArrayLike) -> Real:
        return np.zeros(np.shape(t))

    @property
    def breaks(self) -> Real:
        return np.array([0.0, 1.0])

    closed = False


@record(checked=True, eq=False)
class Arc(AbstractCurve):
    """Circular arc; 0 <= t <= 1.

    Parameters
    ----------
    centre, start : complex
        Centre and first point, mm.
    sweep : float
        rad, positive counterclockwise.
    """

    centre: complex
    start: complex
    sweep: float

    def point(self, t: ArrayLike) -> Complex:
        return self.centre + (self.start - self.centre) * np.exp(1j * self.sweep * np.asarray(t))

    def velocity(self, t: ArrayLike) -> Complex:
        return 1j * self.sweep * (self.point(t) - self.centre)

    def curvature(self, t: ArrayLike) -> Real:
        with np.errstate(divide="ignore"):
            return np.full(np.shape(t), np.sign(self.sweep) / np.abs(self.start - self.centre))

    @property
    def breaks(self) -> Real:
        return np.array([0.0, 1.0])

    closed = False


@record(checked=True, eq=False)
class Circle(AbstractCurve):
    """Whole circle, counterclockwise from its rightmost point; t is the angle in rad.

    Parameters
    ----------
    centre : complex
        mm.
    radius : float
        mm; above 0.

    Raises
    ------
    DesignError
        If the radius is not above 0.
    """

    centre: complex
    radius: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.centre) and 0 < self.radius < np.inf):
            raise DesignError(
                "radius", f"found {self.radius} about {self.centre}", "give a radius above 0", "out-of-range"
            )

    def point(self, t: ArrayLike) -> Complex:
        return self.centre + self.radius * np.exp(1j * np.asarray(t))

    def velocity(self, t: ArrayLike) -> Complex:
        return 1j * self.radius * np.exp(1j * np.asarray(t))

    def curvature(self, t: ArrayLike) -> Real:
        return np.full(np.shape(t), 1 / self.radius)

    @property
    def breaks(self) -> Real:
        return np.array([0.0, 2 * np.pi])

    closed = True


# Sweep, rad, below which the area under an arc is computed by a series, since the closed form loses digits. The first
# omitted term is at most 2e-15 of the area.
FLAT = 0.02


@record(checked=True, eq=False)
class Polyline(AbstractCurve):
    """Straight edges and arcs through given vertices; edge k runs over k <= t <= k + 1.

    Parameters
    ----------
    vertices : array of complex, shape (n,)
        mm; a closed polyline does not repeat its start.
    bulges : array, shape (n,) if closed, (n - 1,) if open; optional
        tan(sweep / 4) of the arc of each edge, 0 for a straight edge, positive if it turns left, as in an LWPOLYLINE of
        DXF.
    is_closed : bool
        Whether the last vertex is joined to the first.

    Raises
    ------
    DesignError
        If there are fewer than two vertices, or the number of bulges is not that of the edges.
    """

    vertices: ComplexRow
    bulges: FloatRow | None = None
    is_closed: bool = True

    def __post_init__(self) -> None:
        if len(self.vertices) < 2:
            raise DesignError("vertices", "found fewer than two points", "give at least two", "out-of-range")
        edges = len(self.vertices) - (not self.is_closed)
        if self.bulges is not None and np.shape(self.bulges) != (edges,):
            raise DesignError(
                "bulges", f"found shape {np.shape(self.bulges)}", f"give ({edges},), one for each edge", "conflict"
            )

    @cached_property
    def _edges(self) -> tuple[Complex, Real]:
        z = np.asarray(self.vertices, dtype=complex)
        chords = np.roll(z, -1) - z if self.is_closed else np.diff(z)
        sweeps = np.zeros(len(chords)) if self.bulges is None else 4 * np.arctan(self.bulges)
        return chords, sweeps

    @property
    def swept(self) -> float:
        """Area between the edges and the first vertex, mm2, positive where they turn left about it.

        For a closed polyline it is the enclosed area: triangles to the chords, and under each arc of sweep s over a
        chord c a segment of c^2 (s - sin s) / (8 sin^2 (s / 2)).
        """
        chords, s = self._edges
        start = np.asarray(self.vertices)[: len(chords)] - self.vertices[0]
        # For flat arcs the difference loses its digits, so a series is used.
        flat = np.abs(s) < FLAT
        steep = np.where(flat, 1.0, s)
        share = (steep - np.sin(steep)) / (8 * np.sin(steep / 2) ** 2)
        share = np.where(flat, s / 12 * (1 + s**2 / 30 + s**4 / 840), share)
        return float(np.sum(0.5 * cross(start, chords) + np.abs(chords) ** 2 * share))

    def _local(self, t: ArrayLike) -> tuple[Whole, Real, Complex, Real]:
        t = np.asarray(t, dtype=float)
        chords, sweeps = self._edges
        k = np.clip(np.floor(t), 0, len(chords) - 1).astype(int)
        return k, t - k, chords[k], sweeps[k]

    def point(self, t: ArrayLike) -> Complex:
        k, s, chord, sweep = self._local(t)
        # np.sinc keeps a straight edge (sweep 0) an ordinary case: s sinc(s phi) / sinc(phi) -> s.
        along = s * np.sinc(s * sweep / (2 * np.pi)) / np.sinc(sweep / (2 * np.pi))
        point: Complex = np.asarray(self.vertices)[k] + chord * along * np.exp(0.5j * sweep * (s - 1))
        return point

    def velocity(self, t: ArrayLike) -> Complex:
        _, s, chord, sweep = self._local(t)
        velocity: Complex = chord / np.sinc(sweep / (2 * np.pi)) * np.exp(0.5j * sweep * (2 * s - 1))
        return velocity

    def curvature(self, t: ArrayLike) -> Real:
        _, _, chord, sweep = self._local(t)
        return 2 * np.sin(sweep / 2) / np.abs(chord)

    @cached_property
    def pieces(self) -> tuple[Arc | Segment, ...]:
        """The edges as arcs and segments."""
        starts, (chords, sweeps) = np.asarray(self.vertices, dtype=complex), self._edges
        pieces: list[Arc | Segment] = []
        for start, chord, sweep in zip(starts.tolist(), chords.tolist(), sweeps.tolist()):
            # The centre is to the left of the middle of the chord, for a left turn of less than half a circle.
            centre = start + 0.5 * chord * (1 + 1j / np.tan(sweep / 2)) if sweep else 0j
            pieces.append(Arc(centre, start, sweep) if sweep else Segment(start, start + chord))
        return tuple(pieces)

    @property
    def breaks(self) -> Real:
        return np.arange(len(self._edges[0]) + 1.0)

    @property
    def closed(self) -> bool:
        return self.is_closed


def moved(curve: AbstractCurve, pose: Pose) -> AbstractCurve:
    """A curve placed by a pose; a circle remains a Circle, so that it can be written as one."""
    if isinstance(curve, Circle):
        return Circle(complex(pose.place(curve.centre)), curve.radius)
    return Moved(curve, pose)


def mirrored(curve: AbstractCurve) -> AbstractCurve:
    """The mirror image of a curve in the y axis; a circle remains a Circle."""
    if isinstance(curve, Circle):
        return Circle(complex(-np.conj(curve.centre)), curve.radius)
    return Mirrored(curve)


@checked
def rounded_hull(centres: complex | ArrayLike, radius: PositiveFloat) -> AbstractCurve:
    """The outline of a plate with a round boss at each of some points: the convex hull of equal discs.

    Parameters
    ----------
    centres : array_like of complex, shape (n,)
        mm, in any order; points inside the hull have no effect.
    radius : float
        Of the discs, mm; above 0.

    Returns
    -------
    AbstractCurve
        Closed, counterclockwise. One centre gives a circle, two give a slot.

    Raises
    ------
    DesignError
        If there is no centre, or an argument is out of range.
    """
    z = np.atleast_1d(np.asarray(centres, dtype=complex))
    if z.ndim > 1 or not z.size:
        raise DesignError("centres", f"found shape {z.shape}", "give a 1-D array of at least one point", "wrong-type")
    corners = convex_hull(z)
    if len(corners) == 1:
        return Circle(corners[0], radius)
    pieces: list[AbstractCurve] = []
    for before, corner, after in zip(np.roll(corners, 1), corners, np.roll(corners, -1)):
        incoming, outgoing = corner - before, after - corner
        incoming, outgoing = incoming / abs(incoming), outgoing / abs(outgoing)
        # The end of a slot turns by exactly half a turn, the sign of which would depend on rounding.
        sweep = np.pi if len(corners) == 2 else float(np.angle(outgoing * incoming.conjugate()))
        pieces.append(Arc(corner, corner - 1j * radius * incoming, sweep))
        pieces.append(Segment(corner - 1j * radius * outgoing, after - 1j * radius * outgoing))
    return Path(tuple(pieces))


@checked
def slot(start: complex, end: complex, radius: PositiveFloat) -> AbstractCurve:
    """The outline swept by a disc along a line.

    Parameters
    ----------
    start, end : complex
        Centres of the end arcs, mm.
    radius : float
        mm; above 0.

    Returns
    -------
    AbstractCurve
        Closed, counterclockwise.

    Raises
    ------
    DesignError
        If an argument is out of range.
    """
    return rounded_hull([start, end], radius)


def convex_hull(z: Complex) -> list[complex]:
    """Corners of the convex hull, counterclockwise, no three in line, by the monotone chain.

    Andrew, Information Processing Letters 9, 1979, 216-219.
    """
    size = float(np.abs(z - z[0]).max())
    rounding = 1e-12 * (size + float(np.abs(z).max()))
    points: list[complex] = []
    for p in sorted(z.tolist(), key=lambda p: (p.real, p.imag)):
        # Centres that differ by rounding would give edges too short for any file.
        if all(abs(p - q) > rounding for q in points):
            points.append(p)
    if len(points) < 3:
        return points

    def chain(run: list[complex]) -> list[complex]:
        corners: list[complex] = []
        for p in run:
            # A corner that turns by less than 1e-12 of the size would give an arc lost in rounding.
            while len(corners) > 1 and cross(corners[-1] - corners[-2], p - corners[-1]) <= 1e-12 * size**2:
                corners.pop()
            corners.append(p)
        return corners[:-1]

    return chain(points) + chain(points[::-1])
