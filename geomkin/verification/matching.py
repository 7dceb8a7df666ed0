"""Identifies the parts on a sheet from the loops of a drawing, and finds the position of each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..core.records import record
from ..plane.region import Edges, containers
from ..plane.vec import Complex, Real, dot
from .outline import NODES, WEIGHTS, Outline

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
    edges = Edges(np.concatenate([line.starts for line in lines]), np.concatenate([line.ends for line in lines]))

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
