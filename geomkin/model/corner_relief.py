"""Relief of the inner corners of holes in which something must seat, for a round cutter: dogbones and T-bones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..core.errors import DesignError
from ..core.fields import last_fit, rounded_down
from ..core.records import record
from ..core.units import mm
from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..plane.measure import signed_area
from ..plane.primitives import Polyline
from ..plane.region import is_simple
from ..plane.vec import dot, unit
from .part import Part

# Least rotation of the outline of a hole at a corner, rad. A smaller one leaves nothing that a part would touch.
CORNER = 0.02
# Share of an edge that a relief leaves. With less, a key or a flat would not bear on it.
KEPT = 0.5
# Radius of a relief over that of the cutter. With less, programs that offset chords find no room for the cutter in it.
WIDER = 1.04


@record(eq=False)
class _Edge:
    """An edge of a hole from `start` to `end`: straight, or an arc of a sweep, rad, about its centre."""

    start: complex
    end: complex
    sweep: float

    @property
    def centre(self) -> complex:
        return self.start + (self.end - self.start) / complex(1 - np.exp(1j * self.sweep))

    def direction(self, share: float) -> complex:
        """Direction along the edge, share: 0 at its start and 1 at its end."""
        return complex(unit(self.end - self.start) * np.exp(1j * self.sweep * (share - 0.5)))

    def second_meeting(self, centre: complex, corner: complex) -> complex:
        """The other point at which a circle through a corner of the edge meets it."""
        if self.sweep == 0:
            along = self.direction(0)
            return corner + 2 * float(dot(centre - corner, along)) * along
        axis = unit(centre - self.centre)
        return self.centre + complex(axis**2 * np.conj(corner - self.centre))

    def share(self, point: complex) -> float:
        """Position of a point on the edge, 0 at its start and 1 at its end."""
        if self.sweep == 0:
            return abs(point - self.start) / abs(self.end - self.start)
        middle = (self.start - self.centre) * np.exp(0.5j * self.sweep)
        return 0.5 + float(np.angle((point - self.centre) / middle)) / self.sweep

    def bulge(self, start: complex, end: complex) -> float:
        """Bulge of the part of the edge between two points on it."""
        return float(np.tan((self.share(end) - self.share(start)) * self.sweep / 4)) if self.sweep else 0.0


def relieved(part: Part, cutter: float) -> Part:
    """The part with relief in the corners of its bores with flats or keyways, where a cutter would leave material.

    Parameters
    ----------
    part : Part
        The part. Only holes whose fit has a flat or a keyway change, since only in these corners a part must seat.
    cutter : float
        Diameter of the cutter, mm; 0 for none.

    Returns
    -------
    Part
        Each relief is an arc, hardly wider than the cutter, through the corner: along the bisector, a dogbone, or
        along one edge, a T-bone, if a dogbone would remove more than half of an edge.

    Raises
    ------
    DesignError
        If the cutter is so wide that the relief of a corner leaves less than half of both its edges.
    """
    if cutter == 0:
        return part
    seats = [fit is not None and bool(fit.flat or any(fit.keyway)) for fit in part.fits]
    holes = [
        _relieved_hole(hole, cutter, part.name) if seat else hole
        for hole, seat in zip(part.holes, [*seats, *[False] * len(part.holes)])
    ]
    return replace(part, holes=tuple(holes))


def _relieved_hole(hole: AbstractCurve, cutter: float, name: str) -> AbstractCurve:
    if not isinstance(hole, Polyline):
        return hole
    if (shape := _with_relief(hole, WIDER * cutter / 2)) is not None:
        return shape
    most = last_fit(lambda diameter: _with_relief(hole, WIDER * diameter / 2) is not None, 0.0, cutter)
    raise DesignError(
        "cutter",
        f"found {mm(cutter):g}, too wide for the corners of a hole of the {name}: their relief would remove the edges "
        "on which its shaft or key bears",
        f"give at most {mm(most):down4}, or 0 for corners without relief",
        value=float(rounded_down(most, 4)),
    )


def _with_relief(hole: Polyline, radius: float) -> Polyline | None:
    """The hole with relieved corners, counterclockwise; None if the cutter is too wide."""
    z = np.asarray(hole.vertices, dtype=complex)
    bulges = np.zeros(len(z)) if hole.bulges is None else np.asarray(hole.bulges, dtype=float)
    if signed_area(hole) < 0:
        z, bulges = z[::-1], -np.roll(bulges[::-1], -1)
    edges = [
        _Edge(a, b, 4 * float(np.arctan(bulge))) for a, b, bulge in zip(z.tolist(), np.roll(z, -1).tolist(), bulges)
    ]
    corners = [k for k, edge in enumerate(edges) if np.angle(edge.direction(0) / edges[k - 1].direction(1)) > CORNER]
    centres: dict[int, complex] = {}
    for k in corners:
        neighbours = (k - 1) % len(edges) in corners, (k + 1) % len(edges) in corners
        if (centre := _relief_centre(edges[k - 1], edges[k], neighbours, radius)) is None:
            return None
        centres[k] = centre
    # The points at which each edge begins and ends.
    starts = [
        edges[k].second_meeting(centres[k], edges[k].start) if k in centres else edges[k].start
        for k in range(len(edges))
    ]
    ends = [
        edge.second_meeting(centres[after], edge.end) if (after := (k + 1) % len(edges)) in centres else edge.end
        for k, edge in enumerate(edges)
    ]
    vertices: list[complex] = []
    arcs: list[float] = []
    joined: set[int] = set()
    for k, edge in enumerate(edges):
        after = (k + 1) % len(edges)
        if k in centres and after in centres and edge.share(starts[k]) + 1e-9 >= edge.share(ends[k]):
            across = centres[after] - centres[k]
            if edge.sweep or float(dot(across, edge.direction(0))) < 0:
                return None
            # Both reliefs meet outside the edge, of which nothing remains.
            height = float(np.sqrt(max(radius**2 - abs(across) ** 2 / 4, 0.0)))
            starts[k] = ends[k] = (centres[k] + centres[after]) / 2 - 1j * edge.direction(0) * height
            joined.add(k)
    for k, edge in enumerate(edges):
        if k in centres:
            sweep = float(np.angle((starts[k] - centres[k]) / (ends[k - 1] - centres[k]))) % (2 * np.pi)
            vertices.append(ends[k - 1])
            arcs.append(float(np.tan(sweep / 4)))
        if k not in joined:
            vertices.append(starts[k])
            arcs.append(edge.bulge(starts[k], ends[k]))
    shape = Polyline(np.array(vertices), np.array(arcs))
    # Reliefs that cross other edges are as wide as the hole.
    return shape if is_simple(flatten(shape, radius / 100)) else None


def _relief_centre(before: _Edge, after: _Edge, shared: tuple[bool, bool], radius: float) -> complex | None:
    """Centre of the relief at the corner between two edges; None if each choice leaves too little of both.

    shared: whether the other end of each edge is relieved too.
    """
    corner, arriving, leaving = after.start, before.direction(1), after.direction(0)
    allowed = [(1 - KEPT) / (2 if is_shared else 1) for is_shared in shared]
    bisector = complex(unit(leaving - arriving))
    taken = _taken(before, after, corner + radius * bisector)
    if all(share <= most for share, most in zip(taken, allowed)):
        return corner + radius * bisector
    # Tangent to one edge, which it keeps: to one that no other corner shortens, or of which a dogbone takes more.
    keeps_first = (not shared[0], taken[0] / allowed[0]) > (not shared[1], taken[1] / allowed[1])
    centre = corner + radius * 1j * (arriving if keeps_first else leaving)
    most = 1.0 if not shared[not keeps_first] else 1 - KEPT
    return centre if _taken(before, after, centre)[int(keeps_first)] <= most else None


def _taken(before: _Edge, after: _Edge, centre: complex) -> tuple[float, float]:
    """Shares of both edges that a relief about a centre removes."""
    corner = after.start
    return 1 - before.share(before.second_meeting(centre, corner)), after.share(after.second_meeting(centre, corner))
