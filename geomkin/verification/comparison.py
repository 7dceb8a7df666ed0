"""The plates of a drawing against the exact curves of their parts, which are identified first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from math import nan

import numpy as np

from ..core.errors import printable
from ..core.records import record
from ..core.units import mm
from ..export.text import lettered
from ..model.machinability import relieved
from ..model.part import Part
from ..plane.region import Edges, containers, gap, is_simple, offset, overlap, overlapping
from ..plane.vec import Complex, Real, dot
from ..recipe.printing import Printing
from ..recipe.settings import Files
from .outline import (
    EVEN,
    NODES,
    WEIGHTS,
    Drawing,
    Line,
    Outline,
    UnreadableError,
    deviation,
    farthest,
    larger,
    outline_of,
)

# Highest order of the moments from which a rotation is found: the largest number of teeth of a gear, since the lower
# moments of a gear are 0.
HIGHEST = 400
# Least size of a moment, relative to that of a ring, from which a rotation is found. A smaller one may be an error of
# the chords.
CLEAR = 1e-3
# Number of points along loops at which positions are compared.
SAMPLES = 240
# Steps of the fit of a position, which converges quadratically.
STEPS = 12
# Share of the tolerance by which the mean distances of two positions may differ if both fit equally. A smaller one is
# within the rounding of files.
SAME = 1e-3
# Number of parts that are tried if none has the area of the loops: those of the nearest areas.
TRIED = 2
# Heights of sections, as shares of a slice: next to both ends, where a wrong corner is visible, and in the middle.
CUTS = (1e-3, 0.5, 1 - 1e-3)
# Share of its area, and of the length of its lines, by which a plate that differs more from a part is another one.
ANOTHER = 0.3
# Share of their length by which engraved lines may differ from those of the part: more than chords do, and less than
# one that is engraved twice.
RETRACED = 0.01


@record(eq=False)
class Shape:
    """A plate as closed loops, mm: the outline counterclockwise, the holes, and the marks engraved on it."""

    outline: Outline
    holes: tuple[Outline, ...]
    marks: tuple[Outline, ...] = ()

    @property
    def loops(self) -> tuple[Outline, ...]:
        """Outline and holes."""
        return (self.outline, *self.holes)

    @property
    def area(self) -> float:
        """mm2."""
        return abs(self.outline.area) - sum(abs(hole.area) for hole in self.holes)

    @property
    def length(self) -> float:
        """Length of all loops, mm."""
        return sum(loop.length for loop in self.loops)

    @property
    def size(self) -> float:
        """Largest distance of the outline from its centroid, mm."""
        return float(np.abs(self.outline.points - self.outline.centroid).max())

    def placed(self, turn: complex, shift: complex) -> Shape:
        """The plate rotated about the origin by a unit complex number, then shifted, mm."""
        holes, marks = ([loop.placed(turn, shift) for loop in loops] for loops in (self.holes, self.marks))
        return Shape(self.outline.placed(turn, shift), tuple(holes), tuple(marks))


def nested(cuts: Sequence[Outline], marks: Sequence[Outline]) -> list[tuple[list[int], list[int]]]:
    """The plates of a sheet as indices of their cuts, outline first, and of their marks.

    A loop inside an even number of others is an outline; any other is a hole in the smallest loop around it.
    """
    if not cuts:
        return []
    loops = [cut.points for cut in cuts]
    # The first corner of a loop is on the loop, not inside it.
    around = containers(np.array([loop[0] for loop in loops]), loops)
    plates = {k: ([k], list[int]()) for k, outer in enumerate(around) if len(outer) % 2 == 0}
    for k, outer in enumerate(around):
        if len(outer) % 2:
            plates.setdefault(outer[0], ([outer[0]], []))[0].append(k)
    for k, outer in enumerate(containers(np.array([mark.points[0] for mark in marks], dtype=complex), loops)):
        outlines = [j for j in outer if j in plates]
        if outlines:
            plates[outlines[0]][1].append(k)
    return list(plates.values())


def likely_positions(found: Shape, exact: Shape, tolerance: float) -> Iterator[tuple[complex, complex]]:
    """Rotations, unit complex, and shifts, mm, that may move an exact plate onto that of a file, the likeliest first.

    The shift follows from the centroids, and the rotation from the lowest moment of the area that is not zero. The
    moment leaves a choice between some rotations, which the distances of the loops decide. Most parts lie on a sheet at
    whole millimetres and degrees, so this position comes first if it differs by less than the tolerance. The last one
    is fitted to the loops.
    """
    here, there = found.outline.centroid, exact.outline.centroid
    samples = _samples(found)
    # If the outline is symmetric, the marks decide.
    lines = (*exact.loops, *exact.marks)
    edges = edges_of(lines)

    def misfit(turn: complex) -> float:
        return float(edges.nearest((samples - here) / turn + there)[1].mean())

    rotations = _rotations(found, exact, tolerance)
    misfits = np.array([misfit(turn) for turn in rotations] if len(rotations) > 1 else [0.0])
    # A symmetric part fits equally in several positions. The least rotation is chosen, counterclockwise before
    # clockwise, so that rounding does not decide.
    fitting = [turn for turn, off in zip(rotations, misfits) if off <= misfits.min() + SAME * tolerance]
    turn = max(fitting, key=lambda turn: (round(turn.real, 6), turn.imag))
    shift = here - turn * there
    if rounded := _whole(turn, shift, there, exact.size, tolerance):
        yield rounded
    turn, shift = _fitted(samples, edges, turn, shift, tolerance)
    if rounded := _whole(turn, shift, there, exact.size, tolerance):
        yield rounded
    yield turn, shift


def edges_of(lines: Sequence[Outline]) -> Edges:
    """The edges of all lines."""
    return Edges(np.concatenate([line.starts for line in lines]), np.concatenate([line.ends for line in lines]))


def _whole(
    turn: complex, shift: complex, centre: complex, size: float, tolerance: float
) -> tuple[complex, complex] | None:
    """The position at whole degrees and millimetres, if it differs by less than the tolerance; otherwise None."""
    whole = complex(np.exp(1j * np.radians(np.round(np.degrees(np.angle(turn))))))
    # The shift is that of the part's origin, which a rotation about the part's centre moves.
    moved = shift + (turn - whole) * centre
    rounded = complex(np.round(moved.real), np.round(moved.imag))
    return (whole, rounded) if abs(whole - turn) * size < tolerance and abs(moved - rounded) < tolerance else None


def candidates(found: Shape, exact: Sequence[Shape], tolerance: float) -> list[int]:
    """Indices of the exact plates with the area of a plate in a file; if none has it, those of the nearest areas."""
    # In tolerances along the loops. Of plates with equal areas the first one is tried first, whatever the rounding.
    differences = [abs(plate.area - found.area) / (tolerance * plate.length) for plate in exact]
    order = sorted(range(len(exact)), key=lambda k: round(differences[k] / SAME))
    equal = [k for k in order if differences[k] <= 2]
    return equal or order[:TRIED]


def _rotations(found: Shape, exact: Shape, tolerance: float) -> list[complex]:
    """Rotations that agree with the lowest clear moment of the area; 1 for a plate that is round."""
    if all(np.ptp(np.abs(loop.points - exact.outline.centroid)) < tolerance for loop in exact.loops):
        return [1 + 0j]
    for order, (here, there) in enumerate(zip(_moments(found), _moments(exact)), 2):
        if abs(there) > CLEAR:
            angle = np.angle(here / there) / order
            rotations: list[complex] = np.exp(1j * (angle + 2 * np.pi * np.arange(order) / order)).tolist()
            return rotations
    return [1 + 0j]


def _moments(shape: Shape) -> Iterator[complex]:
    """Integrals over the area of z^2, z^3 ..., z from the centroid in units of the size, by Green's theorem."""
    centre, size = shape.outline.centroid, shape.size
    nodes, steps = [], []
    for k, loop in enumerate(shape.loops):
        middle = (loop.starts + loop.ends - 2 * centre) / (2 * size)
        half = (loop.ends - loop.starts) / (2 * size)
        nodes.append((middle[:, None] + half[:, None] * NODES).ravel())
        side = np.sign(loop.area) * (1 if k == 0 else -1)
        steps.append((side * half[:, None] * WEIGHTS).ravel())
    z = np.concatenate(nodes)
    term = z.conj() * np.concatenate(steps) * z / 2j
    for _ in range(HIGHEST - 1):
        term = term * z
        yield complex(term.sum())


def _samples(shape: Shape) -> Complex:
    """Points spread along all loops and marks, corners included if there are few."""
    lines = (*shape.loops, *shape.marks)
    step = sum(line.length for line in lines) / SAMPLES
    spread: list[Complex] = []
    for loop in lines:
        lengths = np.append(0, np.cumsum(np.abs(loop.ends - loop.starts)))
        at = np.arange(step / 2, lengths[-1], step) if lengths[-1] > step else np.array([0, lengths[-1] / 2])
        z = np.append(loop.starts, loop.ends[-1:])
        spread.append(np.interp(at, lengths, z.real) + 1j * np.interp(at, lengths, z.imag))
        spread.append(loop.points[:: len(loop.points) // SAMPLES + 1])
    return np.concatenate(spread)


def _fitted(samples: Complex, edges: Edges, turn: complex, shift: complex, tolerance: float) -> tuple[complex, complex]:
    """The position with the least sum of distances. Unlike least squares, a few points far off have little effect."""
    for _ in range(STEPS):
        local = (samples - shift) / turn
        which, _ = edges.nearest(local)
        start, edge = edges.starts[which], edges.ends[which] - edges.starts[which]
        length = np.abs(edge)
        sound = length > 0
        normal = 1j * edge[sound] / length[sound]
        off: Real = dot(normal, local[sound] - start[sound])
        weight = 1 / (np.abs(off) + tolerance / 10)
        # Columns: shift along x, shift along y, and rotation times the size, so that all three are lengths.
        size = np.abs(local).max() or 1.0
        matrix = np.stack([normal.real, normal.imag, dot(normal, 1j * local[sound]) / size], axis=1)
        step, *_ = np.linalg.lstsq(matrix * weight[:, None], -off * weight, rcond=1e-9)
        angle = -step[2] / size
        shift = shift - turn * complex(step[0], step[1])
        turn = turn * complex(np.exp(1j * angle))
        if abs(step).max() < 1e-9 * size:
            break
    return turn, shift


# Error of the measurement itself, as a share of the tolerance. A smaller one takes longer and finds the same faults.
FINENESS = 0.04
# Largest numbers of lines of a drawing, and of plates or solids of a file, that are measured: a multiple of those of
# the recipe, plus a constant. Measuring more would take minutes, and such a file is wrong in any case.
MOST_LINES, MOST_PLATES = (10, 1000), (2, 20)


@record(eq=False)
class ExactPart:
    """A part with its exact curves as polygons: those of the solid, and those of a drawing, half a kerf off them.

    foot: chamfer of the lower edges of the solid, mm; bed: its section close to the bed, if it has one.
    """

    part: Part
    solid: Shape
    drawn: Shape
    foot: float = 0.0
    bed: Shape | None = None


@record(eq=False)
class Measured:
    """The result of measuring one plate or solid of a file.

    part: name of its part; deviation, place: largest distance between the file and the exact curves, mm, and its
    position; plate, exact: the measured and the exact plate in the part's frame, for a picture; problems: a sentence
    each.
    """

    part: str
    deviation: float = nan
    place: complex = 0j
    plate: Shape | None = None
    exact: Shape | None = None
    problems: tuple[str, ...] = ()

    @property
    def holes(self) -> int:
        """Number of holes found."""
        return len(self.plate.holes) if self.plate else 0


def worst_of(measured: Sequence[Measured]) -> Measured:
    """The result with the largest deviation; the first one of those that are equal but for rounding."""
    worst = Measured("", -1.0)
    for one in measured:
        worst = one if one.deviation > worst.deviation * (1 + EVEN) else worst
    return worst if worst.deviation >= 0 else Measured("")


def refuse_more(found: int, expected: int, most: tuple[int, int], name: str) -> None:
    """UnreadableError if a file has far more lines, plates or solids than its recipe."""
    if found > most[0] * expected + most[1]:
        raise UnreadableError(f"it has {found} {name}, and the recipe {expected}")


def exact_part(part: Part, files: Files, printing: Printing | None = None, number: int = 0) -> ExactPart:
    """The exact curves of a part as polygons whose error is a small share of the tolerance.

    Those of drawings are half a kerf off, and have relief for a cutter; those of solids are as they are printed.
    number: that by which drawings label the part; 0 if they do not.
    """
    kerf, cutter, tolerance = files.kerf, files.cutter, files.tolerance
    error = tolerance * FINENESS / 2

    def upright(curve: Outline) -> Outline:
        return curve if curve.area > 0 else Outline(curve.points[::-1], curve.error)

    outline = upright(outline_of(part.outline, error))
    holes = tuple(upright(outline_of(hole, error)) for hole in part.holes)
    solid = Shape(outline, holes, tuple(outline_of(mark, error) for mark in part.marks))
    strokes = lettered(part, number)[1] if number else ()
    marks = (*solid.marks, *(Outline(stroke, closed=False) for stroke in strokes))

    def moved(shape: Shape, out: float) -> Shape:
        """The shape grown by a distance, mm; itself if it does not stay one plate."""
        regions = offset([shape.outline.points, *(hole.points[::-1] for hole in shape.holes)], out, error)
        grown = [[Outline(loop, 2 * error) for loop in loops] for loops in regions]
        plates = [Shape(loops[0], tuple(map(upright, loops[1:])), shape.marks) for loops in grown]
        return plates[0] if len(plates) == 1 else shape

    relief = tuple(upright(outline_of(hole, error)) for hole in relieved(part, cutter).holes) if cutter else holes
    drawn = replace(solid, holes=relief, marks=marks)
    drawn = moved(drawn, kerf / 2) if kerf or cutter else drawn
    if printing is None:
        return ExactPart(part, solid, drawn)
    printed, foot = moved(solid, -printing.growth / 2), printing.foot
    return ExactPart(part, printed, drawn, foot, moved(printed, -foot * (1 - CUTS[0])) if foot else None)


def meeting(loops: Sequence[Complex]) -> list[tuple[int, int]]:
    """Pairs of closed lines that cross or touch each other along a line, or coincide."""
    pairs = overlapping(loops).tolist() if len(loops) > 1 else []
    return [(a, b) for a, b in pairs if gap(loops[a], loops[b]) == 0]


def colliding(plates: Sequence[Shape]) -> list[tuple[int, int]]:
    """Pairs of plates that meet, or of which one lies in the material of the other."""
    outlines = [plate.outline.points for plate in plates]
    pairs: list[tuple[int, int]] = overlapping(outlines).tolist() if len(outlines) > 1 else []
    regions = [[plate.outline.points, *(hole.points[::-1] for hole in plate.holes)] for plate in plates]
    return [(a, b) for a, b in pairs if gap(outlines[a], outlines[b]) == 0 or overlap(regions[a], regions[b])]


def measure_drawing(drawing: Drawing, again: Drawing, parts: Sequence[ExactPart], tolerance: float) -> list[Measured]:
    """The plates of a drawing, each compared with the part that it shows; their numbers and tabs with those made again.

    again: the drawing that the recipe makes.
    """
    measured: list[Measured] = []
    cuts, marks = _contours(drawing), drawing.marks
    measured += _wrong_lines([line for line in drawing.cuts if not line.outline.closed], "to cut are not closed")
    flat = [line for line in drawing.cuts if line.outline.closed and not line.outline.area]
    measured += _wrong_lines(flat, "to cut enclose no area")
    lines = [part.part.count * (len(part.drawn.loops) + len(part.drawn.marks)) for part in parts]
    refuse_more(len(cuts) + len(marks), sum(lines), MOST_LINES, "lines to cut or engrave")
    plates = nested([cut.outline for cut in cuts], [mark.outline for mark in marks])
    on_parts = {k for _, engraved in plates for k in engraved}
    measured += _wrong_lines([mark for k, mark in enumerate(marks) if k not in on_parts], "to engrave are on no part")
    sound = [cut.outline.points for cut in cuts if is_simple(cut.outline.points)]
    if pairs := meeting(sound):
        place = complex(sound[pairs[0][1]][0])
        measured.append(Measured("", place=place, problems=(f"{len(pairs)} pairs of lines to cut meet",)))
    refuse_more(len(plates), sum(part.part.count for part in parts), MOST_PLATES, "parts")
    count, tabs = _made_again(again, parts, tolerance)
    left = count.copy()
    for loops, engraved in plates:
        outlines = [cuts[k].outline for k in loops]
        problems = [
            f"{'the outline' if k == 0 else f'hole {k}'} crosses itself"
            for k, outline in enumerate(outlines)
            if not is_simple(outline.points)
        ]
        first = cuts[loops[0]]
        plate = Shape(outlines[0], tuple(outlines[1:]), tuple(marks[k].outline for k in engraved))
        name = first.part
        result = _best_part(plate, parts, tolerance, name, left)
        left[result.part] -= 1
        problems += _tab_problems(first.tabs, tabs.get(result.part, first.tabs), tolerance)
        if name != result.part and name in (part.part.name for part in parts):
            problems.append(f"it is in the group of {printable(name, 60)}")
        exact = next(exact for exact in parts if exact.part.name == result.part)
        layers = {first.layer} - {exact.part.layer} | {cuts[k].layer for k in loops[1:]} - {"HOLE"}
        problems += [f"it is on layer {layer}" for layer in sorted(layers)]
        measured.append(with_problems(result, problems))
    return measured + [
        Measured(name, problems=(f"the drawing has {count[name] - more} of it, and the recipe makes {count[name]}",))
        for name, more in left.items()
        if more
    ]


def _contours(drawing: Drawing) -> list[Line]:
    """The lines to cut that enclose an area."""
    return [line for line in drawing.cuts if line.outline.closed and line.outline.area]


def _made_again(
    again: Drawing, parts: Sequence[ExactPart], tolerance: float
) -> tuple[Counter[str], dict[str, tuple[float, ...]]]:
    """The number of plates of each part in the drawing that the recipe makes, and the lengths of their tabs, mm."""
    cuts = _contours(again)
    outlines = [line.outline for line in cuts]
    count, tabs = Counter[str](), dict[str, tuple[float, ...]]()
    for loops, engraved in nested(outlines, [mark.outline for mark in again.marks]):
        first, *holes = (outlines[k] for k in loops)
        plate = Shape(first, tuple(holes), tuple(again.marks[k].outline for k in engraved))
        # Only parts of equal areas are compared.
        likely, line = candidates(plate, [part.drawn for part in parts], tolerance), cuts[loops[0]]
        alone = parts[likely[0]].part.name if len(likely) == 1 else ""
        part = alone or _best_part(plate, parts, tolerance, line.part, {}).part
        count[part] += 1
        tabs[part] = line.tabs
    return count, tabs


def _wrong_lines(lines: Sequence[Line], wrong: str) -> list[Measured]:
    """A result with the number of lines that are wrong in some way; none if there are none."""
    if not lines:
        return []
    return [Measured("", place=complex(lines[0].outline.points[0]), problems=(f"{len(lines)} lines {wrong}",))]


def _tab_problems(found: Sequence[float], wanted: Sequence[float], tolerance: float) -> list[str]:
    """Lengths of tabs, mm, in ascending order; both ends of one may be off by the tolerance."""
    if len(found) == len(wanted) and all(abs(a - b) <= 2 * tolerance for a, b in zip(found, wanted)):
        return []
    return [
        f"it has {len(found)} tabs, {mm(sum(found)):.5g} long in all, and the one made again {len(wanted)} of "
        f"{mm(sum(wanted)):.5g}"
    ]


def _best_part(
    plate: Shape, parts: Sequence[ExactPart], tolerance: float, name: str, left: Mapping[str, int]
) -> Measured:
    """A plate of a drawing compared with the first part that it fits, or with the one that it fits best.

    name: of the part that is tried first, if one of this name could be it; left: numbers of the parts that are not
    found yet, which are tried next.
    """
    tried: list[Measured] = []
    order = candidates(plate, [part.drawn for part in parts], tolerance)
    for k in sorted(order, key=lambda k: (parts[k].part.name != name, left.get(parts[k].part.name, 0) <= 0)):
        tried.append(_measured(plate, parts[k].drawn, parts[k].part.name, tolerance))
        if not tried[-1].problems and tried[-1].deviation <= tolerance:
            break
    return min(tried, key=lambda one: (len(one.problems), one.plate is None, one.deviation))


def with_problems(found: Measured, problems: Sequence[str]) -> Measured:
    """A result with further problems."""
    return replace(found, problems=(*found.problems, *problems))


def _measured(plate: Shape, exact: Shape, name: str, tolerance: float) -> Measured:
    """A plate of a file compared with the exact one, at the first position within the tolerance, or at the best."""
    if problems := _known_problems(plate, exact):
        return Measured(name, place=complex(plate.outline.points[0]), problems=problems)
    tried: list[Measured] = []
    for turn, shift in likely_positions(plate, exact, tolerance):
        local = plate.placed(turn.conjugate(), -shift * turn.conjugate())
        tried.append(compared(local, exact, name, tolerance))
        if tried[-1].deviation <= tolerance:
            break
    return min(tried, key=lambda one: one.deviation)


def _known_problems(plate: Shape, exact: Shape) -> tuple[str, ...]:
    """What shows without a comparison, which would take long, that a plate is another one."""
    if len(plate.holes) != len(exact.holes):
        return (f"it has {len(plate.holes)} holes, but the part has {len(exact.holes)}",)
    if max(abs(plate.area / exact.area - 1), abs(plate.length / exact.length - 1)) <= ANOTHER:
        return ()
    return (
        f"its lines are {mm(plate.length):.5g} long about {mm(plate.area, unit='mm2'):.5g}, and those of the part "
        f"{mm(exact.length):.5g} about {mm(exact.area, unit='mm2'):.5g}",
    )


def compared(plate: Shape, exact: Shape, name: str, tolerance: float) -> Measured:
    """A plate compared with the exact one, both in the part's own frame."""
    problems: list[str] = []
    resolution = tolerance * FINENESS / 2
    worst = deviation(plate.outline, exact.outline, resolution)
    if len(plate.holes) != len(exact.holes):
        problems.append(f"it has {len(plate.holes)} holes, but the part has {len(exact.holes)}")
    left = list(plate.holes)
    for hole in exact.holes if len(plate.holes) == len(exact.holes) else ():
        nearest = min(left, key=lambda one: abs(one.centroid - hole.centroid) + np.sqrt(abs(abs(one.area) - hole.area)))
        left.remove(nearest)
        worst = larger(worst, deviation(nearest, hole, resolution))
    if exact.marks or plate.marks:
        worst = larger(worst, _marks_apart(plate.marks, exact.marks, resolution))
        long, wanted = (sum(mark.length for mark in shape.marks) for shape in (plate, exact))
        allowed = RETRACED * wanted + 2 * tolerance * len(exact.marks)
        if len(plate.marks) != len(exact.marks) or abs(long - wanted) > allowed:
            problems.append(
                f"it has {len(plate.marks)} engraved lines, {mm(long):.5g} long in all, and the part has "
                f"{len(exact.marks)} of {mm(wanted):.5g}"
            )
    return Measured(name, *worst, plate, exact, tuple(problems))


def _marks_apart(found: Sequence[Outline], exact: Sequence[Outline], resolution: float) -> tuple[float, complex]:
    """The largest distance of each set of marks from the other one, mm, and its place."""
    if not found or not exact:
        return 0.0, 0j
    sets = [edges_of(marks) for marks in (found, exact)]
    distances = [farthest(mark, sets[1], resolution) for mark in found]
    distances += [farthest(mark, sets[0], resolution) for mark in exact]
    return reduce(larger, distances)
