"""3MF for 3D printing: all copies of all parts, flat and apart, or the assembly."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from html import escape

import numpy as np

from ..core.units import LengthUnit
from ..plane.vec import Complex, Real, Whole, rounded
from .cut import decimals
from .job import Job
from .layout import lay_out
from .mesh import solid, solid_cut
from .still import InPlace, in_place

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
