"""The solids of a file against the exact curves of their parts: sections, corners, faces and thickness."""

from __future__ import annotations

import numpy as np

from ..core.records import record
from ..core.units import mm
from ..model.part import Part
from ..plane.vec import Complex, Real, Whole
from .comparison import CUTS, FINENESS, ExactPart, Measured, Shape, compared, edges_of, with_problems, worst_of
from .outline import EVEN, Outline

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


def section_heights(mesh: Mesh, part: Part, foot: float = 0.0) -> list[float]:
    """Heights, mm, above the chamfer at its foot, at which the sections of a mesh are compared with the part's."""
    levels = np.unique(np.round(mesh.corners[:, 2], 6)) if part.twist else np.array([foot, part.thickness])
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


def _thickness_problems(low: float, high: float, part: Part, share: float) -> list[str]:
    if max(abs(low), abs(high - part.thickness)) <= share * max(part.thickness, 1.0) + 1e-6:
        return []
    return [f"it reaches from z = {low:.6g} to {mm(high):.6g}, and the part is {mm(part.thickness):g} thick"]


def measure_mesh(mesh: Mesh, exact: ExactPart, tolerance: float) -> Measured:
    """A solid by its sections, its volume and whether it is closed."""
    part, name = exact.part, exact.part.name
    if not mesh.is_closed:
        return Measured(name, problems=("it is not watertight, or a triangle is turned inside out",))
    z = mesh.corners[:, 2]
    problems = _thickness_problems(float(z.min()), float(z.max()), part, 4 * mesh.rounding)
    foot, bed = exact.foot, exact.bed or exact.solid
    # A chamfer takes half of what its section on the bed is smaller.
    volume, expected = mesh.volume, exact.solid.area * part.thickness - foot * (exact.solid.area - bed.area) / 2
    allowed = exact.solid.length * tolerance * part.thickness + EVEN * expected
    if abs(volume - expected) > allowed:
        problems.append(
            f"its volume is {mm(volume, unit='mm3'):.7g}, and that of the part {mm(expected, unit='mm3'):.7g}"
        )
    between = np.minimum(np.minimum(abs(z), abs(z - foot)), abs(z - part.thickness))
    if not part.twist and (between > 4 * mesh.rounding).any():
        problems.append("it has corners between its two faces")
    if (off := _corners_apart(mesh, exact)) > tolerance * (1 + FINENESS) + mesh.rounding + foot * CUTS[0]:
        problems.append(f"a corner is {mm(off):.4g} off the curves of the part")
    if folded := _folded(mesh, part.thickness):
        problems.append(f"{folded} triangles of its two faces are turned over")
    worst = Measured(name, 0.0)
    sections = [(foot * CUTS[0], bed)] if foot else []
    for height, shape in [*sections, *((height, exact.solid) for height in section_heights(mesh, part, foot))]:
        loops = cross_section(mesh, height)
        plate = as_plate(loops, part, height / part.thickness) if loops else None
        if plate is None:
            problems.append(f"its section at z = {mm(height):.4g} is not one plate")
            break
        found = compared(plate, Shape(shape.outline, shape.holes), name, tolerance)
        worst = found if found.problems else worst_of([worst, found])
        if found.problems:
            break
    return with_problems(worst, problems)


def _folded(mesh: Mesh, thickness: float) -> int:
    """Number of horizontal triangles that face down on the upper face or up on the lower one, hence lie over others."""
    a, b, c = mesh.corners[mesh.faces].swapaxes(0, 1)
    least = 4 * mesh.rounding
    is_level = np.ptp(np.stack([a[:, 2], b[:, 2], c[:, 2]]), axis=0) <= least
    side = np.where(a[:, 2] > thickness / 2, 1.0, -1.0)
    # Thinner triangles may be turned over by rounding.
    longest = np.max([np.abs(edge[:, :2]).max(axis=1) for edge in (b - a, c - b, a - c)], axis=0)
    return int(np.count_nonzero(is_level & (side * np.cross(b - a, c - a)[:, 2] < -least * longest)))


def _corners_apart(mesh: Mesh, exact: ExactPart) -> float:
    """The largest distance of the corners of a solid from its curves, with a twist undone or as they are."""
    twist, points = exact.part.twist, np.ascontiguousarray(mesh.corners[:, :2]).view(complex)[:, 0]
    if twist is None:
        on_bed = mesh.corners[:, 2] < exact.foot / 2
        pairs = [((exact.bed or exact.solid).loops, points[on_bed]), (exact.solid.loops, points[~on_bed])]
        return max(float(edges_of(loops).nearest(z)[1].max(initial=0.0)) for loops, z in pairs)
    pose = twist.at(mesh.corners[:, 2] / exact.part.thickness)
    outline, holes = [exact.solid.outline], list(exact.solid.holes)
    moving, fixed = (outline, holes) if twist.moves == "outline" else (holes, outline)
    distances = [
        edges_of(loops).nearest(z)[1]
        for loops, z in ((moving, (points - pose.origin) / pose.direction), (fixed, points))
        if loops
    ]
    return float(np.min(distances, axis=0).max())
