"""Solids as triangle meshes, including those whose section rotates or shifts with height."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..core.errors import DesignError, GeomkinError
from ..core.fields import to_digits
from ..core.units import bare_mm, mm
from ..model.part import Part, Twist
from ..plane import region as region
from ..plane.curve import extent
from ..plane.vec import Complex, Mask, Real, Whole, dot, rounded, xy
from .cut import FINEST, Cut, check_scale, cut, polygon_area

# Most triangles of the moving loops of a part: such a file has 50 MB and is written in seconds. Programs take
# minutes to show more; a lower limit would refuse fine gears.
MOST = 1_000_000
# Ratio of successive tolerances that are tried, and their number, up to a thousand times the given one.
WIDER, TRIALS = 1.25, 31
# Share of the tolerance below which the rounding of a mesh's numbers is neglected, and that by which corners may differ
# from a straight line that replaces them. Verification allows both together.
NEGLECTED, STRAIGHT = 0.02, 0.05
# Relative difference by which a diagonal must be shorter to be chosen, so that rounding does not decide.
SHORTER = 1e-9


def rounding_error(cut_part: Cut) -> float:
    """Largest distance by which single-precision numbers, which meshes are made of, move a corner of a part, mm."""
    farthest = max(abs(side) for corner in cut_part.box for side in (corner.real, corner.imag))
    return float(np.spacing(np.float32(farthest))) / 2**0.5


def is_solid_cut(cut_part: Cut) -> bool:
    """Whether the loops of a drawing of the part's true size are those of its solid."""
    return cut_part.part.twist is None and rounding_error(cut_part) <= NEGLECTED * cut_part.tolerance


def solid_cut(part: Part, tolerance: float, growth: float = 0.0) -> Cut:
    """The loops of a solid within `tolerance`, mm; for a twisted part half of it is left for the slices.

    They are moved by half the `growth` of prints, mm, into the material.

    If the rounding of the mesh's numbers takes a share of the tolerance, the chords are finer. DesignError if it takes
    too much, moving and fixed loops could meet, or the part needs too many triangles.
    """
    share = 0.5 if part.twist else 1.0
    check_scale(part, tolerance, share)
    cut_part = cut(part, share * tolerance, -growth)
    if (error := rounding_error(cut_part)) > NEGLECTED * tolerance:
        if tolerance < (least := error + max(error, FINEST * extent(part.outline) / share)):
            raise DesignError(
                "tolerance",
                f"found {mm(tolerance):g}, but solids store the corners of the {part.name} only within {mm(error):.2g}",
                f"give at least {mm(least):up2}, or write neither stl, glb nor 3mf",
                "out-of-range",
            )
        cut_part = cut(part, share * (tolerance - error), -growth)
    if part.twist is None:
        return cut_part
    _check_apart(cut_part, part.twist)
    if (count := moving_triangles(cut_part, part.twist)) > MOST:
        # Slightly less, so that the rounded number still works.
        thickness = f"{mm(0.95 * part.thickness * MOST / count):.2g}"
        raise DesignError(
            "tolerance",
            f"found {mm(tolerance):g}, with which the {part.name} takes {count:,} triangles; {MOST:,} can be drawn",
            f"give {_tolerance_advice(part, part.twist, tolerance)}a thickness of at most {thickness}",
            "too-much-work",
        )
    return cut_part


def _check_apart(cut_part: Cut, twist: Twist) -> None:
    """DesignError unless a circle about the axis separates the fixed loops from the moving ones."""
    moving, fixed = _moving_and_fixed([loop.points for loop in cut_part.loops], twist)
    if not fixed:
        return
    outside = twist.moves == "outline"
    outer, inner = (moving, fixed) if outside else (fixed, moving)
    room = min(float(np.abs(region.nearest_to_origin(loop)).min()) for loop in outer)
    if (extent := max(float(np.abs(loop).max()) for loop in inner) + abs(twist.shift)) >= room:
        raise DesignError(
            cut_part.part.name,
            f"its holes extend to {mm(extent):.4g} from the axis of its twist, and its outline begins at "
            f"{mm(room):.4g}",
            "make the holes smaller, or the part larger",
        )


def _tolerance_advice(part: Part, twist: Twist, tolerance: float) -> str:
    """Advice with the least tolerance tried that needs few enough triangles; empty if there is none."""
    for k in range(1, TRIALS + 1):
        wider = to_digits(tolerance * WIDER**k, 3)
        try:
            if moving_triangles(cut(part, wider / 2), twist) <= MOST:
                return f"at least {mm(wider):up6}, or "
        except DesignError:
            # With this tolerance nothing is left of the part.
            break
    return ""


def _moving_and_fixed(loops: list[Complex], twist: Twist) -> tuple[list[Complex], list[Complex]]:
    """The loops that move, and the fixed ones."""
    return (loops[:1], loops[1:]) if twist.moves == "outline" else (loops[1:], loops[:1])


def slices(loops: list[Complex], twist: Twist, tolerance: float) -> int:
    """Number of slices of the height with which each is within `tolerance`, mm, of the true shape.

    `loops` are the moving ones, mm, about the origin. A rotation by `a` takes a point at radius r along a helix, whose
    chord is r (1 - cos(a/2)) away, and makes an edge of length d a saddle, from which the diagonal of its two triangles
    is d/2 sin(a/2) away; each is at most the tolerance. A shift alone leaves planes. Derived here.
    """
    radius = max(float(np.abs(loop).max()) for loop in loops)
    edge = max(float(np.abs(np.roll(loop, -1) - loop).max()) for loop in loops)
    half = min(np.arccos(max(1 - tolerance / radius, 0.0)), np.arcsin(min(2 * tolerance / edge, 1.0)))
    return (2 if twist.herringbone else 1) * max(1, int(np.ceil(abs(twist.turn) / (2 * half) - 1e-9)))


def moving_triangles(cut_part: Cut, twist: Twist) -> int:
    """Number of triangles between the slices of the moving loops."""
    moving, _ = _moving_and_fixed([loop.points for loop in cut_part.loops], twist)
    return 2 * slices(moving, twist, cut_part.tolerance) * sum(map(len, moving))


def twisted(cut_part: Cut, twist: Twist, loops: list[Complex]) -> tuple[Real, Whole]:
    """Corners (n, 3), mm, and triangles (m, 3) of a twisted part from its loops, material on their left."""
    corners: list[Real] = []
    faces: list[Whole] = []
    lids: tuple[list[Complex], list[Complex]] = ([], [])
    numbers: tuple[list[Whole], list[Whole]] = ([], [])
    for shares, exact in _sections(cut_part, twist, loops):
        section = _single(exact)
        first = sum(map(len, corners))
        rows = first + np.arange(section.size).reshape(section.shape)
        corners.append(
            np.column_stack([xy(section.ravel()), np.repeat(cut_part.part.thickness * shares, section.shape[1])])
        )
        faces.append(_walls(section, rows))
        for end, lid, number in zip((0, -1), lids, numbers):
            lid.append(section[end])
            number.append(rows[end])
    floor, roof = (_lid(lid, np.concatenate(number)) for lid, number in zip(lids, numbers))
    return np.concatenate(corners), np.concatenate([floor[:, ::-1], roof, *faces])


def _sections(cut_part: Cut, twist: Twist, loops: list[Complex]) -> Iterator[tuple[Real, Complex]]:
    """For each loop the shares of the height at which it has corners, and these corners, (heights, points)."""
    shares = np.linspace(0, 1, slices(_moving_and_fixed(loops, twist)[0], twist, cut_part.tolerance) + 1)
    for k, loop in enumerate(loops):
        if (k == 0) == (twist.moves == "outline"):
            # Rounded like the loops, so that the last bits of a processor's sine reach no file.
            yield shares, rounded(twist.at(shares[:, None]).place(loop), cut_part.digits)
        else:
            yield shares[[0, -1]], np.stack([loop, loop])


def _rises(section: Complex) -> Mask:
    """For each quadrilateral between two heights whether its diagonal rises along the loop.

    The shorter diagonal is chosen, since the other would cut off an arc about the axis.
    """
    edge = np.roll(section, -1, axis=1) - section
    displacement = section[1:] - section[:-1]
    forward = dot(edge[:-1], displacement + np.roll(displacement, -1, axis=1))
    rises: Mask = forward < -SHORTER * np.abs(section).max() ** 2
    return rises


def _walls(section: Complex, rows: Whole) -> Whole:
    """Triangles between the sections of a loop whose corners have the numbers `rows`."""
    low, high = rows[:-1], rows[1:]
    low_end, high_end = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    rises = _rises(section)
    first = np.stack([low, low_end, np.where(rises, high_end, high)], axis=-1)
    second = np.stack([np.where(rises, low, low_end), high_end, high], axis=-1)
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def _lid(loops: list[Complex], numbers: Whole) -> Whole:
    """Triangles of a section, counterclockwise from above, by the numbers of its corners."""
    points, faces = region.triangulate(loops)
    corners = np.concatenate(loops)
    order = np.argsort(corners)
    lid: Whole = numbers[order[np.searchsorted(corners[order], points)]][faces]
    return lid


def twisted_volume(cut_part: Cut, twist: Twist, loops: list[Complex]) -> float:
    """Volume of the mesh of `twisted`, mm3, from its sections, as an independent check.

    A slice between two heights is a prismatoid, whose volume follows from its lowest, middle and highest section
    (Simpson).
    """
    return cut_part.part.thickness * sum(_mean_area(section) for _, section in _sections(cut_part, twist, loops))


def _mean_area(section: Complex) -> float:
    low, high = section[:-1], section[1:]
    low_end, high_end = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    diagonal = np.where(_rises(section), low + high_end, low_end + high)
    middle = np.stack([low + high, diagonal], axis=-1).reshape(len(low), -1) / 2
    ends, middles = ([polygon_area(loop) for loop in loops] for loops in (section, middle))
    return float((np.mean(ends[:-1]) + np.mean(ends[1:]) + 4 * np.mean(middles)) / 6)


def solid(cut: Cut) -> tuple[Real, Whole]:
    """Corners (n, 3), mm, from z = 0 upwards, and triangles (m, 3), counterclockwise from outside.

    Raises GeomkinError for a mesh that is not closed or whose volume differs from that of its sections; inverted hole
    walls would pass as watertight.
    """
    loops = [_distinct(_single(loop), cut.tolerance) for loop in _boundaries(cut)]
    if twist := cut.part.twist:
        points, faces = twisted(cut, twist, loops)
        expected = twisted_volume(cut, twist, loops)
    elif cut.foot:
        points, faces, expected = _footed(cut, loops)
    else:
        points, faces = _straight(loops, cut.part.thickness)
        # Corners left out for rounding enclose far less than the tolerance.
        expected = sum(polygon_area(loop) for loop in loops) * cut.part.thickness
    a, b, c = points[faces].swapaxes(0, 1)
    volume = float(np.vecdot(np.cross(b - a, c - b), a).sum() / 6)
    if not _is_closed(faces, len(points)) or not np.isclose(volume, expected, rtol=1e-6):
        raise GeomkinError(
            f"{cut.part.name}: its solid has volume {mm(volume, unit='mm3'):.6g} instead of "
            f"{bare_mm(expected, power=3):.6g}; "
            "please report this with the recipe"
        )
    return points, faces


def triangles(cut: Cut) -> int:
    """Approximate number of triangles of a solid: two for each point of its walls, and those of both ends."""
    points = sum(len(loop.points) for loop in cut.loops)
    walls = moving_triangles(cut, cut.part.twist) if cut.part.twist else 2 * points
    return walls + 2 * points


def solid_volume(cut: Cut) -> float:
    """Volume of the solid of a cut, mm3."""
    twist = cut.part.twist
    return twisted_volume(cut, twist, _boundaries(cut)) if twist else cut.chord_area * cut.part.thickness


def _boundaries(cut: Cut) -> list[Complex]:
    """The loops with the material on their left."""
    return [loop.points if k == 0 else loop.points[::-1] for k, loop in enumerate(cut.loops)]


def _straight(loops: list[Complex], thickness: float) -> tuple[Real, Whole]:
    plane, lid = region.triangulate(loops)
    edges, count = _boundary(lid, len(plane)), len(plane)
    floor = np.column_stack([xy(plane), np.zeros(count)])
    points = np.concatenate([floor, floor + np.array([0.0, 0.0, thickness])])
    start, end = edges.T
    walls = np.stack([end + count, start + count, end, end, start + count, start], axis=1).reshape(-1, 3)
    return points, np.concatenate([lid[:, ::-1], lid + count, walls])


def _footed(cut: Cut, loops: list[Complex]) -> tuple[Real, Whole, float]:
    """Corners, triangles and volume, mm3, of a plate whose lower edges are chamfered by 45 deg.

    The sloped faces are triangles between the loops and the same ones `foot` further in, which lie on the bed.
    """
    foot, thickness = cut.foot, cut.part.thickness
    lower = [_single(loop) for loop in chamfered(cut, loops)]
    heights = dict.fromkeys(np.concatenate(lower).tolist(), 0.0)
    triangles, removed = [], 0.0
    for ring in region.without(loops, lower[:1]) + [
        piece for hole in lower[1:] for piece in region.without([hole[::-1]], [h[::-1] for h in loops[1:]])
    ]:
        plane, faces = region.triangulate(ring)
        z = np.array([heights.get(point, foot) for point in plane.tolist()])
        corners = np.column_stack([xy(plane), z])[faces]
        (x, y), height = np.moveaxis(corners[:, 1:, :2] - corners[:, :1, :2], 1, 0), z[faces].mean(axis=1)
        removed += float(np.abs(x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]) @ height) / 2
        triangles.append(corners[:, ::-1])
    for sides, level, turn in ((lower, 0.0, -1), (loops, thickness, 1)):
        plane, faces = region.triangulate(sides)
        triangles.append(np.column_stack([xy(plane), np.full(len(plane), level)])[faces][:, ::turn])
    for loop in loops:
        rows = np.arange(2 * len(loop)).reshape(2, -1)
        corners = np.column_stack([xy(np.tile(loop, 2)), np.repeat([foot, thickness], len(loop))])
        triangles.append(corners[_walls(np.stack([loop, loop]), rows)])
    points, index = np.unique(np.concatenate(triangles).reshape(-1, 3), axis=0, return_inverse=True)
    return points, index.reshape(-1, 3), sum(map(polygon_area, loops)) * thickness - removed


def chamfered(cut: Cut, loops: list[Complex]) -> list[Complex]:
    """The loops of a section on the bed, material on their left: `foot` further in than those above the chamfer."""
    inner = region.offset(loops, -cut.foot, cut.tolerance)
    if len(inner) != 1 or len(inner[0]) != len(loops):
        problem = f"found {mm(cut.foot):g}, more than half of the thinnest wall of the {cut.part.name}"
        raise DesignError("printing.foot", problem, "give a smaller one, or 0 for none", "conflict")
    return [_distinct(rounded(loop, cut.digits), cut.tolerance) for loop in inner[0]]


def _is_closed(faces: Whole, points: int) -> bool:
    """Whether each edge of a triangle is also that of exactly one other, in the opposite direction."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    there, back = np.sort(start * points + end), np.sort(end * points + start)
    return bool((there == back).all() and (there[1:] != there[:-1]).all())


def _boundary(faces: Whole, points: int) -> Whole:
    """Directed edges (n, 2) that belong to one triangle (m, 3) only; empty if two edges coincide."""
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, first, met = np.unique(high * points + low, return_index=True, return_counts=True)
    run = np.sort(edges[:, 0] * points + edges[:, 1])
    alike = (run[1:] == run[:-1]).any()
    return edges[:0] if alike else edges[first[met == 1]]


def _single(z: Complex) -> Complex:
    """The points with coordinates that single-precision numbers have exactly, so that no file moves them."""
    return z.astype(np.complex64).astype(complex)


def _distinct(z: Complex, tolerance: float) -> Complex:
    """The corners that single-precision numbers distinguish from a straight line; others would give flat triangles."""
    finest = min(4 * np.finfo(np.float32).eps * np.abs(z).max(), STRAIGHT * tolerance)
    z = z[np.abs(z - np.roll(z, 1)) > finest]
    before, after = np.roll(z, 1), np.roll(z, -1)
    straight = np.abs(np.imag((z - before) * np.conj(after - before))) <= finest * np.abs(after - before)
    # Only one of two neighbours is removed at a time, so that a gentle curve keeps its shape.
    corners: Complex = z[~(straight & ~np.roll(straight, 1))]
    return corners
