"""Parts as the loops that a machine follows: flattened once, checked once, the same for every format."""

from __future__ import annotations

import numpy as np

from ..core.errors import DesignError
from ..core.fields import WIDEST, rounded_up
from ..core.records import record
from ..model.part import Part
from ..plane import measure as measure
from ..plane import region as region
from ..plane.arcs import to_arcs
from ..plane.curve import AbstractCurve, extent
from ..plane.flatten import flatten
from ..plane.parallel import parallel
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, rounded
from .lettering import lettered

# Finest tolerance, as a share of the part's size: finer lies below the numbers that meshes are written in,
# and takes minutes.
FINEST = 1e-7


@record(eq=False)
class Loop:
    """One cut or mark. shape: a Circle, or a Polyline whose vertices are rounded; layer: its operation.

    points: the same as plain vertices (n,) complex, mm. A cut is closed and counterclockwise; a mark keeps its
    own direction and may be open.
    """

    shape: Circle | Polyline
    points: Complex
    layer: str

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of the shape, mm, arcs as far as they reach between their ends."""
        if isinstance(self.shape, Circle):
            corner = self.shape.radius * (1 + 1j)
            return self.shape.centre - corner, self.shape.centre + corner
        z = np.asarray(self.shape.vertices)
        if self.shape.bulges is not None:
            z = np.append(z, _tops(self.shape))
        return complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())

    def moved(self, shift: complex, digits: int, turn: complex = 1 + 0j) -> Loop:
        """The same elsewhere, turned about the origin first, by a unit complex number.

        Rounded once more, since the sum of two short decimals is seldom one.
        """
        points = rounded(self.points * turn + shift, digits)
        if isinstance(self.shape, Circle):
            centre = rounded(np.asarray(self.shape.centre * turn + shift), digits).item()
            return Loop(Circle(centre, self.shape.radius), points, self.layer)
        # The corners of what has no arcs are its points.
        same = self.shape.vertices is self.points
        vertices = points if same else rounded(np.asarray(self.shape.vertices) * turn + shift, digits)
        return Loop(Polyline(vertices, self.shape.bulges, self.shape.closed), points, self.layer)


@record(eq=False)
class Cut:
    """A part ready for its files.

    loops: the cuts, outline first, then the holes; marks: what is engraved; label: its name or number among that, ""
    where it has none. digits: decimals of mm that its numbers carry; tolerance: mm, that it was flattened within.
    """

    part: Part
    loops: tuple[Loop, ...]
    marks: tuple[Loop, ...]
    digits: int
    tolerance: float
    label: str = ""

    @property
    def area(self) -> float:
        """Area within the cuts as they are written, mm2: the outline's less the holes'."""
        outline, *holes = (measure.area(loop.shape) for loop in self.loops)
        return outline - sum(holes)

    @property
    def chord_area(self) -> float:
        """The same of the chords that solids are made of."""
        outline, *holes = (signed_area(loop.points) for loop in self.loops)
        return outline - sum(holes)

    @property
    def is_twisted(self) -> bool:
        """Whether its solid reaches beyond its outline, as it does where that turns or shifts on the way up."""
        return self.part.twist is not None and self.part.twist.moves == "outline"

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of the outline, mm; of one that is twisted, of the room that it takes."""
        low, high = self.loops[0].box
        twist = self.part.twist
        if twist is None or not self.is_twisted:
            return low, high
        if twist.turn:
            corner = float(np.abs(self.loops[0].points).max()) * (1 + 1j)
            low, high = -corner, corner
        return low + min(twist.shift, 0.0), high + max(twist.shift, 0.0)


def _tops(shape: Polyline) -> Complex:
    """Places on arcs where they run along either axis."""
    edges = np.arange(len(shape.breaks) - 1)
    chord = shape.point(edges + 1) - shape.point(edges)
    sweep = 4 * np.arctan(np.asarray(shape.bulges))
    # Along an arc the direction turns evenly, from half its sweep before the chord's to half of it beyond.
    share = 0.5 + np.angle(np.outer([1, 1j, -1, -1j], chord.conj())) / np.where(sweep == 0, np.inf, sweep)
    axis, edge = np.nonzero((0 < share) & (share < 1) & (sweep != 0))
    return shape.point(edge + share[axis, edge])


def decimals(tolerance: float) -> int:
    """Decimals of mm that files carry: a ten-thousandth of the tolerance.

    Fewer would show; more would let the last bit of a processor's sine reach the file, and the same
    recipe would no longer give the same bytes everywhere.
    """
    return max(0, 4 - int(np.floor(np.log10(tolerance))))


def cut(part: Part, tolerance: float, kerf: float = 0.0, arcs: bool = False, number: int = 0) -> Cut:
    """The loops of a part within `tolerance`, mm, of its curves, moved by half the `kerf` off the material.

    arcs: polylines keep arcs instead of chords, unless the kerf closes a gap or a bend, which leaves chords.
    Marks are always chords, and stay where they are whatever the kerf. number: of the part, which is then engraved
    with its name, or with that number where the name finds no room; 0 for neither.
    """
    check_scale(part, tolerance)
    outline = _loop(part.outline, part.layer, kerf / 2, tolerance, arcs, part.name)
    holes = [_loop(h, "HOLE", -kerf / 2, tolerance, arcs, part.name) for h in part.holes]
    _check_holes(part, outline, holes, tolerance)
    label, strokes = lettered(part, number) if number else ("", ())
    letters = (Loop(Polyline(line, is_closed=False), line, "LABEL") for line in strokes)
    return Cut(part, (outline, *holes), (*_marks(part, tolerance), *letters), decimals(tolerance), tolerance, label)


def _check_holes(part: Part, outline: Loop, holes: list[Loop], tolerance: float) -> None:
    """Holes must lie within the outline and apart; the first that does not is told."""
    inside = region.apart_inside(outline.points, [hole.points for hole in holes], tolerance)
    meeting = region.overlapping([hole.points for hole in holes])[:, 1]
    out = int(np.argmin(inside)) if not inside.all() else len(holes)
    if out < len(holes) and out <= meeting.min(initial=out):
        raise DesignError(
            part.name,
            f"hole {out + 1} reaches the outline, or comes nearer than the tolerance of {tolerance:g} mm",
            "make the hole smaller or the part larger",
        )
    if len(meeting):
        raise DesignError(part.name, "two holes meet", "move them apart or make them smaller")


def check_scale(part: Part, tolerance: float, share: float = 1.0) -> None:
    """Refuse a part too small or too large for files, or a tolerance of which this share is too fine for it."""
    size = extent(part.outline)
    if not 10 * tolerance < size < WIDEST:
        raise DesignError(
            part.name,
            f"it is about {size:.3g} mm across",
            f"make parts between {10 * tolerance:g} mm (ten times the tolerance) and {WIDEST:g} mm",
        )
    far = abs(complex(part.outline.point(np.asarray(part.outline.breaks[0]))))
    if far > WIDEST:
        # The digits left there tell no corner of it from another.
        raise DesignError(part.name, f"it lies about {far:.3g} mm from the origin", f"stay within {WIDEST:g} mm")
    if tolerance * share < FINEST * size:
        raise DesignError(
            "tolerance",
            f"found {tolerance:g} mm for the {part.name}, which is about {size:.3g} mm across",
            f"give at least {rounded_up(FINEST * size / share, 2)} mm",
        )


def _marks(part: Part, tolerance: float) -> tuple[Loop, ...]:
    """The marks; refuses one that reaches the outline, since a part cannot be engraved beside itself."""
    if not part.marks:
        return ()
    marks, outline = [_mark(part, curve, tolerance) for curve in part.marks], flatten(part.outline, tolerance)
    for k, mark in enumerate(marks):
        # There and back: the ring that the distance is taken to must not close an open mark by a chord.
        line = mark.points if mark.shape.closed else np.append(mark.points, mark.points[-2::-1])
        if region.gap(outline, line) == 0 or not is_inside(outline, line[0]):
            raise DesignError(
                part.name,
                f"mark {k + 1} reaches over the outline",
                "move the mark inwards, make it smaller or the part larger",
            )
    return tuple(marks)


def _mark(part: Part, curve: AbstractCurve, tolerance: float) -> Loop:
    digits = decimals(tolerance)
    points = rounded(flatten(curve, tolerance), digits)
    kept = np.append(True, points[1:] != points[:-1])
    kept[-1] &= not (curve.closed and points[-1] == points[0])
    points = points[kept]
    if len(points) < (3 if curve.closed else 2):
        raise DesignError(part.name, "a mark is smaller than files can tell", "make it larger")
    if isinstance(curve, Circle):
        circle = Circle(rounded(curve.centre, digits).item(), rounded(curve.radius, digits).item())
        return Loop(circle, points, "ENGRAVE")
    return Loop(Polyline(points, is_closed=curve.closed), points, "ENGRAVE")


def is_inside(outline: Complex, place: complex) -> bool:
    """Whether a polygon winds round a place that does not lie on it."""
    seen = outline - place
    return bool(abs(np.angle(np.roll(seen, -1) / seen).sum()) > np.pi)


def _loop(curve: AbstractCurve, layer: str, grow: float, tolerance: float, arcs: bool, name: str) -> Loop:
    digits = decimals(tolerance)
    if isinstance(curve, Circle):
        radius = curve.radius + grow
        if radius <= 0:
            raise DesignError("kerf", f"found {-2 * grow:g} mm, wider than a hole of the {name}", "give a smaller kerf")
        if round(radius, digits) <= 0:
            raise DesignError(name, f"a hole {2 * radius:.3g} mm wide is smaller than files can tell", "make it larger")
        circle = Circle(rounded(curve.centre, digits).item(), rounded(radius, digits).item())
        return Loop(circle, _rounded_loop(flatten(circle, tolerance), digits), layer)
    sense = float(np.sign(measure.signed_area(curve, 1e-3)))
    moved = parallel(curve, grow * sense)
    points = flatten(moved, tolerance) if moved else np.empty(0, dtype=complex)
    # What a slot narrower than the beam leaves runs the other way round.
    turned = signed_area(points) * sense <= 0
    points = _rounded_loop(points, digits)
    if grow and (turned or not region.is_simple(points)):
        # The parallel curve crosses itself or cannot be drawn: trim it, which only polygons can.
        moved, points = None, _rounded_loop(_grown(flatten(curve, tolerance / 2), grow, tolerance / 2, name), digits)
    if len(points) < 3:
        raise DesignError(name, "a contour is smaller than files can tell", "make it larger")
    if not region.is_simple(points):
        raise DesignError(name, "the outline crosses itself", "change the sizes that make it overlap")
    shape = _rounded_arcs(to_arcs(moved, tolerance), tolerance) if arcs and moved else Polyline(points)
    return Loop(shape, points, layer)


def _rounded_arcs(exact: Polyline, tolerance: float) -> Polyline:
    """Vertices and bulges fit for a file, counterclockwise; what is flat to the last decimal is straight."""
    digits = decimals(tolerance)
    z = rounded(exact.vertices, digits)
    bulges = np.zeros(len(z)) if exact.bulges is None else np.asarray(exact.bulges)
    # An arc that no file can tell from a point would be an edge without direction.
    seen = np.abs(np.roll(z, -1) - z) > tolerance / 100
    z, bulges = z[seen], bulges[seen]
    flat = np.abs(bulges * (np.roll(z, -1) - z)) < 10.0**-digits
    # Twelve decimals of a bulge lie below the last decimal of any vertex.
    bulges = np.where(flat, 0.0, np.round(bulges, 12))
    shape = Polyline(z, bulges)
    return shape if measure.signed_area(shape) > 0 else Polyline(z[::-1], 0.0 - np.roll(bulges[::-1], -1))


def _grown(points: Complex, grow: float, tolerance: float, name: str) -> Complex:
    """The polygon grown by half the kerf; refused where a beam so wide would leave another part than asked for."""
    points = points if signed_area(points) > 0 else points[::-1]
    regions = region.offset([points], grow, tolerance)
    whole = len(regions) == 1 and len(regions[0]) == 1
    left = region.offset(regions[0], -grow, tolerance) if whole else []
    changed = abs(sum(signed_area(r[0]) for r in left) - signed_area(points))
    # Rounding of sharp inner corners, which no beam can avoid, stays far below this.
    if not whole or changed > 8 * tolerance * np.abs(np.diff(points)).sum():
        raise DesignError(
            "kerf",
            f"found {2 * abs(grow):g} mm, wider than a gap or a neck of the {name}",
            "give a smaller kerf or a larger part",
        )
    return regions[0][0]


def _rounded_loop(z: Complex, digits: int) -> Complex:
    """Rounded, without repeats, counterclockwise."""
    if not len(z):
        return z
    z = rounded(z, digits)
    z = z[z != np.roll(z, 1)]
    return z if signed_area(z) >= 0 else z[::-1]


def signed_area(z: Complex) -> float:
    """Area of a polygon, mm2, positive when counterclockwise."""
    about = z - z[:1]
    return float(0.5 * np.imag(np.conj(about) * np.roll(about, -1)).sum())
