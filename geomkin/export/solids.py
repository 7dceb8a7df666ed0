"""Plates as solids: STL, exact ones as STEP, 3MF for printing, and the assembly as GLB, for which it loads trimesh."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Iterator, Sequence
from html import escape

import numpy as np

from ..core.errors import DesignError
from ..core.progress import report
from ..core.units import LengthUnit
from ..core.version import __version__
from ..plane.primitives import Circle
from ..plane.vec import Complex, Real, Whole, rounded
from .cut import Cut, Loop, decimals
from .job import Job
from .layout import lay_out
from .mesh import solid, solid_cut, triangles
from .still import InPlace, in_place, rgb

# A triangle in the format: single-precision numbers, then two unused bytes.
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER = 80
# Size in bytes from which a file is announced before it is written, since it takes seconds.
LARGE = 10_000_000


def write_stl(job: Job) -> dict[str, bytes]:
    """One file per part, named after it; the progress of large ones is reported."""

    def write(cut: Cut) -> bytes:
        size = HEADER + 4 + TRIANGLE.itemsize * triangles(cut)
        if size < LARGE:
            return stl(cut, job.stamp)
        name = f"{cut.part.name}.stl"
        report(0.0, f"{name}, about {size / 1e6:.0f} MB")
        content = stl(cut, job.stamp)
        report(1.0, name)
        return content

    return job.part_files("stl", job.solids, write)


def stl(cut: Cut, stamp: str = "") -> bytes:
    """The part as a binary STL, mm, with its lower face at z = 0 and the stamp in the file's header."""
    points, faces = solid(cut)
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1])
    records = np.zeros(len(corners), dtype=TRIANGLE)
    records["normal"], records["corners"] = normals / np.sqrt(np.vecdot(normals, normals))[:, None], corners
    header = stamp.encode("ascii", "replace").ljust(HEADER, b"\0")[:HEADER] + len(records).to_bytes(4, "little")
    return header + records.tobytes()


TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" \
ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" \
ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"""
LINKS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship \
Target="/3D/3dmodel.model" Id="model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>\
</Relationships>
"""
HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="{unit}" xml:lang="en" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
"""


# Names of units of length in the format.
NAMES = {"mm": "millimeter", "in": "inch"}


def threemf(job: Job) -> bytes:
    """The parts as a 3MF package; the same parts give the same bytes."""
    sheet, items, unit = lay_out(job.solids), [], job.unit
    objects = [mesh_object(number, cut.part.name, solid(cut), unit) for number, cut in enumerate(job.solids, 1)]
    numbers = {id(cut): number for number, cut in enumerate(job.solids, 1)}
    for placed in sheet.placed:
        turn, shift = placed.turn, unit.of(placed.shift)
        # Adding 0 removes the sign of a negative zero.
        rows = (turn.real, turn.imag, 0, -turn.imag, turn.real, 0, 0, 0, 1, shift.real, shift.imag, 0)
        place = " ".join(f"{0.0 + value:.9g}" for value in rows)
        items.append(f'<item objectid="{numbers[id(placed.cut)]}" transform="{place}"/>')
    return package(objects, items, job.stamp, unit)


def mesh_object(number: int, name: str, mesh: tuple[Real, Whole], unit: LengthUnit) -> str:
    """An object of a model with its number, name, corners (mm) and triangles, in this unit."""
    points, faces = mesh
    return f'<object id="{number}" name="{escape(name)}" type="model">{_mesh(unit.of(points), faces)}</object>'


def package(objects: Sequence[str], items: Sequence[str], stamp: str, unit: LengthUnit) -> bytes:
    """A 3MF file of objects and the build items that refer to them; the stamp is its description."""
    head = HEAD.format(unit=NAMES[unit.name])
    about = [f'<metadata name="Description">{escape(stamp)}</metadata>'] if stamp else []
    inside = "\n".join([*about, "<resources>", *objects, "</resources>", "<build>", *items, "</build>", "</model>", ""])
    stream = io.BytesIO()
    # Stored, not compressed, since compressed bytes depend on the library.
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as package:
        for file, text in (("[Content_Types].xml", TYPES), ("_rels/.rels", LINKS), ("3D/3dmodel.model", head + inside)):
            # A fixed date, so that the same parts give the same bytes.
            package.writestr(zipfile.ZipInfo(file, (1980, 1, 1, 0, 0, 0)), text)
    return stream.getvalue()


def _mesh(points: Real, faces: Whole) -> str:
    # Nine digits distinguish all single-precision numbers, and are a twentieth of the finest tolerance off in any unit.
    corners = "".join(f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>' for x, y, z in points.tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces.tolist())
    return f"<mesh><vertices>{corners}</vertices><triangles>{triangles}</triangles></mesh>"


# Decimals of a direction: a ten-thousandth of a mm on a part of ten metres. Further digits differ between
# processors.
TURN = 9


def assembly_package(job: Job) -> bytes:
    """The assembled parts, mm, z up, moved as one so that no coordinate is negative, as slicers expect."""
    _, placed = in_place(job)
    meshes = [solid(solid_cut(placement.part, job.tolerance)) for placement in placed]
    unit = job.unit
    objects = [mesh_object(k, one.name, mesh, unit) for k, (one, mesh) in enumerate(zip(placed, meshes), 1)]
    parts = "".join(
        f'<component objectid="{k}" transform="{_matrix(placement, decimals(job.tolerance), unit)}"/>'
        for k, placement in enumerate(placed, 1)
    )
    whole = len(placed) + 1
    objects.append(
        f'<object id="{whole}" name="{escape(job.name)}" type="model"><components>{parts}</components></object>'
    )
    corner = unit.of(_corner(placed, meshes))
    place = f"1 0 0 0 1 0 0 0 1 {0 - corner.real:.9g} {0 - corner.imag:.9g} 0"
    return package(objects, [f'<item objectid="{whole}" transform="{place}"/>'], job.stamp, unit)


def _corner(placed: tuple[InPlace, ...], meshes: list[tuple[Real, Whole]]) -> complex:
    """Lower left corner of all parts, mm, rounded down to a hundredth."""
    seen: Complex = np.concatenate(
        [
            placement.origin + placement.direction * (points[:, 0] + 1j * points[:, 1])
            for placement, (points, _) in zip(placed, meshes)
        ]
    )
    # A small margin, so that the last bit of a processor does not change the result.
    down = np.floor(100 * np.array([seen.real.min(), seen.imag.min()]) - 1e-3) / 100
    return complex(*down)


def _matrix(placement: InPlace, digits: int, unit: LengthUnit) -> str:
    """Transform from the part's frame to the assembly's, in the format's row order."""
    direction, origin = rounded(placement.direction, TURN).item(), rounded(placement.origin, digits).item()
    turn = f"{direction.real:.10g} {direction.imag:.10g} 0 {-direction.imag + 0.0:.10g} {direction.real:.10g} 0 0 0 1"
    origin, height = unit.of(origin), unit.of(placement.height)
    return f"{turn} {origin.real:.12g} {origin.imag:.12g} {height:.9g}"


# From mm, z up, to the format's metres, y up.
UPRIGHT = 1e-3 * np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1e3]])


def glb(job: Job) -> bytes:
    """The assembly: a node for each part, with its name, in the colour of its body on pages."""
    import trimesh

    still, placements = in_place(job)
    assembly = trimesh.Scene(base_frame="assembly", metadata={"stamp": job.stamp} if job.stamp else None)
    for placement in placements:
        points, faces = solid(solid_cut(placement.part, job.tolerance))
        colour = np.array([*rgb(still.tint(placement.body)), 255], dtype=np.uint8)
        mesh = trimesh.Trimesh(points, faces, vertex_colors=np.tile(colour, (len(points), 1)), process=False)
        assembly.add_geometry(
            mesh, node_name=placement.name, geom_name=placement.name, transform=UPRIGHT @ _place(placement)
        )
    return bytes(trimesh.exchange.gltf.export_glb(assembly))  # type: ignore[no-untyped-call]


def _place(placement: InPlace) -> Real:
    """Transform from the part's frame to the assembly's, mm."""
    direction, origin = placement.direction, placement.origin
    return np.array(
        [
            [direction.real, -direction.imag, 0, origin.real],
            [direction.imag, direction.real, 0, origin.imag],
            [0, 0, 1, placement.height],
            [0, 0, 0, 1.0],
        ]
    )


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
