"""The plain shapes: segment, arc, circle, polyline with bulges, slot, rounded hull."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import Points, Positive, RealRow, Row, checked
from ..core.errors import DesignError
from ..core.records import record
from .curve import AbstractCurve, Moved
from .joined import Path
from .vec import Complex, Pose, Real, Whole, cross


@record(checked=True, eq=False)
class Segment(AbstractCurve):
    """The straight line from `start` to `end`, mm, over 0 <= t <= 1."""

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

    @property
    def closed(self) -> bool:
        return False


@record(checked=True, eq=False)
class Arc(AbstractCurve):
    """The circular arc about `centre` from the point `start` over `sweep` rad, counterclockwise positive.

    0 <= t <= 1.
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

    @property
    def closed(self) -> bool:
        return False


@record(checked=True, eq=False)
class Circle(AbstractCurve):
    """A whole circle, counterclockwise from its rightmost point; t is the angle in rad."""

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

    @property
    def closed(self) -> bool:
        return True


# Sweep, rad, below which the area under an arc is told by a series, whose next term is a 2e-15th of it there. Larger,
# and the series lacks that term; smaller, and the closed form loses digits.
FLAT = 0.02


@record(checked=True, eq=False)
class Polyline(AbstractCurve):
    """Straight edges and arcs through `vertices`; edge k runs over k <= t <= k + 1.

    vertices: (n,) complex, mm, the start not repeated. bulges: (n,) for a closed, (n - 1,) for an open
    one, tan(sweep / 4) of each edge's arc, 0 for a straight edge, positive when it turns left, as in
    an LWPOLYLINE of DXF.
    """

    vertices: Row
    bulges: RealRow | None = None
    is_closed: bool = True

    def __post_init__(self) -> None:
        if len(self.vertices) < 2:
            raise DesignError("vertices", "found fewer than two points", "give at least two")
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
        """Area, mm2, between the edges and its first vertex, positive where they turn left about it.

        Of a closed one this is what it encloses: triangles to the chords, and under each arc of sweep s over a chord c
        a segment of c^2 (s - sin s) / (8 sin^2 (s / 2)).
        """
        chords, s = self._edges
        start = np.asarray(self.vertices)[: len(chords)] - self.vertices[0]
        # Of flat arcs the difference loses its digits, and its series has them: further on it would lack terms.
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
        """Its edges as curves of their own."""
        starts, (chords, sweeps) = np.asarray(self.vertices, dtype=complex), self._edges
        found: list[Arc | Segment] = []
        for start, chord, sweep in zip(starts.tolist(), chords.tolist(), sweeps.tolist()):
            # The centre lies to the left of the middle of the chord, for a left turn of less than half a circle.
            centre = start + 0.5 * chord * (1 + 1j / np.tan(sweep / 2)) if sweep else 0j
            found.append(Arc(centre, start, sweep) if sweep else Segment(start, start + chord))
        return tuple(found)

    @property
    def breaks(self) -> Real:
        return np.arange(len(self._edges[0]) + 1.0)

    @property
    def closed(self) -> bool:
        return self.is_closed


def moved(curve: AbstractCurve, pose: Pose) -> AbstractCurve:
    """A curve placed by a pose; a circle stays a circle, so that it can be written as one."""
    if isinstance(curve, Circle):
        return Circle(complex(pose.place(curve.centre)), curve.radius)
    return Moved(curve, pose)


@checked
def rounded_hull(centres: Points, radius: Positive) -> AbstractCurve:
    """The band stretched round equal discs: what a plate with a boss at each of `centres` looks like.

    centres: (n,) complex, mm, any order; those inside the hull add nothing. radius, mm. Counterclockwise; one
    centre gives a circle, two a slot.
    """
    z = np.atleast_1d(np.asarray(centres, dtype=complex))
    if z.ndim > 1 or not z.size:
        raise DesignError("centres", f"found shape {z.shape}", "give a row (n,) of at least one")
    corners = convex_hull(z)
    if len(corners) == 1:
        return Circle(corners[0], radius)
    pieces: list[AbstractCurve] = []
    for before, corner, after in zip(np.roll(corners, 1), corners, np.roll(corners, -1)):
        incoming, outgoing = corner - before, after - corner
        incoming, outgoing = incoming / abs(incoming), outgoing / abs(outgoing)
        # A slot's end turns by exactly half a turn, whose sign rounding would leave to chance.
        turn = np.pi if len(corners) == 2 else float(np.angle(outgoing * incoming.conjugate()))
        pieces.append(Arc(corner, corner - 1j * radius * incoming, turn))
        pieces.append(Segment(corner - 1j * radius * outgoing, after - 1j * radius * outgoing))
    return Path(tuple(pieces))


@checked
def slot(start: complex, end: complex, radius: Positive) -> AbstractCurve:
    """The outline swept by a disc of `radius` from `start` to `end`, mm, counterclockwise."""
    return rounded_hull([start, end], radius)


def convex_hull(z: Complex) -> list[complex]:
    """Corners of the convex hull, counterclockwise, no three in line, by the monotone chain.

    Andrew, Information Processing Letters 9, 1979, 216-219.
    """
    size = float(np.abs(z - z[0]).max())
    rounding = 1e-12 * (size + float(np.abs(z).max()))
    points: list[complex] = []
    for p in sorted(z.tolist(), key=lambda p: (p.real, p.imag)):
        # Centres that differ by rounding would give edges shorter than any file can tell apart.
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
