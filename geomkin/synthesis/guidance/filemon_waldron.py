"""Regions of the pins of a four-bar through three poses in which it need not change its branch."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import between, checked
from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST
from ...core.records import record
from ...linkage.instant.centres import InstantCentre
from ...plane.curve import AbstractCurve
from ...plane.flatten import flatten
from ...plane.primitives import Circle, Polyline, Segment
from ...plane.vec import Complex, Mask, cross, dot, unit
from .guide_search import Displacements, rail_of
from .poses import Poses, distinct_poses, image_poles

# Sine of the angle between the ends of three positions, seen from the middle one, below which they are collinear.
STRAIGHT = 1e-9
# Largest distance of a circle's chords from it in a drawn region, as a share of the box; more shows corners.
NEAR = 5e-4


@record(eq=False, kw_only=True)
class Rectification:
    """Regions of the pins of a four-bar, with the body at the first of three poses, mm on the ground.

    Parameters
    ----------
    image_poles : tuple of three InstantCentre
        The image poles; at infinity if two poses are parallel.
    circles : tuple of AbstractCurve
        Circles with the sides of the triangle of image poles as diameters, to draw. A side that runs to infinity gives
        a line, a side at infinity nothing. A driven pin inside an odd number of them has no driver; see `drivable`.
    driven : complex or None
        Pin of the driven link, if given.
    lines : tuple of AbstractCurve
        Lines through it along the driven link at the three poses, as seen from the body. The driving pin must be on the
        same side of all three, each oriented as the link; see `drives`.
    directions : array of complex, shape (3,)
        Directions of these lines.
    """

    image_poles: tuple[InstantCentre, InstantCentre, InstantCentre]
    circles: tuple[AbstractCurve, ...]
    driven: complex | None
    lines: tuple[AbstractCurve, ...]
    directions: Complex

    @checked
    def drivable(self, points: complex | ArrayLike) -> Mask:
        """Whether a driven link at each point has some driver with which the branch need not change.

        Parameters
        ----------
        points : array_like of complex
            Driven pins at the first pose, mm.

        Returns
        -------
        array of bool
            By Waldron's circles; poles at infinity need no special case, since only the sign of a product counts.
        """
        z = np.asarray(points, dtype=complex)
        a, b, c = (pole.arm + pole.weight * (pole.reference - z) for pole in self.image_poles)
        return np.asarray(np.sign(dot(a, b)) * np.sign(dot(b, c)) * np.sign(dot(c, a)) > 0)

    @checked
    def drives(self, points: complex | ArrayLike) -> Mask:
        """Whether a driving link at each point moves the driven one on one branch (Filemon's region).

        Parameters
        ----------
        points : array_like of complex
            Driving pins at the first pose, mm.

        Returns
        -------
        array of bool
            Other defects, of circuit or order, are not covered.

        Raises
        ------
        DesignError
            If no driven pin was given.
        """
        if self.driven is None:
            raise DesignError(
                "driven", "is missing", "give the driven link's pin when the regions are made", "missing-key"
            )
        side = cross(self.driven - np.asarray(points, dtype=complex)[..., None], self.directions)
        return np.asarray((side > 0).all(axis=-1) | (side < 0).all(axis=-1))

    @checked
    def no_driven(self, low: complex, high: complex) -> tuple[AbstractCurve, ...]:
        """Outlines of the region without `drivable` points, to draw.

        Parameters
        ----------
        low, high : complex
            Opposite corners of the box that is covered, mm.

        Returns
        -------
        tuple of AbstractCurve
            Closed curves; a point is in the region if an odd number of them surround it. Circles are drawn by chords
            with an error of at most a thousandth of the box.
        """
        return self._outlines(self.circles, low, high, lambda points: ~self.drivable(points))

    @checked
    def no_driver(self, low: complex, high: complex) -> tuple[AbstractCurve, ...]:
        """Outlines of the region in which a pin does not drive the driven one: all but two opposite wedges, or all.

        Parameters
        ----------
        low, high : complex
            Opposite corners of the box that is covered, mm.

        Returns
        -------
        tuple of AbstractCurve
            Closed curves, as for `no_driven`.
        """
        return self._outlines(self.lines, low, high, lambda points: ~self.drives(points))

    def _outlines(
        self, borders: Iterable[AbstractCurve], low: complex, high: complex, holds: Callable[[Complex], Mask]
    ) -> tuple[AbstractCurve, ...]:
        from ...plane.region import where  # loads shapely, which only a drawing needs

        diagonal, centre = high - low, (low + high) / 2
        if not diagonal.real or not diagonal.imag:
            raise DesignError(
                "high", f"found {shown(high)}, on a line with {shown(low)}", "give the opposite corner", "conflict"
            )
        box = low + np.array([0, diagonal.real, diagonal, 1j * diagonal.imag])
        lines = []
        for border in borders:
            if isinstance(border, Segment):
                # Long enough to cross the box.
                direction = unit(np.array(border.end - border.start))
                foot = centre - 1j * direction * np.imag((centre - border.start) / direction)
                lines.append(foot + abs(diagonal) * direction * np.array([-1, 1]))
            else:
                points = flatten(border, NEAR * abs(diagonal))
                lines.append(np.append(points, points[:1]))
        return tuple(Polyline(loop) for loops in where(box, lines, holds) for loop in loops)


@checked
def rectification(
    poses: Poses, driven: complex | None = None, reach: Annotated[float, between(0, FARTHEST, "mm")] | None = None
) -> Rectification:
    """Find the regions of the pins of a four-bar, or of the crank pin of a slider-crank, for three poses.

    Parameters
    ----------
    poses : sequence of (complex, float)
        Three poses, each an origin x + yj in mm and an angle in rad.
    driven : complex, optional
        Driven pin with the body at the first pose, mm on the ground. A pin that can slide along a line is taken as a
        slider's.
    reach : float, optional
        Half the length of drawn lines, mm.

    Returns
    -------
    Rectification
        The regions.

    Raises
    ------
    DesignError
        For other than three poses.

    Notes
    -----
    Filemon, Useful ranges of centerpoint curves, Mechanism and Machine Theory 7, 1972; Waldron, Elimination of the
    branch problem in graphical Burmester mechanism synthesis, Journal of Engineering for Industry 98, 1976.
    """
    origins, directions = distinct_poses(poses, 3, 3)
    images = tuple(image_poles(poses).values())
    size = np.abs(origins - origins.mean()).max()
    places = np.array([complex(image.position) for image in images])
    finite = places[np.isfinite(places)]
    if reach is None:
        reach = 2 * float(max(size, np.abs(finite - finite.mean()).max() if len(finite) else 0.0)) or 1.0
    sides = [(images[0], images[1]), (images[1], images[2]), (images[2], images[0])]
    circles = [circle for side in sides if (circle := _circle_over(*side, reach)) is not None]
    link_directions, lines = np.zeros(3, dtype=complex), []
    if driven is not None:
        link_directions = _driven_directions(Displacements(origins, directions), driven)
        lines = [Segment(driven - reach * along, driven + reach * along) for along in link_directions.tolist()]
    return Rectification(
        image_poles=(images[0], images[1], images[2]),
        circles=tuple(circles),
        driven=driven,
        lines=tuple(lines),
        directions=link_directions,
    )


def _circle_over(one: InstantCentre, other: InstantCentre, reach: float) -> AbstractCurve | None:
    """The circle whose diameter is the side between two image poles; a line if one of them is at infinity."""
    start, end = complex(one.position), complex(other.position)
    if np.isfinite(start) and np.isfinite(end):
        return Circle((start + end) / 2, abs(end - start) / 2) if start != end else None
    if not np.isfinite(start) and not np.isfinite(end):
        return None
    finite, far = (start, other) if np.isfinite(start) else (end, one)
    across = 1j * complex(far.direction)
    return Segment(finite - reach * across, finite + reach * across)


def _driven_directions(body: Displacements, driven: complex) -> Complex:
    """Directions of the driven link from pivot to pin at three poses, seen from the body; of a slider its normal."""
    pins = body.pins(np.array([driven]))
    a, b = pins[1] - pins[0], pins[2] - pins[0]
    straight = np.abs(cross(a, b)) <= STRAIGHT * np.maximum(np.abs(a), np.abs(b)) ** 2
    arms = 1j * rail_of(pins) * np.ones(3) if straight[0] else (pins - body.centre(pins))[:, 0]
    return unit(arms * np.conj(body.turns))
