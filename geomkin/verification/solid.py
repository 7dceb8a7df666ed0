"""Solids of files as triangle meshes: closed, of the right volume, and with the right sections."""

from __future__ import annotations

import numpy as np

from ..core.records import record
from ..model.part import Part
from ..plane.vec import Complex, Real, Whole
from .matching import Shape
from .outline import Outline

# Heights of sections, as shares of a slice: next to both ends, where a wrong corner is visible, and in the middle.
CUTS = (1e-3, 0.5, 1 - 1e-3)
# Largest number of slices of a twisted part with sections, spread over its height.
MOST_SLICES = 6
# Relative size of rounding in single precision, in which meshes are stored.
SINGLE = 2.0**-23


@record(eq=False)
class Mesh:
    """A mesh of a file: its name, corners (n, 3), mm, and triangles (m, 3) as indices of corners."""

    name: str
    corners: Real
    faces: Whole

    @property
    def rounding(self) -> float:
        """Largest rounding of a coordinate, mm."""
        return SINGLE * float(np.abs(self.corners).max(initial=1e-9))

    @property
    def volume(self) -> float:
        """mm3, by the divergence theorem."""
        a, b, c = (self.corners - self.corners[0])[self.faces].swapaxes(0, 1)
        return float(np.vecdot(np.cross(a, b), c).sum() / 6)

    @property
    def is_closed(self) -> bool:
        """Whether each edge belongs to two triangles that run along it in opposite directions."""
        start, end = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        n = len(self.corners)
        there, back = np.sort(start * n + end), np.sort(end * n + start)
        return bool((there == back).all() and (there[1:] != there[:-1]).all() and (start != end).all())


def merged(triangles: Real) -> tuple[Real, Whole]:
    """Distinct corners (n, 3) and triangles by their indices, from the corners (m, 3, 3) of each triangle."""
    corners, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    return corners, index.reshape(-1, 3)


def cross_section(mesh: Mesh, height: float) -> list[Outline] | None:
    """The loops in which a plane of constant z cuts a mesh, material on their left; None if they are not closed.

    No corner may be in the plane.
    """
    z = mesh.corners[:, 2] > height
    crossing = mesh.faces[z[mesh.faces].any(axis=1) & ~z[mesh.faces].all(axis=1)]
    if not len(crossing):
        return None
    after = np.roll(crossing, -1, axis=1)
    rises, falls = ~z[crossing] & z[after], z[crossing] & ~z[after]
    # Seen from outside, a triangle is cut from its falling to its rising edge.
    (up_low, up_high), (down_high, down_low) = (crossing[rises], after[rises]), (crossing[falls], after[falls])
    n = len(mesh.corners)
    following = dict(zip((down_low * n + down_high).tolist(), (up_low * n + up_high).tolist()))
    if len(following) < len(crossing):
        return None
    loops: list[Outline] = []
    while following:
        first, key = next(iter(following.items()))
        del following[first]
        keys = [first]
        while key != first:
            keys.append(key)
            if key not in following:
                return None
            key = following.pop(key)
        low, high = np.divmod(np.array(keys), n)
        a, b = mesh.corners[low], mesh.corners[high]
        share = ((height - a[:, 2]) / (b[:, 2] - a[:, 2]))[:, None]
        points = (a + share * (b - a))[:, :2]
        loops.append(Outline(np.ascontiguousarray(points).view(complex)[:, 0]))
    return loops


def section_heights(mesh: Mesh, part: Part) -> list[float]:
    """Heights, mm, at which the sections of a mesh are compared with the part's."""
    levels = np.unique(np.round(mesh.corners[:, 2], 6)) if part.twist else np.array([0.0, part.thickness])
    chosen = np.unique(np.linspace(0, len(levels) - 2, min(MOST_SLICES, len(levels) - 1)).astype(int))
    return [float(levels[k] + share * (levels[k + 1] - levels[k])) for k in chosen for share in CUTS]


def as_plate(loops: list[Outline], part: Part, share: float) -> Shape | None:
    """The section of a solid with its twist undone, as a plate; None if it is not a single plate."""
    outer = [loop for loop in loops if loop.area > 0]
    if len(outer) != 1:
        return None
    holes = [loop for loop in loops if loop.area <= 0]
    if part.twist is None:
        return Shape(outer[0], tuple(holes))
    pose = part.twist.at(share)

    def untwisted(loop: Outline) -> Outline:
        points: Complex = (loop.points - pose.origin) / pose.direction
        return Outline(points, loop.error)

    if part.twist.moves == "outline":
        return Shape(untwisted(outer[0]), tuple(holes))
    return Shape(outer[0], tuple(map(untwisted, holes)))
