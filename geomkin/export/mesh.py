"""Solids whose section moves as it goes up: slices, as many as the tolerance asks, and the triangles between them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..core.errors import DesignError, GeomkinError
from ..model.part import Part, Twist
from ..plane import region as region
from ..plane.vec import Complex, Mask, Real, Whole, dot, rounded, xy
from .cut import Cut, check_scale, cut, signed_area

# Triangles of what moves in a part: a file of so many has 50 MB and is written in seconds. More, and programs take
# minutes to show it; fewer would refuse fine gears.
MOST = 1_000_000
# Step from one tolerance to the next that is looked at, and how many: to a thousand times the one given.
WIDER, LOOKS = 1.25, 31
# By how much, as a share, one diagonal must be shorter to be taken: by less, a processor's last bit would choose.
SHORTER = 1e-9


def solid_cut(part: Part, tolerance: float) -> Cut:
    """The loops that a solid within `tolerance`, mm, is made of: of one that turns half of it is left to the slices.

    DesignError where what moves could meet what stays, or takes more triangles than programs show.
    """
    if part.twist is None:
        return cut(part, tolerance)
    check_scale(part, tolerance, 0.5)
    made = cut(part, tolerance / 2)
    _check_apart(made, part.twist)
    if (count := moving_triangles(made, part.twist)) > MOST:
        # A little less, so that the number still works when rounded.
        thickness = f"{0.95 * part.thickness * MOST / count:.2g}"
        raise DesignError(
            "tolerance",
            f"found {tolerance:g} mm, with which the {part.name} takes {count:,} triangles; {MOST:,} can be drawn",
            f"give {_wider(part, part.twist, tolerance)}a thickness of at most {thickness} mm",
        )
    return made


def _check_apart(made: Cut, twist: Twist) -> None:
    """What stays must keep to one side of the circle that what moves keeps to the other side of."""
    moving, still = _parted([loop.points for loop in made.loops], twist)
    if not still:
        return
    outside = twist.moves == "outline"
    outer, inner = (moving, still) if outside else (still, moving)
    room = min(float(np.abs(region.nearest(loop)).min()) for loop in outer)
    if (found := max(float(np.abs(loop).max()) for loop in inner) + abs(twist.shift)) >= room:
        raise DesignError(
            made.part.name,
            f"its holes reach {found:.4g} mm from the axis of its twist, its outline comes as near as {room:.4g} mm",
            "make the holes smaller, or the part larger",
        )


def _wider(part: Part, twist: Twist, tolerance: float) -> str:
    """The least tolerance, of some, with which the triangles can be drawn, in words; none if there is none."""
    for k in range(1, LOOKS + 1):
        wider = float(f"{tolerance * WIDER**k:.3g}")
        try:
            if moving_triangles(cut(part, wider / 2), twist) <= MOST:
                return f"at least {wider:g} mm, or "
        except DesignError:
            # So wide that nothing is left of the part.
            break
    return ""


def _parted(loops: list[Complex], twist: Twist) -> tuple[list[Complex], list[Complex]]:
    """The loops that move, and those that stay."""
    return (loops[:1], loops[1:]) if twist.moves == "outline" else (loops[1:], loops[:1])


def slices(loops: list[Complex], twist: Twist, tolerance: float) -> int:
    """Into how many slices the height is cut, for each to be within `tolerance`, mm, of the true form.

    loops: what moves, mm, about the origin. A turn by `a` takes a point at radius r along a helix, from which its
    chord is r (1 - cos(a/2)) off, and bends an edge of length d into a saddle, from which the diagonal of the two
    triangles is d/2 sin(a/2) off: each is the tolerance at most. A slide alone leaves planes. Derived here.
    """
    radius = max(float(np.abs(loop).max()) for loop in loops)
    edge = max(float(np.abs(np.roll(loop, -1) - loop).max()) for loop in loops)
    half = min(np.arccos(max(1 - tolerance / radius, 0.0)), np.arcsin(min(2 * tolerance / edge, 1.0)))
    return (2 if twist.herringbone else 1) * max(1, int(np.ceil(abs(twist.turn) / (2 * half) - 1e-9)))


def moving_triangles(made: Cut, twist: Twist) -> int:
    """Triangles between the slices of what moves in a part."""
    moving, _ = _parted([loop.points for loop in made.loops], twist)
    return 2 * slices(moving, twist, made.tolerance) * sum(map(len, moving))


def twisted(made: Cut, twist: Twist, loops: list[Complex]) -> tuple[Real, Whole]:
    """Corners (n, 3), mm, and triangles (m, 3) of a part; loops: its own, material on their left."""
    corners: list[Real] = []
    faces: list[Whole] = []
    lids: tuple[list[Complex], list[Complex]] = ([], [])
    numbers: tuple[list[Whole], list[Whole]] = ([], [])
    for shares, section in _sections(made, twist, loops):
        first = sum(map(len, corners))
        rows = first + np.arange(section.size).reshape(section.shape)
        corners.append(
            np.column_stack([xy(section.ravel()), np.repeat(made.part.thickness * shares, section.shape[1])])
        )
        faces.append(_walls(section, rows))
        for end, lid, number in zip((0, -1), lids, numbers):
            lid.append(section[end])
            number.append(rows[end])
    floor, roof = (_lid(lid, np.concatenate(number)) for lid, number in zip(lids, numbers))
    return np.concatenate(corners), np.concatenate([floor[:, ::-1], roof, *faces])


def _sections(made: Cut, twist: Twist, loops: list[Complex]) -> Iterator[tuple[Real, Complex]]:
    """Of each loop the shares of the height where it has corners, and those corners, (heights, points)."""
    shares = np.linspace(0, 1, slices(_parted(loops, twist)[0], twist, made.tolerance) + 1)
    for k, loop in enumerate(loops):
        if (k == 0) == (twist.moves == "outline"):
            # Rounded as the loops are, so that the last bits of a processor's sine reach no file.
            yield shares, rounded(twist.at(shares[:, None]).place(loop), made.digits)
        else:
            yield shares[[0, -1]], np.stack([loop, loop])


def _rises(section: Complex) -> Mask:
    """Of each side between two heights, whether its diagonal goes up along the loop, and not back.

    The shorter one is taken: along an arc about the axis the other would cut it off.
    """
    edge = np.roll(section, -1, axis=1) - section
    way = section[1:] - section[:-1]
    forward = dot(edge[:-1], way + np.roll(way, -1, axis=1))
    rises: Mask = forward < -SHORTER * np.abs(section).max() ** 2
    return rises


def _walls(section: Complex, rows: Whole) -> Whole:
    """Triangles between the sections of a loop; rows: the numbers of its corners."""
    low, high = rows[:-1], rows[1:]
    low_end, high_end = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    rises = _rises(section)
    one = np.stack([low, low_end, np.where(rises, high_end, high)], axis=-1)
    two = np.stack([np.where(rises, low, low_end), high_end, high], axis=-1)
    return np.concatenate([one.reshape(-1, 3), two.reshape(-1, 3)])


def _lid(loops: list[Complex], numbers: Whole) -> Whole:
    """Triangles of a section, seen from above counterclockwise, by the numbers of its corners."""
    points, faces = region.triangulate(loops)
    corners = np.concatenate(loops)
    order = np.argsort(corners)
    lid: Whole = numbers[order[np.searchsorted(corners[order], points)]][faces]
    return lid


def twisted_volume(made: Cut, twist: Twist, loops: list[Complex]) -> float:
    """Of what `twisted` makes of the same, mm3, by another way: that of sections.

    A slice between two heights is a prismatoid, which its lowest, middle and highest section give (Simpson).
    """
    return made.part.thickness * sum(_mean_area(section) for _, section in _sections(made, twist, loops))


def _mean_area(section: Complex) -> float:
    low, high = section[:-1], section[1:]
    low_end, high_end = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    diagonal = np.where(_rises(section), low + high_end, low_end + high)
    middle = np.stack([low + high, diagonal], axis=-1).reshape(len(low), -1) / 2
    ends, middles = ([signed_area(loop) for loop in loops] for loops in (section, middle))
    return float((np.mean(ends[:-1]) + np.mean(ends[1:]) + 4 * np.mean(middles)) / 6)


def solid(cut: Cut) -> tuple[Real, Whole]:
    """Corners (n, 3), mm, from z = 0 up, and triangles (m, 3) of them, seen from outside counterclockwise.

    Raises GeomkinError rather than return a mesh that leaks or whose volume is not that of its sections: inverted hole
    walls pass for watertight.
    """
    loops = [_distinct(loop) for loop in _boundaries(cut)]
    if twist := cut.part.twist:
        points, faces = twisted(cut, twist, loops)
        expected = twisted_volume(cut, twist, loops)
    else:
        points, faces = _straight(loops, cut.part.thickness)
        # What the corners left out by rounding enclose is far below the tolerance, and not the mesh's fault.
        expected = sum(signed_area(loop) for loop in loops) * cut.part.thickness
    a, b, c = points[faces].swapaxes(0, 1)
    found = float(np.vecdot(np.cross(b - a, c - b), a).sum() / 6)
    if not _is_closed(faces, len(points)) or not np.isclose(found, expected, rtol=1e-6):
        raise GeomkinError(
            f"{cut.part.name}: its solid has volume {found:.6g} mm3 where {expected:.6g} is right; "
            "please report this with the recipe"
        )
    return points, faces


def triangles(cut: Cut) -> int:
    """About how many triangles the solid of a cut takes: two for each point of its walls, and those of both ends."""
    points = sum(len(loop.points) for loop in cut.loops)
    walls = moving_triangles(cut, cut.part.twist) if cut.part.twist else 2 * points
    return walls + 2 * points


def volume(cut: Cut) -> float:
    """Of the solid that is made of a cut, mm3."""
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


def _is_closed(faces: Whole, points: int) -> bool:
    """Whether each edge of a triangle is that of one other, which runs along it the other way."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    there, back = np.sort(start * points + end), np.sort(end * points + start)
    return bool((there == back).all() and (there[1:] != there[:-1]).all())


def _boundary(faces: Whole, points: int) -> Whole:
    """Edges (n, 2) that one triangle (m, 3) alone has, as it runs through them; empty where two run alike."""
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, first, met = np.unique(high * points + low, return_index=True, return_counts=True)
    run = np.sort(edges[:, 0] * points + edges[:, 1])
    alike = (run[1:] == run[:-1]).any()
    return edges[:0] if alike else edges[first[met == 1]]


def _distinct(z: Complex) -> Complex:
    """The corners that the format's 24-bit numbers can tell from a straight line: others leave flat triangles."""
    finest = 4 * np.finfo(np.float32).eps * np.abs(z).max()
    z = z[np.abs(z - np.roll(z, 1)) > finest]
    before, after = np.roll(z, 1), np.roll(z, -1)
    straight = np.abs(np.imag((z - before) * np.conj(after - before))) <= finest * np.abs(after - before)
    # Of neighbours only one goes at a time, so that a gentle curve keeps its shape.
    kept: Complex = z[~(straight & ~np.roll(straight, 1))]
    return kept
