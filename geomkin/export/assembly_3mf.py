"""3MF of the assembly: parts in place, each an object by its name, together one thing that programs keep together."""

from __future__ import annotations

from html import escape

import numpy as np

from ..plane.vec import Complex, Real, Whole, rounded
from .cut import decimals
from .in_place import InPlace, in_place
from .job import Job
from .solid import solid
from .threemf import mesh_object, package
from .twisted import solid_cut

# Decimals of a direction: a ten-thousandth of a mm on a part of ten metres. More would be digits in which processors
# differ.
TURN = 9


def write(job: Job) -> dict[str, bytes]:
    """One file, named after the recipe."""
    return {f"{job.name}-assembly.3mf": assembly(job)}


def assembly(job: Job) -> bytes:
    """The parts where they stand, mm, z up, moved as one to where no coordinate is negative, as printers want it."""
    _, placed = in_place(job)
    meshes = [solid(solid_cut(one.part, job.tolerance)) for one in placed]
    objects = [mesh_object(k, one.name, mesh) for k, (one, mesh) in enumerate(zip(placed, meshes), 1)]
    parts = "".join(
        f'<component objectid="{k}" transform="{_matrix(one, decimals(job.tolerance))}"/>'
        for k, one in enumerate(placed, 1)
    )
    whole = len(placed) + 1
    objects.append(
        f'<object id="{whole}" name="{escape(job.name)}" type="model"><components>{parts}</components></object>'
    )
    corner = _corner(placed, meshes)
    place = f"1 0 0 0 1 0 0 0 1 {0 - corner.real:.9g} {0 - corner.imag:.9g} 0"
    return package(objects, [f'<item objectid="{whole}" transform="{place}"/>'])


def _corner(placed: tuple[InPlace, ...], meshes: list[tuple[Real, Whole]]) -> complex:
    """Lower left corner of all, mm, down to a hundredth."""
    seen: Complex = np.concatenate(
        [one.origin + one.direction * (points[:, 0] + 1j * points[:, 1]) for one, (points, _) in zip(placed, meshes)]
    )
    # A hair of room, so that the last bit of a processor decides nothing.
    down = np.floor(100 * np.array([seen.real.min(), seen.imag.min()]) - 1e-3) / 100
    return complex(*down)


def _matrix(one: InPlace, digits: int) -> str:
    """From the part's frame to the assembly's, as the format has it: rows, which a point times gives the place."""
    ahead, origin = rounded(one.direction, TURN).item(), rounded(one.origin, digits).item()
    turn = f"{ahead.real:.10g} {ahead.imag:.10g} 0 {-ahead.imag + 0.0:.10g} {ahead.real:.10g} 0 0 0 1"
    return f"{turn} {origin.real:.12g} {origin.imag:.12g} {one.height:.9g}"
