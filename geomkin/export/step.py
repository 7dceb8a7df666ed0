"""Parts as exact solids in STEP: planes, cylinders and B-spline surfaces, also along the helix of twisted teeth."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..core.version import __version__
from ..model.part import Part, Twist
from ..plane.approximation import SmoothPiece, smooth_pieces
from ..plane.vec import Complex, Real, rounded
from .cut import Cut, decimals
from .job import Job
from .mesh import solid_cut
from .still import in_place, rgb

# Decimals, mm, of computed centres, radii and control points. With fewer, arcs miss their ends by more than programs
# tolerate; further ones differ between processors.
DIGITS = 9
# Most faces of a part: such a file has some 40 MB, and programs take minutes for more.
MOST_FACES = 20_000
# Distance below which programs may merge points, mm: above the last digit, below any tolerance.
SAME = 1e-6
# Share of the tolerance within which splines follow their curves, half of it along a helix. A larger one saves knots,
# not faces.
FINER = 0.2


def write_step(job: Job) -> dict[str, bytes]:
    """A file for each part, named after it."""
    return job.part_files("step", job.solids, lambda cut: step(cut, job.tolerance, job.stamp))


def step(cut: Cut, tolerance: float, stamp: str = "") -> bytes:
    """The part as a solid in ISO 10303-21, AP214, mm, with its lower face at z = 0, within `tolerance`, mm.

    Lines are planes, circles are cylinders, all else is cubic B-splines: a face for each flank and each root of a
    tooth. The same part and stamp give the same bytes. DesignError for more faces than programs can read.
    """
    file = _Entities(cut.part.name, stamp)
    _, shape = file.product(cut.part.name)
    representation, _ = file.solid(*_walls(cut, tolerance), cut.part.name)
    file.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{representation})")
    return file.content()


def assembly_step(job: Job) -> bytes:
    """The assembly as one file: a product for each part with its name and colour, placed, mm, z up."""
    still, placements = in_place(job)
    file, made, styled = _Entities(job.name, job.stamp), dict[Part, tuple[str, str]](), list[str]()
    whole, whole_shape = file.product(job.name)
    origin = file.placement(0j, 0.0, file.up, file.east)
    for placement in placements:
        if placement.part not in made:
            definition, shape = file.product(placement.name)
            representation, solid = file.solid(
                *_walls(solid_cut(placement.part, job.tolerance), job.tolerance), placement.name
            )
            file.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{representation})")
            styled.append(file.styled(solid, rgb(still.tint(placement.body))))
            made[placement.part] = definition, representation
    digits = decimals(job.tolerance)
    places = []
    for placement in placements:
        z, turn = rounded(placement.origin, digits).item(), rounded(placement.direction, DIGITS).item()
        places.append(file.placement(z, placement.height, file.up, file.direction(turn.real, turn.imag, 0)))
    items = ",".join([origin, *places])
    frame = file.add(f"SHAPE_REPRESENTATION('{file.name}',({items}),{file.context})")
    file.add(f"SHAPE_DEFINITION_REPRESENTATION({whole_shape},{frame})")
    for number, (placement, place) in enumerate(zip(placements, places), 1):
        definition, representation = made[placement.part]
        name = _text(placement.name)
        use = file.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{number}','{name}','',{whole},{definition},$)")
        instance = file.add(f"PRODUCT_DEFINITION_SHAPE('','',{use})")
        moved = file.add(f"ITEM_DEFINED_TRANSFORMATION('','',{origin},{place})")
        relation = file.add(
            f"(REPRESENTATION_RELATIONSHIP('','',{representation},{frame})"
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({moved})SHAPE_REPRESENTATION_RELATIONSHIP())"
        )
        file.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{instance})")
    file.add(f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({','.join(styled)}),{file.context})")
    return file.content()


def _walls(cut: Cut, tolerance: float) -> tuple[list[_Wall], Part, float]:
    """The loops of a part as smooth pieces, the part, and the tolerance of its helix, mm."""
    part = cut.part
    loops = [
        _Wall(smooth_pieces(curve, FINER * tolerance / (1 + moves), k > 0, DIGITS, moves), moves)
        for k, curve in enumerate((part.outline, *part.holes))
        for moves in [part.twist is not None and (k == 0) == (part.twist.moves == "outline")]
    ]
    if (count := sum(len(loop.pieces) for loop in loops)) > MOST_FACES:
        problem = f"the {part.name} has {count:,} faces, and a STEP file at most {MOST_FACES:,}"
        raise DesignError("tolerance", problem, "omit step in files.write", "too-much-work")
    return loops, part, FINER * tolerance / 2


@record(eq=False)
class _Wall:
    """The pieces of a loop, and whether a twist moves it."""

    pieces: list[SmoothPiece]
    is_twisted: bool


@record(eq=False)
class _Section:
    """A stretch of the height, mm, over which a loop moves evenly.

    z: both ends, mm. helix, origins, heights: control points of a cubic B-spline along it, for the rotation, a complex
    number near the unit circle, for the displacement and for the height, mm; its inner knots are double.
    """

    z: tuple[float, float]
    helix: Complex
    origins: Complex
    heights: Real


def _sections(part: Part, radius: float, tolerance: float) -> list[_Section]:
    """The sections of a twisted part whose moving loop is within a radius, mm, about its axis.

    The cubic along the helix has the values and slopes of the rotation at its knots, so that its error is at most the
    fourth power of the rotation between two knots / 384, times the radius (Hermite interpolation).
    """
    twist, height = part.twist or Twist(), part.thickness
    spans = [(0.0, 0.5), (0.5, 1.0)] if twist.herringbone else [(0.0, 1.0)]
    count = max(1, int(np.ceil(abs(twist.turn) / (384 * tolerance / radius) ** 0.25)))
    shares = np.array([0.0, *(k + third for k in range(count) for third in (1 / 3, 2 / 3)), count]) / count
    sections = []
    for low, high in spans:
        progress = np.linspace(0, 1, count + 1) if low == 0 else np.linspace(1, 0, count + 1)
        turns = np.exp(1j * twist.turn * progress)
        slope = 1j * twist.turn * (progress[-1] - progress[0]) / (3 * count)
        inner = np.stack([turns[:-1] * (1 + slope), turns[1:] * (1 - slope)], axis=1).ravel()
        helix = np.concatenate([turns[:1], inner, turns[-1:]])
        origins = twist.shift * (progress[0] + (progress[-1] - progress[0]) * shares) + 0j
        z = low * height, high * height
        sections.append(_Section(z, helix, origins, z[0] + (z[1] - z[0]) * shares))
    return sections


class _Entities:
    """The lines of a file, each an entity with a number by which others refer to it."""

    def __init__(self, name: str, stamp: str) -> None:
        self.name, self.about = _text(name), stamp or "a part, in mm"
        self.numbers: dict[str, str] = {}
        self.lines: list[str] = []
        self._context()
        self.up, self.east = self.direction(0, 0, 1), self.direction(1, 0, 0)

    def add(self, entity: str) -> str:
        """The entity's number; an entity of the same product that exists already, such as a point, keeps its number."""
        if entity not in self.numbers:
            self.numbers[entity] = f"#{len(self.lines) + 1}"
            self.lines.append(f"{self.numbers[entity]}={entity};")
        return self.numbers[entity]

    def content(self) -> bytes:
        """The complete file."""
        return "\n".join([*self._header(), "DATA;", *self.lines, "ENDSEC;", "END-ISO-10303-21;\n"]).encode("ascii")

    def solid(self, loops: Sequence[_Wall], part: Part, tolerance: float, name: str) -> tuple[str, str]:
        """The representation and the solid of a part; tolerance: of its helix, mm. Solids share no faces."""
        name = _text(name)
        self.numbers = {}
        straight = [_Section((0.0, part.thickness), np.ones(2) + 0j, np.zeros(2) + 0j, np.array([0.0, part.thickness]))]
        walls: list[str] = []
        lids: tuple[list[str], list[str]] = ([], [])
        for number, loop in enumerate(loops):
            radius = max(float(np.abs([piece.start, *piece.controls]).max()) for piece in loop.pieces)
            sections = _sections(part, radius, tolerance) if loop.is_twisted else straight
            sides, *rings = self._loop(loop, sections)
            walls += sides
            bound = "FACE_BOUND" if number else "FACE_OUTER_BOUND"
            for lid, ring in zip(lids, rings):
                lid.append(self.add(f"{bound}('',{ring},.T.)"))
        down = self.direction(0, 0, -1)
        for lid, z, normal in zip(lids, (0.0, part.thickness), (down, self.up)):
            plane = self.add(f"PLANE('',{self.placement(0j, z, normal, self.east)})")
            walls.append(self.add(f"ADVANCED_FACE('',({','.join(lid)}),{plane},.T.)"))
        shell = self.add(f"CLOSED_SHELL('',({','.join(walls)}))")
        solid = self.add(f"MANIFOLD_SOLID_BREP('{name}',{shell})")
        origin = self.placement(0j, 0.0, self.up, self.east)
        shape = self.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('{name}',({origin},{solid}),{self.context})")
        return shape, solid

    def styled(self, solid: str, rgb: tuple[int, int, int]) -> str:
        """The colour of a solid."""
        shares = ",".join(_n(channel / 255, 4) for channel in rgb)
        colour = self.add(f"COLOUR_RGB('',{shares})")
        fill = self.add(f"FILL_AREA_STYLE_COLOUR('',{colour})")
        area = self.add(f"FILL_AREA_STYLE('',({fill}))")
        covered = self.add(f"SURFACE_STYLE_FILL_AREA({area})")
        side = self.add(f"SURFACE_SIDE_STYLE('',({covered}))")
        use = self.add(f"SURFACE_STYLE_USAGE(.BOTH.,{side})")
        style = self.add(f"PRESENTATION_STYLE_ASSIGNMENT(({use}))")
        return self.add(f"STYLED_ITEM('',({style}),{solid})")

    def _header(self) -> Iterator[str]:
        yield "ISO-10303-21;"
        yield "HEADER;"
        yield f"FILE_DESCRIPTION(('{self.about}'),'2;1');"
        # A fixed date, so that the same part gives the same bytes.
        yield f"FILE_NAME('{self.name}','1970-01-01T00:00:00',(''),(''),'geomkin {__version__}','geomkin','');"
        yield "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));"
        yield "ENDSEC;"

    def product(self, name: str) -> tuple[str, str]:
        """A product: its definition and the definition of its shape."""
        name = _text(name)
        product = self.add(f"PRODUCT('{name}','{name}','',({self.field}))")
        self.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))")
        version = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        definition = self.add(f"PRODUCT_DEFINITION('design','',{version},{self.view})")
        return definition, self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")

    def _context(self) -> None:
        """Entities that all products share, among them the context with its units."""
        use = self.add("APPLICATION_CONTEXT('automotive design')")
        self.add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{use})")
        self.field = self.add(f"PRODUCT_CONTEXT('',{use},'mechanical')")
        self.view = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{use},'design')")
        length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        same = self.add(
            f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({_n(SAME)}),{length},'distance_accuracy_value','')"
        )
        self.context = self.add(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({same}))"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid}))REPRESENTATION_CONTEXT('',''))"
        )

    def _loop(self, loop: _Wall, sections: Sequence[_Section]) -> tuple[list[str], str, str]:
        """The walls along a loop, and its ring of edges in the directions of the lower and of the upper face."""
        walls: list[str] = []
        rims = [self._rim(loop, sections[0], 0), *(self._rim(loop, section, -1) for section in sections)]
        for section, low, high in zip(sections, rims, rims[1:]):
            posts = [self._post(piece.start, section, loop.is_twisted) for piece in loop.pieces]
            for k, piece in enumerate(loop.pieces):
                after = (k + 1) % len(posts)
                end = loop.pieces[after].start
                surface, outward = self._surface(piece, end, section, loop.is_twisted)
                ring = [(low[k], True), (posts[after], True), (high[k], False), (posts[k], False)]
                bound = self.add(f"FACE_OUTER_BOUND('',{self._ring(ring)},.T.)")
                walls.append(self.add(f"ADVANCED_FACE('',({bound}),{surface},{_yes(outward)})"))
        lower = self._ring([(edge, False) for edge in rims[0][::-1]])
        return walls, lower, self._ring([(edge, True) for edge in rims[-1]])

    def _rim(self, loop: _Wall, section: _Section, end: int) -> list[str]:
        """The edges of a loop at one end of a section."""
        level, turn, origin = section.z[end], complex(section.helix[end]), complex(section.origins[end])
        starts = [piece.start * turn + origin for piece in loop.pieces]
        corners = [self.add(f"VERTEX_POINT('',{self._point(z, level)})") for z in starts]
        edges = []
        for k, piece in enumerate(loop.pieces):
            after = (k + 1) % len(corners)
            if len(piece.controls):
                points = [self._point(complex(z), level) for z in piece.controls * turn + origin]
                curve = self._spline(points, piece.knots)
            else:
                curve = self._simple_curve(starts[k], starts[after], piece.bulge, level)
            edges.append(self.add(f"EDGE_CURVE('',{corners[k]},{corners[after]},{curve},.T.)"))
        return edges

    def _post(self, z: complex, section: _Section, is_twisted: bool) -> str:
        """The edge along a corner of the section."""
        places = z * section.helix + section.origins
        points = [self._point(complex(place), height) for place, height in zip(places, section.heights)]
        low, high = (self.add(f"VERTEX_POINT('',{point})") for point in (points[0], points[-1]))
        curve = self._spline(points, self._helix_knots(section)) if is_twisted else self._line(z, section.z[0], self.up)
        return self.add(f"EDGE_CURVE('',{low},{high},{curve},.T.)")

    @staticmethod
    def _helix_knots(section: _Section) -> Real:
        return np.linspace(*section.z, len(section.heights) // 2)

    def _surface(self, piece: SmoothPiece, end: complex, section: _Section, is_twisted: bool) -> tuple[str, bool]:
        """The surface over a piece, and whether its normal points out of the material."""
        if is_twisted:
            rows = []
            for control in piece.controls:
                places = control * section.helix + section.origins
                points = (self._point(complex(place), height) for place, height in zip(places, section.heights))
                rows.append(f"({','.join(points)})")
            (times, knots), (heights, levels) = _knots(piece.knots), _knots(self._helix_knots(section))
            net = ",".join(rows)
            form = ".UNSPECIFIED.,.F.,.F.,.F."
            bounds = f"({times}),({heights}),({knots}),({levels}),.UNSPECIFIED."
            return self.add(f"B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({net}),{form},{bounds})"), True
        if len(piece.controls):
            curve = self._spline([self._point(complex(z), 0.0) for z in piece.controls], piece.knots)
            vector = self.add(f"VECTOR('',{self.up},1.)")
            return self.add(f"SURFACE_OF_LINEAR_EXTRUSION('',{curve},{vector})"), True
        if piece.bulge == 0:
            along = (end - piece.start) / abs(end - piece.start)
            normal = self.direction(along.imag, -along.real, 0)
            east = self.direction(along.real, along.imag, 0)
            return self.add(f"PLANE('',{self.placement(piece.start, 0.0, normal, east)})"), True
        centre, radius = _circle(piece.start, end, piece.bulge)
        place = self.placement(centre, 0.0, self.up, self.east)
        return self.add(f"CYLINDRICAL_SURFACE('',{place},{_n(radius)})"), piece.bulge > 0

    def _simple_curve(self, start: complex, end: complex, bulge: float, level: float) -> str:
        """The line or circle between two points."""
        if bulge == 0:
            along = (end - start) / abs(end - start)
            return self._line(start, level, self.direction(along.real, along.imag, 0))
        centre, radius = _circle(start, end, bulge)
        # A clockwise arc has an axis that points down.
        axis = self.up if bulge > 0 else self.direction(0, 0, -1)
        return self.add(f"CIRCLE('',{self.placement(centre, level, axis, self.east)},{_n(radius)})")

    def _spline(self, points: Sequence[str], knots: Real) -> str:
        times, values = _knots(knots)
        form = ".UNSPECIFIED.,.F.,.F."
        return self.add(
            f"B_SPLINE_CURVE_WITH_KNOTS('',3,({','.join(points)}),{form},({times}),({values}),.UNSPECIFIED.)"
        )

    def _ring(self, edges: Iterable[tuple[str, bool]]) -> str:
        oriented = [self.add(f"ORIENTED_EDGE('',*,*,{edge},{_yes(forward)})") for edge, forward in edges]
        return self.add(f"EDGE_LOOP('',({','.join(oriented)}))")

    def _line(self, through: complex, level: float, direction: str) -> str:
        vector = self.add(f"VECTOR('',{direction},1.)")
        return self.add(f"LINE('',{self._point(through, level)},{vector})")

    def placement(self, z: complex, level: float, axis: str, across: str) -> str:
        return self.add(f"AXIS2_PLACEMENT_3D('',{self._point(z, level)},{axis},{across})")

    def _point(self, z: complex, level: float) -> str:
        return self.add(f"CARTESIAN_POINT('',({_n(z.real)},{_n(z.imag)},{_n(level)}))")

    def direction(self, x: float, y: float, z: float) -> str:
        return self.add(f"DIRECTION('',({_n(x, 15)},{_n(y, 15)},{_n(z, 15)}))")


def _circle(start: complex, end: complex, bulge: float) -> tuple[complex, float]:
    """Centre and radius of an arc, mm."""
    centre = (start + end) / 2 + 1j * (end - start) * (1 - bulge**2) / (4 * bulge)
    return centre, abs(end - start) * (1 + bulge**2) / (4 * abs(bulge))


def _knots(knots: Real) -> tuple[str, str]:
    """Multiplicities and values of the knots of a cubic whose inner knots are double."""
    return ",".join(map(str, [4, *[2] * (len(knots) - 2), 4])), ",".join(map(_n, knots.tolist()))


def _yes(true: bool) -> str:
    return ".T." if true else ".F."


def _n(value: float, digits: int = DIGITS) -> str:
    """A number in the format, always with a decimal point."""
    text = repr(round(float(value), digits) + 0.0)
    mantissa, _, exponent = text.partition("e")
    mantissa += "" if "." in mantissa else "."
    return f"{mantissa}E{int(exponent)}" if exponent else mantissa


def _text(name: str) -> str:
    """A name in the format, with letters beyond ASCII as code numbers."""
    return "".join(c if c.isascii() else f"\\X4\\{ord(c):08X}\\X0\\" for c in name)
