"""Plates as solids: STL, 3MF for printing, and the assembly as GLB, for which it loads trimesh."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from html import escape

import numpy as np

from ..core.processes import report
from ..core.units import LengthUnit
from ..plane.vec import Complex, Real, Whole, rounded, xy
from .cut import Cut, decimals
from .job import Job
from .layout import Sheet, lay_out, lay_out_on
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

    return job.part_files("stl", job.printed, write)


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


def write_threemf(job: Job) -> dict[str, bytes]:
    """One file per bed, by name; names from the second bed on have its number."""
    cuts = job.printed
    beds = lay_out_on(cuts, *job.sheet, by_thickness=False) if job.sheet else (lay_out(cuts),)
    return job.sheet_files("3mf", lambda bed: threemf(bed, job), beds)


def threemf(sheet: Sheet, job: Job) -> bytes:
    """The parts on a bed as a 3MF package; the same parts give the same bytes."""
    cuts = [cut for cut in job.printed if any(placed.cut is cut for placed in sheet.placed)]
    items, unit = [], job.unit
    objects = [mesh_object(number, cut.part.name, solid(cut), unit) for number, cut in enumerate(cuts, 1)]
    numbers = {id(cut): number for number, cut in enumerate(cuts, 1)}
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
    """The assembled parts, mm, z up, moved as one so that no coordinate is negative, as slicers expect.

    Each is an object with its name, unless they are printed in place: slicers that take objects apart, or arrange them,
    would move them, so that these are one mesh.
    """
    _, placed = in_place(job)
    meshes = [solid(job.printed_cut(placement.part)) for placement in placed]
    unit = job.unit
    corner = _corner(placed, meshes)
    if job.in_place:
        whole = mesh_object(1, job.name, _joined(placed, meshes, corner), unit)
        return package([whole], ['<item objectid="1"/>'], job.stamp, unit)
    objects = [mesh_object(k, one.name, mesh, unit) for k, (one, mesh) in enumerate(zip(placed, meshes), 1)]
    parts = "".join(
        f'<component objectid="{k}" transform="{_matrix(placement, decimals(job.tolerance), unit)}"/>'
        for k, placement in enumerate(placed, 1)
    )
    number = len(placed) + 1
    objects.append(
        f'<object id="{number}" name="{escape(job.name)}" type="model"><components>{parts}</components></object>'
    )
    corner = unit.of(corner)
    place = f"1 0 0 0 1 0 0 0 1 {0 - corner.real:.9g} {0 - corner.imag:.9g} 0"
    return package(objects, [f'<item objectid="{number}" transform="{place}"/>'], job.stamp, unit)


def _joined(placed: tuple[InPlace, ...], meshes: list[tuple[Real, Whole]], corner: complex) -> tuple[Real, Whole]:
    """All parts where they stand as one mesh, with the lower left corner as its origin."""
    points = []
    for one, (corners, _) in zip(placed, meshes):
        z = one.origin - corner + rounded(one.direction, TURN) * (corners[:, 0] + 1j * corners[:, 1])
        points.append(np.column_stack([xy(z), corners[:, 2] + one.height]))
    firsts = np.cumsum([0, *map(len, points)]).tolist()
    return np.concatenate(points), np.concatenate([faces + first for (_, faces), first in zip(meshes, firsts)])


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
