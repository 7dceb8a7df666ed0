"""Where the pins of a four-bar through three poses may be so that it need not change its branch on the way."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Annotated

import numpy as np

from ...core.arguments import Points, between, checked
from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST
from ...core.records import record
from ...linkage.instant.centres import InstantCentre
from ...plane.curve import AbstractCurve
from ...plane.flatten import flatten
from ...plane.primitives import Circle, Polyline, Segment
from ...plane.vec import Complex, Mask, cross, dot, unit
from .guide_search import Displacements, rail_of
from .poses import Poses, image_poles, placed

# Sine of the turn between the ends of three places, seen from the middle one, below which they count as one line.
STRAIGHT = 1e-9
# How far a circle's chords are off where a region is drawn, as a share of the box: more, and corners show.
NEAR = 5e-4


@record(eq=False, kw_only=True)
class Rectification:
    """Regions of a body's points, as it stands at the first of three poses, mm on the ground.

    image_poles: the three, at infinity where two poses are parallel. circles: with the sides of their triangle as
    diameters, curves to draw; a side that runs to infinity makes a line, and one that lies there none. A point inside
    an odd number of them has no driver: `drivable`. driven: the driven link's pin, if it was given, and lines: through
    it, as the driven link lies at the three poses seen from the body; the pin of a driver is on one side of all three,
    each as the link points: `drives`.
    """

    image_poles: tuple[InstantCentre, InstantCentre, InstantCentre]
    circles: tuple[AbstractCurve, ...]
    driven: complex | None
    lines: tuple[AbstractCurve, ...]
    ways: Complex

    @checked
    def drivable(self, points: Points) -> Mask:
        """Whether a driven link at each of these points has a driver somewhere that need not change the branch.

        By Waldron's circles; poles at infinity are an ordinary case, as only the sign of a product tells.
        """
        z = np.asarray(points, dtype=complex)
        a, b, c = (pole.arm + pole.weight * (pole.reference - z) for pole in self.image_poles)
        return np.asarray(np.sign(dot(a, b)) * np.sign(dot(b, c)) * np.sign(dot(c, a)) > 0)

    @checked
    def drives(self, points: Points) -> Mask:
        """Whether a driving link at each of these points takes the driven one through on one branch: Filemon's region.

        DesignError where no driven pin was given. What else may be wrong, a circuit or the order, is not told by it.
        """
        if self.driven is None:
            raise DesignError("driven", "is missing", "give the driven link's pin when the regions are made")
        side = cross(self.driven - np.asarray(points, dtype=complex)[..., None], self.ways)
        return np.asarray((side > 0).all(axis=-1) | (side < 0).all(axis=-1))

    @checked
    def no_driven(self, low: complex, high: complex) -> tuple[AbstractCurve, ...]:
        """Closed curves, of which an odd number are around every point of a box that is not `drivable`, to draw.

        low, high: opposite corners, mm. The chords of circles are off by a thousandth of the box at most.
        """
        return self._where(self.circles, low, high, lambda points: ~self.drivable(points))

    @checked
    def no_driver(self, low: complex, high: complex) -> tuple[AbstractCurve, ...]:
        """The same of the points where a pin does not drive the driven one: all but two opposite wedges, or all."""
        return self._where(self.lines, low, high, lambda points: ~self.drives(points))

    def _where(
        self, borders: Iterable[AbstractCurve], low: complex, high: complex, holds: Callable[[Complex], Mask]
    ) -> tuple[AbstractCurve, ...]:
        from ...plane.region import where  # loads shapely, which only a drawing needs

        across, middle = high - low, (low + high) / 2
        if not across.real or not across.imag:
            raise DesignError("high", f"found {shown(high)}, on a line with {shown(low)}", "give the opposite corner")
        box = low + np.array([0, across.real, across, 1j * across.imag])
        lines = []
        for border in borders:
            if isinstance(border, Segment):
                # As long as it takes to go through the box.
                way = unit(np.array(border.end - border.start))
                foot = middle - 1j * way * np.imag((middle - border.start) / way)
                lines.append(foot + abs(across) * way * np.array([-1, 1]))
            else:
                points = flatten(border, NEAR * abs(across))
                lines.append(np.append(points, points[:1]))
        return tuple(Polyline(loop) for loops in where(box, lines, holds) for loop in loops)


@checked
def rectification(
    poses: Poses, driven: complex | None = None, reach: Annotated[float, between(0, FARTHEST, "mm")] | None = None
) -> Rectification:
    """Regions for the driven and the driving pin of a four-bar, or the crank pin of a slider-crank, by three poses.

    driven: the driven pin as the body stands at the first pose, mm on the ground; where it can slide along a line, it
    is taken for a slider's. reach: half the length that lines are drawn with, mm. DesignError for other than three
    poses. Filemon, Useful ranges of centerpoint curves, Mechanism and Machine Theory 7, 1972; Waldron, Elimination of
    the branch problem in graphical Burmester mechanism synthesis, Journal of Engineering for Industry 98, 1976.
    """
    origins, directions = placed(poses, 3, 3)
    images = tuple(image_poles(poses).values())
    spread = np.abs(origins - origins.mean()).max()
    places = np.array([complex(image.position) for image in images])
    known = places[np.isfinite(places)]
    if reach is None:
        reach = 2 * float(max(spread, np.abs(known - known.mean()).max() if len(known) else 0.0)) or 1.0
    circles: list[AbstractCurve] = []
    for k in range(3):
        ends = [images[k], images[(k + 1) % 3]]
        at = [complex(end.position) for end in ends]
        far = [not np.isfinite(z) for z in at]
        if not any(far) and at[0] != at[1]:
            circles.append(Circle((at[0] + at[1]) / 2, abs(at[1] - at[0]) / 2))
        elif far[0] != far[1]:
            near, across = at[1] if far[0] else at[0], 1j * complex(ends[0 if far[0] else 1].direction)
            circles.append(Segment(near - reach * across, near + reach * across))
    ways, lines = np.zeros(3, dtype=complex), []
    if driven is not None:
        ways = _seen(Displacements(origins, directions), driven)
        lines = [Segment(driven - reach * way, driven + reach * way) for way in ways.tolist()]
    return Rectification(image_poles=images, circles=tuple(circles), driven=driven, lines=tuple(lines), ways=ways)  # type: ignore[arg-type]


def _seen(body: Displacements, driven: complex) -> Complex:
    """Directions of the driven link at three poses, from its pivot to its pin, seen from the body; or of its slide's
    normal.
    """
    pins = body.pins(np.array([driven]))
    a, b = pins[1] - pins[0], pins[2] - pins[0]
    straight = np.abs(cross(a, b)) <= STRAIGHT * np.maximum(np.abs(a), np.abs(b)) ** 2
    arms = 1j * rail_of(pins) * np.ones(3) if straight[0] else (pins - body.centre(pins))[:, 0]
    return unit(arms * np.conj(body.turns))
