"""STEP: plates as exact solids with planes and cylinders, not facets."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from ..core.errors import DesignError
from ..core.version import __version__
from ..plane.primitives import Circle
from .cut import Cut, Loop
from .job import Job

# Decimals, mm, of computed centres and radii. With fewer, arcs miss their ends by more than programs tolerate; further
# ones differ between processors.
DIGITS = 9
# Most edges of an outline and its holes: such a file has some 40 MB, and programs take minutes for more.
MOST_EDGES = 50_000
# Distance below which programs may merge points, mm: above the last digit, below any tolerance.
SAME = 1e-6

# An edge of a loop with the material on its left: its start, and the tangent of a quarter of the arc's sweep, 0 for a
# straight edge.
Edge = tuple[complex, float]


def write_step(job: Job) -> dict[str, bytes]:
    """A file for each part, named after it."""
    return job.part_files("step", job.exact, lambda cut: step(cut, job.stamp))


def step(cut: Cut, stamp: str = "") -> bytes:
    """The part as a solid in ISO 10303-21, AP214, mm, with its lower face at z = 0.

    The same loops and stamp give the same bytes. DesignError for helical teeth, and for more edges than programs can
    read.
    """
    if cut.part.twist:
        raise DesignError(
            "write",
            f"found step for the {cut.part.name}: planes and cylinders cannot represent helical teeth",
            "omit step and take stl or 3mf, or give a helix_angle_deg of 0",
            "conflict",
        )
    loops = [_edges(loop, is_hole=k > 0) for k, loop in enumerate(cut.loops)]
    if (count := sum(map(len, loops))) > MOST_EDGES:
        raise DesignError(
            "tolerance",
            f"the {cut.part.name} has {count:,} edges, and a STEP file at most {MOST_EDGES:,}",
            "give a larger tolerance, or omit step in files.write",
            "too-much-work",
        )
    return _Entities(cut.part.name, stamp).of(loops, cut.part.thickness)


def _edges(loop: Loop, is_hole: bool) -> list[Edge]:
    """Edges of a cut, directed so that the material is on the left."""
    shape = loop.shape
    if isinstance(shape, Circle):
        # A full circle has no ends; two halves need no seam.
        ends = [shape.centre + shape.radius, shape.centre - shape.radius]
        return [(end, -1.0 if is_hole else 1.0) for end in ends]
    vertices = np.asarray(shape.vertices)
    bulges = np.zeros(len(vertices)) if shape.bulges is None else np.asarray(shape.bulges)
    if is_hole:
        vertices, bulges = vertices[::-1], -np.roll(bulges[::-1], -1)
    return list(zip(vertices.tolist(), bulges.tolist()))


class _Entities:
    """The lines of a file, each an entity with a number by which others refer to it."""

    def __init__(self, name: str, stamp: str) -> None:
        self.name, self.about = _text(name), stamp or "a plate, in mm"
        self.numbers: dict[str, str] = {}

    def add(self, entity: str) -> str:
        """The entity's number; an entity that exists already, such as a point, keeps its number."""
        return self.numbers.setdefault(entity, f"#{len(self.numbers) + 1}")

    def of(self, loops: Iterable[list[Edge]], thickness: float) -> bytes:
        """The complete file of a plate between z = 0 and its thickness."""
        context, product = self._product()
        self.up, self.east = self._direction(0, 0, 1), self._direction(1, 0, 0)
        walls: list[str] = []
        lids: tuple[list[str], list[str]] = ([], [])
        for number, edges in enumerate(loops):
            sides, *rings = self._loop(edges, thickness)
            walls += sides
            bound = "FACE_BOUND" if number else "FACE_OUTER_BOUND"
            for lid, ring in zip(lids, rings):
                lid.append(self.add(f"{bound}('',{ring},.T.)"))
        down = self._direction(0, 0, -1)
        for lid, z, normal in zip(lids, (0.0, thickness), (down, self.up)):
            plane = self.add(f"PLANE('',{self._placement(0j, z, normal, self.east)})")
            walls.append(self.add(f"ADVANCED_FACE('',({','.join(lid)}),{plane},.T.)"))
        shell = self.add(f"CLOSED_SHELL('',({','.join(walls)}))")
        solid = self.add(f"MANIFOLD_SOLID_BREP('{self.name}',{shell})")
        origin = self._placement(0j, 0.0, self.up, self.east)
        shape = self.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('{self.name}',({origin},{solid}),{context})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({product},{shape})")
        lines = [f"{number}={entity};" for entity, number in self.numbers.items()]
        return "\n".join([*self._header(), "DATA;", *lines, "ENDSEC;", "END-ISO-10303-21;\n"]).encode("ascii")

    def _header(self) -> Iterator[str]:
        yield "ISO-10303-21;"
        yield "HEADER;"
        yield f"FILE_DESCRIPTION(('{self.about}'),'2;1');"
        # A fixed date, so that the same part gives the same bytes.
        yield f"FILE_NAME('{self.name}','1970-01-01T00:00:00',(''),(''),'geomkin {__version__}','geomkin','');"
        yield "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));"
        yield "ENDSEC;"

    def _product(self) -> tuple[str, str]:
        """Entities required before the shape: the context with its units, and the product."""
        use = self.add("APPLICATION_CONTEXT('automotive design')")
        self.add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{use})")
        field = self.add(f"PRODUCT_CONTEXT('',{use},'mechanical')")
        product = self.add(f"PRODUCT('{self.name}','{self.name}','',({field}))")
        self.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))")
        version = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        view = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{use},'design')")
        definition = self.add(f"PRODUCT_DEFINITION('design','',{version},{view})")
        length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        same = self.add(
            f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({_n(SAME)}),{length},'distance_accuracy_value','')"
        )
        context = self.add(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({same}))"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid}))REPRESENTATION_CONTEXT('',''))"
        )
        return context, self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")

    def _loop(self, edges: list[Edge], thickness: float) -> tuple[list[str], str, str]:
        """The walls along a loop, and its ring of edges in the directions of the lower and of the upper face."""
        starts = [start for start, _ in edges]
        levels = (0.0, thickness)
        corners = [[self.add(f"VERTEX_POINT('',{self._point(z, level)})") for z in starts] for level in levels]
        posts = []
        for z, low, high in zip(starts, *corners):
            line = self._line(z, 0.0, self.up)
            posts.append(self.add(f"EDGE_CURVE('',{low},{high},{line},.T.)"))
        walls: list[str] = []
        rims: tuple[list[str], list[str]] = ([], [])
        for k, (start, bulge) in enumerate(edges):
            after = (k + 1) % len(edges)
            surface, outward, curves = self._wall(start, starts[after], bulge, levels)
            for rim, corner, curve in zip(rims, corners, curves):
                rim.append(self.add(f"EDGE_CURVE('',{corner[k]},{corner[after]},{curve},.T.)"))
            ring = [(rims[0][k], True), (posts[after], True), (rims[1][k], False), (posts[k], False)]
            bound = self.add(f"FACE_OUTER_BOUND('',{self._ring(ring)},.T.)")
            walls.append(self.add(f"ADVANCED_FACE('',({bound}),{surface},{_yes(outward)})"))
        lower = self._ring([(edge, False) for edge in rims[0][::-1]])
        return walls, lower, self._ring([(edge, True) for edge in rims[1]])

    def _wall(self, start: complex, end: complex, bulge: float, levels: Iterable[float]) -> tuple[str, bool, list[str]]:
        """The surface over an edge, whether its normal points out of the material, and its curve at each level."""
        direction = (end - start) / abs(end - start)
        if bulge == 0:
            direction_number = self._direction(direction.real, direction.imag, 0)
            normal = self._direction(direction.imag, -direction.real, 0)
            surface = self.add(f"PLANE('',{self._placement(start, 0.0, normal, direction_number)})")
            return surface, True, [self._line(start, level, direction_number) for level in levels]
        centre = (start + end) / 2 + 1j * (end - start) * (1 - bulge**2) / (4 * bulge)
        radius = _n(abs(end - start) * (1 + bulge**2) / (4 * abs(bulge)))
        # A clockwise arc has an axis that points down.
        axis = self.up if bulge > 0 else self._direction(0, 0, -1)
        surface = self.add(f"CYLINDRICAL_SURFACE('',{self._placement(centre, 0.0, self.up, self.east)},{radius})")
        places = [self._placement(centre, level, axis, self.east) for level in levels]
        return surface, bulge > 0, [self.add(f"CIRCLE('',{place},{radius})") for place in places]

    def _ring(self, edges: Iterable[tuple[str, bool]]) -> str:
        oriented = [self.add(f"ORIENTED_EDGE('',*,*,{edge},{_yes(forward)})") for edge, forward in edges]
        return self.add(f"EDGE_LOOP('',({','.join(oriented)}))")

    def _line(self, through: complex, level: float, direction: str) -> str:
        vector = self.add(f"VECTOR('',{direction},1.)")
        return self.add(f"LINE('',{self._point(through, level)},{vector})")

    def _placement(self, z: complex, level: float, axis: str, across: str) -> str:
        return self.add(f"AXIS2_PLACEMENT_3D('',{self._point(z, level)},{axis},{across})")

    def _point(self, z: complex, level: float) -> str:
        return self.add(f"CARTESIAN_POINT('',({_n(z.real)},{_n(z.imag)},{_n(level)}))")

    def _direction(self, x: float, y: float, z: float) -> str:
        return self.add(f"DIRECTION('',({_n(x, 15)},{_n(y, 15)},{_n(z, 15)}))")


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
