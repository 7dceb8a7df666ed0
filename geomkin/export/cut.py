"""Parts as the loops that a machine cuts or engraves, flattened and checked once for all formats."""

from __future__ import annotations

import re
from dataclasses import fields

import numpy as np

from ..core.errors import DesignError, shown
from ..core.fields import WIDEST, entry, rounded_up
from ..core.names import folded_name
from ..core.records import record
from ..core.units import mm
from ..model.part import Part
from ..plane import measure as measure
from ..plane import region as region
from ..plane.approximation import to_arcs
from ..plane.curve import AbstractCurve, extent
from ..plane.flatten import flatten
from ..plane.primitives import Circle, Polyline
from ..plane.region import parallel
from ..plane.vec import Complex, box_of, rounded
from .text import lettered

# Finest tolerance as a share of the part's size: a finer one is below the precision of the numbers in meshes
# and takes minutes.
FINEST = 1e-7
# Layers of drawings by operation: a colour index, for programs without RGB, and an RGB colour that colour-blind readers
# can distinguish.
LAYERS: dict[str, tuple[int, tuple[int, int, int]]] = {
    "CUT": (1, (213, 94, 0)),
    "HOLE": (5, (0, 114, 178)),
    "ENGRAVE": (3, (0, 158, 115)),
    "LABEL": (6, (204, 121, 167)),
    "REFERENCE": (8, (110, 110, 110)),
    "TAB": (2, (230, 159, 0)),
}
# Characters that programs do not take in names of layers, and the longest name of the oldest format.
FORBIDDEN, LONGEST_NAME = set('<>/\\":;?*=|,`'), 31
COLOUR = re.compile("#[0-9a-fA-F]{6}")


@record(checked=True)
class LayerStyle:
    """Name and colour of a layer in drawings to cut.

    Parameters
    ----------
    name : str, optional
        Name in DXF; by default that of the operation, such as CUT.
    colour : str, optional
        Colour as "#ff0000", in DXF the nearest one of its palette; by default that of the operation.
    """

    name: str = entry("name of the layer in DXF; by default that of the operation, such as CUT", default="")
    colour: str = entry('colour of the layer, as "#ff0000"; by default that of the operation', default="")

    def __post_init__(self) -> None:
        name = self.name
        # Programs do not plot the layer Defpoints.
        is_unseen = name.casefold() == "defpoints"
        if (
            is_unseen
            or len(name) > LONGEST_NAME
            or name != name.strip()
            or not name.isprintable()
            or FORBIDDEN & set(name)
        ):
            allowed = f"give at most {LONGEST_NAME} letters, without {' '.join(sorted(FORBIDDEN))}, and not Defpoints"
            raise DesignError("name", f"found {shown(name)}", allowed, "out-of-range")
        if self.colour and not COLOUR.fullmatch(self.colour):
            raise DesignError("colour", f"found {shown(self.colour)}", 'give six digits, as "#ff0000"', "out-of-range")


@record(checked=True)
class LayerStyles:
    """Names and colours of the layers of drawings to cut, by operation.

    Parameters
    ----------
    cut, hole, engrave, label, tab : LayerStyle, optional
        Of outlines, holes, engraved lines, engraved names and letters, and the tabs that hold a part in its sheet.
    """

    cut: LayerStyle | None = entry("layer of outlines", default=None)
    hole: LayerStyle | None = entry("layer of holes", default=None)
    engrave: LayerStyle | None = entry("layer of engraved lines", default=None)
    label: LayerStyle | None = entry("layer of engraved names and letters", default=None)
    tab: LayerStyle | None = entry("layer of the tabs that hold parts in their sheet", default=None)

    def __post_init__(self) -> None:
        names = [folded_name(name) for name in self.names.values()]
        if twice := [name for name in names if names.count(name) > 1]:
            raise DesignError("cut", f"two layers are named {shown(twice[0])}", "give each its own name", "conflict")

    @property
    def names(self) -> dict[str, str]:
        """The name in files of each layer."""
        return {layer: self.style(layer).name or layer for layer in LAYERS}

    @property
    def colours(self) -> dict[str, tuple[int, int, int]]:
        """The RGB colour of each layer whose colour is given."""
        given = {layer: self.style(layer).colour for layer in LAYERS}
        return {layer: tuple(bytes.fromhex(colour[1:])) for layer, colour in given.items() if colour}  # type: ignore[misc]

    def style(self, layer: str) -> LayerStyle:
        """Name and colour given for a layer of the table above."""
        known = layer.lower() in (field.name for field in fields(self))
        style: LayerStyle | None = getattr(self, layer.lower()) if known else None
        return style or LayerStyle()


@record(eq=False)
class Loop:
    """One cut or mark.

    `shape` is a Circle, or a Polyline with rounded vertices, on its `layer`. `points` are its vertices (n,) complex,
    mm, without arcs. A cut is closed and counterclockwise; a mark keeps its direction and may be open.
    """

    shape: Circle | Polyline
    points: Complex
    layer: str

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of the shape including its arcs, mm."""
        return shape_box(self.shape)

    def moved(self, shift: complex, digits: int, turn: complex = 1 + 0j) -> Loop:
        """A copy rotated about the origin by a unit complex number, then shifted, and rounded to `digits` decimals."""
        points = rounded(self.points * turn + shift, digits)
        if isinstance(self.shape, Circle):
            centre = rounded(np.asarray(self.shape.centre * turn + shift), digits).item()
            return Loop(Circle(centre, self.shape.radius), points, self.layer)
        # The vertices of a shape without arcs are its points.
        same = self.shape.vertices is self.points
        vertices = points if same else rounded(np.asarray(self.shape.vertices) * turn + shift, digits)
        return Loop(Polyline(vertices, self.shape.bulges, self.shape.closed), points, self.layer)


@record(eq=False)
class Cut:
    """A part ready for its files.

    `loops` are the cuts, outline first, then the holes. `marks` are the engraved lines, including the part's `label` if
    it has one. `digits` is the number of decimals of mm; `tolerance` is that of flattening, mm. `tab` is the width of
    the tabs that hold the part in its sheet, mm, 0 for none. `foot` is the chamfer of the solid's lower edges, mm.
    """

    part: Part
    loops: tuple[Loop, ...]
    marks: tuple[Loop, ...]
    digits: int
    tolerance: float
    label: str = ""
    tab: float = 0.0
    foot: float = 0.0

    @property
    def area(self) -> float:
        """Area inside the written cuts, mm2: the outline's minus the holes'."""
        outline, *holes = (measure.area(loop.shape) for loop in self.loops)
        return outline - sum(holes)

    @property
    def chord_area(self) -> float:
        """The same area for the chords that solids are made of."""
        outline, *holes = (polygon_area(loop.points) for loop in self.loops)
        return outline - sum(holes)

    @property
    def is_twisted(self) -> bool:
        """Whether the solid extends beyond its outline because the section rotates or shifts with height."""
        return self.part.twist is not None and self.part.twist.moves == "outline"

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of the outline, mm, or of the whole extent of a twisted part."""
        low, high = self.loops[0].box
        twist = self.part.twist
        if twist is None or not self.is_twisted:
            return low, high
        if twist.turn:
            corner = float(np.abs(self.loops[0].points).max()) * (1 + 1j)
            low, high = -corner, corner
        return low + min(twist.shift, 0.0), high + max(twist.shift, 0.0)


def shape_box(shape: Circle | Polyline) -> tuple[complex, complex]:
    """Lower left and upper right corner of a shape including its arcs, mm."""
    if isinstance(shape, Circle):
        corner = shape.radius * (1 + 1j)
        return shape.centre - corner, shape.centre + corner
    z = np.asarray(shape.vertices)
    return box_of(z if shape.bulges is None else np.append(z, _extreme_points(shape)))


def _extreme_points(shape: Polyline) -> Complex:
    """Points of arcs at which they are parallel to an axis."""
    edges = np.arange(len(shape.breaks) - 1)
    chord = shape.point(edges + 1) - shape.point(edges)
    sweep = 4 * np.arctan(np.asarray(shape.bulges))
    # The direction along an arc changes evenly, from half its sweep before the chord's direction to half after it.
    share = 0.5 + np.angle(np.outer([1, 1j, -1, -1j], chord.conj())) / np.where(sweep == 0, np.inf, sweep)
    axis, edge = np.nonzero((0 < share) & (share < 1) & (sweep != 0))
    return shape.point(edge + share[axis, edge])


def decimals(tolerance: float) -> int:
    """Decimals of mm in files: a ten-thousandth of the tolerance.

    With fewer the rounding would show; with more the last bits of a processor's sine would reach the file, and a recipe
    would not give the same bytes everywhere.
    """
    return max(0, 4 - int(np.floor(np.log10(tolerance))))


def cut(part: Part, tolerance: float, kerf: float = 0.0, arcs: bool = False, number: int = 0) -> Cut:
    """The loops of a part within `tolerance`, mm, of its curves, moved by half the `kerf` away from the material.

    With `arcs`, polylines keep arcs unless trimming for the kerf leaves chords. Marks are always chords and not moved
    by the kerf. A `number` other than 0 engraves the part's name, or the number if the name does not fit.
    """
    check_scale(part, tolerance)
    outline = _loop(part.outline, part.layer, kerf / 2, tolerance, arcs, part.name)
    holes = [_loop(h, "HOLE", -kerf / 2, tolerance, arcs, part.name) for h in part.holes]
    _check_holes(part, outline, holes, tolerance)
    label, strokes = lettered(part, number) if number else ("", ())
    letters = (Loop(Polyline(line, is_closed=False), line, "LABEL") for line in strokes)
    return Cut(part, (outline, *holes), (*_marks(part, tolerance), *letters), decimals(tolerance), tolerance, label)


def _check_holes(part: Part, outline: Loop, holes: list[Loop], tolerance: float) -> None:
    """Holes must be inside the outline and apart from each other."""
    inside = region.apart_inside(outline.points, [hole.points for hole in holes], tolerance)
    meeting = region.overlapping([hole.points for hole in holes])[:, 1]
    outside = int(np.argmin(inside)) if not inside.all() else len(holes)
    if outside < len(holes) and outside <= meeting.min(initial=outside):
        problem = f"hole {outside + 1} meets the outline, or comes nearer than the tolerance of {mm(tolerance):g}"
        raise DesignError(part.name, problem, "make the hole smaller or the part larger")
    if len(meeting):
        raise DesignError(part.name, "two holes meet", "move them apart or make them smaller")


def check_scale(part: Part, tolerance: float, share: float = 1.0) -> None:
    """DesignError for a part too small or too large for files, or if `share` of the tolerance is too fine for it."""
    size = extent(part.outline)
    if not 10 * tolerance < size < WIDEST:
        remedy = f"make parts between {mm(10 * tolerance):g} (ten times the tolerance) and {mm(WIDEST):g}"
        raise DesignError(part.name, f"it is about {mm(size):.3g} across", remedy, "out-of-range")
    far = abs(complex(part.outline.point(np.asarray(part.outline.breaks[0]))))
    if far > WIDEST:
        # Farther from the origin, numbers have too few digits for the corners of the part.
        problem = f"it lies about {mm(far):.3g} from the origin"
        raise DesignError(part.name, problem, f"stay within {mm(WIDEST):g}", "out-of-range")
    if tolerance * share < FINEST * size:
        problem = f"found {mm(tolerance):g} for the {part.name}, which is about {mm(size):.3g} across"
        remedy = f"give at least {mm(FINEST * size / share):up2}"
        raise DesignError("tolerance", problem, remedy, "out-of-range", rounded_up(FINEST * size / share, 2))


def _marks(part: Part, tolerance: float) -> tuple[Loop, ...]:
    """The marks; DesignError for a mark that crosses the outline, since it would be engraved next to the part."""
    if not part.marks:
        return ()
    marks, outline = [_mark(part, curve, tolerance) for curve in part.marks], flatten(part.outline, tolerance)
    for k, mark in enumerate(marks):
        # An open mark is closed by running back along itself, since a chord would change the distance.
        line = mark.points if mark.shape.closed else np.append(mark.points, mark.points[-2::-1])
        if region.gap(outline, line) == 0 or not is_inside(outline, line[0]):
            problem = f"mark {k + 1} crosses the outline"
            raise DesignError(part.name, problem, "move the mark inwards, make it smaller or the part larger")
    return tuple(marks)


def _mark(part: Part, curve: AbstractCurve, tolerance: float) -> Loop:
    digits = decimals(tolerance)
    points = rounded(flatten(curve, tolerance), digits)
    is_distinct = np.append(True, points[1:] != points[:-1])
    is_distinct[-1] &= not (curve.closed and points[-1] == points[0])
    points = points[is_distinct]
    if len(points) < (3 if curve.closed else 2):
        raise DesignError(part.name, "a mark is smaller than the resolution of files", "make it larger", "out-of-range")
    if isinstance(curve, Circle):
        circle = Circle(rounded(curve.centre, digits).item(), rounded(curve.radius, digits).item())
        return Loop(circle, points, "ENGRAVE")
    return Loop(Polyline(points, is_closed=curve.closed), points, "ENGRAVE")


def is_inside(outline: Complex, place: complex) -> bool:
    """Whether a point that is not on a polygon is inside it."""
    offsets = outline - place
    return bool(abs(np.angle(np.roll(offsets, -1) / offsets).sum()) > np.pi)


def _loop(curve: AbstractCurve, layer: str, grow: float, tolerance: float, arcs: bool, name: str) -> Loop:
    digits = decimals(tolerance)
    if isinstance(curve, Circle):
        radius = curve.radius + grow
        if radius <= 0:
            problem = f"found {mm(-2 * grow):g}, wider than a hole of the {name}"
            raise DesignError("kerf", problem, "give a smaller kerf")
        if round(radius, digits) <= 0:
            problem = f"a hole {mm(2 * radius):.3g} wide is smaller than the resolution of files"
            raise DesignError(name, problem, "make it larger", "out-of-range")
        circle = Circle(rounded(curve.centre, digits).item(), rounded(radius, digits).item())
        return Loop(circle, _rounded_loop(flatten(circle, tolerance), digits), layer)
    sense = float(np.sign(measure.signed_area(curve, 1e-3)))
    moved = parallel(curve, grow * sense)
    points = flatten(moved, tolerance) if moved else np.empty(0, dtype=complex)
    # A slot narrower than the beam leaves a loop of the opposite sense.
    is_reversed = polygon_area(points) * sense <= 0
    points = _rounded_loop(points, digits)
    if grow and (is_reversed or not region.is_simple(points)):
        # The parallel curve crosses itself or does not exist. It is trimmed as a polygon.
        moved, points = None, _rounded_loop(_grown(flatten(curve, tolerance / 2), grow, tolerance / 2, name), digits)
    if len(points) < 3:
        raise DesignError(name, "a contour is smaller than the resolution of files", "make it larger", "out-of-range")
    if not region.is_simple(points):
        raise DesignError(name, "the outline crosses itself", "change the sizes that make it overlap")
    shape = _rounded_arcs(to_arcs(moved, tolerance), tolerance) if arcs and moved else Polyline(points)
    return Loop(shape, points, layer)


def _rounded_arcs(exact: Polyline, tolerance: float) -> Polyline:
    """Counterclockwise vertices and bulges with the file's digits; arcs flat to the last decimal are straight."""
    digits = decimals(tolerance)
    z = rounded(exact.vertices, digits)
    bulges = np.zeros(len(z)) if exact.bulges is None else np.asarray(exact.bulges)
    # Arcs that the file's digits reduce to a point are left out, since they have no direction.
    is_visible = np.abs(np.roll(z, -1) - z) > tolerance / 100
    z, bulges = z[is_visible], bulges[is_visible]
    flat = np.abs(bulges * (np.roll(z, -1) - z)) < 10.0**-digits
    # Twelve decimals of a bulge are more precise than the last decimal of any vertex.
    bulges = np.where(flat, 0.0, np.round(bulges, 12))
    shape = Polyline(z, bulges)
    return shape if measure.signed_area(shape) > 0 else Polyline(z[::-1], 0.0 - np.roll(bulges[::-1], -1))


def _grown(points: Complex, grow: float, tolerance: float, name: str) -> Complex:
    """The polygon grown by half the kerf; DesignError if a beam of this width would change the part."""
    points = points if polygon_area(points) > 0 else points[::-1]
    regions = region.offset([points], grow, tolerance)
    whole = len(regions) == 1 and len(regions[0]) == 1
    restored = region.offset(regions[0], -grow, tolerance) if whole else []
    changed = abs(sum(polygon_area(r[0]) for r in restored) - polygon_area(points))
    # The unavoidable rounding of sharp inner corners is far smaller than this.
    if not whole or changed > 8 * tolerance * np.abs(np.diff(points)).sum():
        problem = f"found {mm(2 * abs(grow)):g}, wider than a gap or a neck of the {name}"
        raise DesignError("kerf", problem, "give a smaller kerf or a larger part")
    return regions[0][0]


def _rounded_loop(z: Complex, digits: int) -> Complex:
    """The points rounded, without repeats, counterclockwise."""
    if not len(z):
        return z
    z = rounded(z, digits)
    z = z[z != np.roll(z, 1)]
    return z if polygon_area(z) >= 0 else z[::-1]


def polygon_area(z: Complex) -> float:
    """Area of a polygon, mm2, positive when counterclockwise."""
    about = z - z[:1]
    return float(0.5 * np.imag(np.conj(about) * np.roll(about, -1)).sum())
