"""Solids whose section moves as it goes up: slices, as many as the tolerance asks, and the triangles between them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..errors import DesignError
from ..part import Part, Twist
from ..plane import region
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


def volume(made: Cut, twist: Twist, loops: list[Complex]) -> float:
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
