"""The closed loop of a belt or chain round its wheels: tangents, arcs, length, and the place of its last wheel."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from itertools import combinations

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import ComplexPoint, last_fit, rounded_up
from ..core.records import record
from ..plane.curve import AbstractCurve
from ..plane.joined import Path
from ..plane.measure import separation
from ..plane.primitives import Arc, Segment
from ..plane.vec import Complex, Mask, Real

# Positions of the last wheel that are tried on its line, and the range of its distance over all sizes of the drive.
TRIED, WIDEST_RANGE = 800, 4.0
# Largest difference of the turning of a loop from one turn, rad, by rounding.
ROUNDING = 1e-6
# Largest relative error of a fitted length, and distance of two axes, in radii, that counts as none.
FITS, SAME_PLACE = 1e-9, 1e-9


@record(checked=True)
class LoopWheel:
    """A wheel in a loop.

    Parameters
    ----------
    centre : complex
        Its axis, mm.
    radius : float
        Radius of the pitch line on it, mm.
    pitches : float
        Pitches of the loop that pass in one turn of the wheel: its teeth, if it has any.
    is_outside : bool, optional
        Whether the loop passes with the wheel outside, so that the wheel turns in the other direction.
    outer_radius : float, optional
        Radius within which nothing else may be, mm; by default the radius.
    """

    centre: ComplexPoint
    radius: PositiveFloat
    pitches: PositiveFloat
    is_outside: bool = False
    outer_radius: PositiveFloat | None = None

    @property
    def side(self) -> int:
        """1 if the wheel turns counterclockwise with the loop, -1 outside it."""
        return -1 if self.is_outside else 1

    @property
    def room(self) -> float:
        """Radius within which nothing else may be, mm."""
        return self.radius if self.outer_radius is None else self.outer_radius


@record(checked=True)
class BeltLoop:
    """A loop round wheels, in the order in which it passes them counterclockwise.

    Parameters
    ----------
    wheels : tuple of LoopWheel
        Two or more.
    pitch : float
        Distance of teeth or rollers along the loop, mm.

    Raises
    ------
    DesignError
        If a wheel lies in another one, the loop does not touch a wheel, or it passes them in another order.

    Examples
    --------
    >>> wheels = [gk.belt.LoopWheel(x, z / np.pi, z) for x, z in ((0, 20), (100, 60))]
    >>> round(gk.belt.BeltLoop(tuple(wheels), 2.0).length, 6)
    140.81167
    """

    wheels: tuple[LoopWheel, ...]
    pitch: PositiveFloat

    def __post_init__(self) -> None:
        if len(self.wheels) < 2:
            raise DesignError("wheels", f"found {len(self.wheels)}", "give at least two", "out-of-range")
        _, spans, wraps = self._strands(self._centres)
        for k in np.flatnonzero(~(spans > 0)):
            other = (k + 1) % len(self.wheels)
            least = rounded_up(self.wheels[k].room + self.wheels[other].room)
            problem = f"no loop passes from wheel {k + 1} to wheel {other + 1}, since they meet"
            raise DesignError(f"wheels[{other}].centre", problem, f"give axes at least {least} mm apart", "conflict")
        if not self._is_simple(wraps):
            problem = "a loop that passes the wheels in this order crosses itself, or does not touch one of them"
            remedy = "list them counterclockwise, inside the loop, and let those outside press into it"
            raise DesignError("wheels", problem, remedy, "conflict")

    @cached_property
    def _centres(self) -> Complex:
        return np.array([wheel.centre for wheel in self.wheels], complex)

    @cached_property
    def _radii(self) -> Real:
        """Radii, negative outside the loop."""
        return np.array([wheel.side * wheel.radius for wheel in self.wheels])

    @cached_property
    def _pitches(self) -> Real:
        return np.array([wheel.pitches for wheel in self.wheels])

    def _strands(self, centres: Complex) -> tuple[Complex, Real, Real]:
        """Direction and length of the strand after each wheel, and the angle of the loop on it, (..., wheels).

        The radius at right angles to a strand of direction d ends at its start, so that the centres differ by
        d (length + i (change of the radius)).
        """
        change = np.roll(self._radii, -1) - self._radii
        apart = np.roll(centres, -1, axis=-1) - centres
        with np.errstate(invalid="ignore", divide="ignore"):
            spans = np.sqrt(np.abs(apart) ** 2 - change**2)
            directions = apart / (spans + 1j * change)
            turning = np.angle(directions / np.roll(directions, 1, axis=-1))
        return directions, spans, np.mod(np.sign(self._radii) * turning, 2 * np.pi)

    def _is_simple(self, wraps: Real) -> Mask:
        turning = (np.sign(self._radii) * wraps).sum(axis=-1)
        return np.asarray(np.abs(turning - 2 * np.pi) < ROUNDING)

    def _length(self, centres: Complex) -> Real:
        """Length in pitches, (...,); nan if the loop is not simple."""
        _, spans, wraps = self._strands(centres)
        length = (spans / self.pitch + wraps * self._pitches / (2 * np.pi)).sum(axis=-1)
        return np.where(self._is_simple(wraps), length, np.nan)

    @property
    def length(self) -> float:
        """Length, pitches."""
        return float(self._length(self._centres))

    @property
    def wraps(self) -> Real:
        """Angle of the loop on each wheel, rad, (wheels,)."""
        return self._strands(self._centres)[2]

    @property
    def directions(self) -> Complex:
        """Unit direction of the strand that follows each wheel, (wheels,)."""
        return self._strands(self._centres)[0]

    @property
    def spans(self) -> Real:
        """Length of the strand that follows each wheel, mm, (wheels,)."""
        return self._strands(self._centres)[1]

    @cached_property
    def starts(self) -> Complex:
        """Direction from each axis to the point at which the loop meets the wheel, (wheels,)."""
        return -1j * np.sign(self._radii) * np.roll(self.directions, 1)

    @cached_property
    def strands(self) -> Complex:
        """Both ends of the strand that follows each wheel, mm, (wheels, 2)."""
        begin = self._centres - 1j * self.directions * self._radii
        return np.stack([begin, begin + self.directions * self.spans], axis=-1)

    @cached_property
    def marks(self) -> Real:
        """Positions along the loop, pitches, of both ends of the arc on each wheel, and of the loop's end."""
        steps = np.stack([self.wraps * self._pitches / (2 * np.pi), self.spans / self.pitch], axis=-1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def place(self, at: Real) -> tuple[Complex, Complex]:
        """Points of the loop and its unit directions at positions along it, pitches, of any shape."""
        at = np.mod(at, self.marks[-1])
        piece = np.clip(np.searchsorted(self.marks, at, side="right") - 1, 0, 2 * len(self.wheels) - 1)
        wheel, passed = piece // 2, at - self.marks[piece]
        sign = np.sign(self._radii)[wheel]
        radius = self.starts[wheel] * np.exp(1j * sign * passed * 2 * np.pi / self._pitches[wheel])
        direction = self.directions[wheel]
        on_arc = piece % 2 == 0
        arc = self._centres[wheel] + np.abs(self._radii[wheel]) * radius
        strand = self.strands[wheel, 0] + passed * self.pitch * direction
        return np.where(on_arc, arc, strand), np.where(on_arc, 1j * sign * radius, direction)

    def path(self, beyond: float = 0.0) -> AbstractCurve:
        """The pitch line, or its parallel on the outside at a distance, mm."""
        pieces = list[AbstractCurve]()
        for k, wheel in enumerate(self.wheels):
            out = 1 + wheel.side * beyond / wheel.radius
            start = wheel.centre + wheel.radius * out * self.starts[k]
            pieces.append(Arc(wheel.centre, complex(start), float(wheel.side * self.wraps[k])))
            shift = -1j * self.directions[k] * beyond
            pieces.append(Segment(*(complex(z + shift) for z in self.strands[k])))
        return Path(tuple(pieces))

    def phase(self, k: int) -> float:
        """Rotation of a toothed wheel, rad, with which its gaps hold the teeth if a gap of the first one is on +y."""
        wheel, at = self.wheels[k], self.first_tooth - self.marks[2 * k]
        turn = np.angle(self.starts[k] / 1j) + wheel.side * at * 2 * np.pi / wheel.pitches
        pitch = 2 * np.pi / wheel.pitches
        return float(turn - pitch * np.round(turn / pitch))

    @property
    def first_tooth(self) -> float:
        """Position along the loop, pitches, of the tooth that is on +y of the first wheel if that wheel is unturned."""
        return float(np.angle(1j / self.starts[0]) * self.wheels[0].pitches / (2 * np.pi))

    def gaps(self, margin: float = 0.0) -> Iterator[tuple[float, str]]:
        """Distances between wheels, and between strands and what they pass, mm, each with its words.

        margin: extent of the belt on either side of its pitch line, mm.
        """
        count = len(self.wheels)
        for i, j in combinations(range(count), 2):
            apart = abs(self._centres[i] - self._centres[j]) - self.wheels[i].room - self.wheels[j].room
            yield float(apart), f"wheels {i + 1} and {j + 1}"
        for k in range(count):
            ends = {k, (k + 1) % count}
            for j in set(range(count)) - ends:
                apart = float(separation(self.strands[k], self._centres[j : j + 1])) - self.wheels[j].room - margin
                yield apart, f"the strand after wheel {k + 1} and wheel {j + 1}"
            for j in range(k + 1, count):
                if not ends & {j, (j + 1) % count}:
                    apart = float(separation(self.strands[k], self.strands[j])) - 2 * margin
                    yield apart, f"the strands after wheels {k + 1} and {j + 1}"

    @checked
    def fitted(self, pitches: PositiveFloat) -> BeltLoop:
        """The loop of a length, whose last wheel is moved on its line from the first one.

        Parameters
        ----------
        pitches : float
            Length, pitches.

        Returns
        -------
        BeltLoop
            Of the possible places of the wheel, the nearest one.

        Raises
        ------
        DesignError
            If there is none; names the shortest loop, or the longest one that was tried.
        """
        if abs(self._centres[-1] - self._centres[0]) <= SAME_PLACE * self.wheels[0].radius:
            raise DesignError("wheels", "the first and the last have one axis", "move them apart", "conflict")
        distances = self._free_distances(pitches)
        lengths = self._length_at(distances)
        beyond = lengths - pitches
        # A loop as long as that at an end of a range fits to rounding.
        found = distances[np.abs(beyond) <= FITS * pitches].tolist()
        for k in np.flatnonzero(beyond[:-1] * beyond[1:] < 0):
            is_before = lambda x, sign=beyond[k]: bool((self._length_at(x) - pitches) * sign > 0)  # noqa: E731
            distance = last_fit(is_before, distances[k], distances[k + 1])
            # Between two ranges the length jumps.
            found += [distance] * bool(abs(self._length_at(distance) - pitches) <= FITS * pitches)
        if not found:
            least, most = (lengths.min(), lengths.max()) if len(lengths) else (np.nan, np.nan)
            limit, words = (least, "at least") if pitches < least else (most, "at most")
            problem = f"found {pitches:g}"
            raise DesignError("pitches", problem, f"give {words} {limit:.6g}", "out-of-range", float(limit))
        distance = min(found, key=lambda x: abs(x - self._distance))
        moved = replace(self.wheels[-1], centre=complex(self._centres[0] + self._line * distance))
        return replace(self, wheels=(*self.wheels[:-1], moved))

    @property
    def _distance(self) -> float:
        return float(abs(self._centres[-1] - self._centres[0]))

    @property
    def _line(self) -> complex:
        """Direction from the first wheel to the last one."""
        return complex((self._centres[-1] - self._centres[0]) / self._distance)

    @cached_property
    def _rooms(self) -> Real:
        """Least distances of the last wheel from the others, mm."""
        return np.array([wheel.room + self.wheels[-1].room for wheel in self.wheels[:-1]])

    def _length_at(self, distance: Real | float) -> Real:
        """Length, pitches, with the last wheel at distances from the first, mm; nan if the wheels overlap."""
        at = self._centres[0] + self._line * np.asarray(distance)
        others = np.broadcast_to(self._centres[:-1], (*at.shape, len(self._rooms)))
        is_free = (np.abs(others - at[..., None]) >= self._rooms * (1 - 1e-12)).all(axis=-1)
        return np.where(is_free, self._length(np.concatenate([others, at[..., None]], -1)), np.nan)

    def _free_distances(self, pitches: float) -> Real:
        """Distances of the last wheel from the first, mm, rising, with the ends of the free ranges."""
        least = float(self._rooms[0])
        most = WIDEST_RANGE * (self._distance + float(self._rooms.max()) + pitches * self.pitch)
        tried = np.unique(np.append(least * np.geomspace(1, most / least, TRIED), self._distance))
        known = np.isfinite(self._length_at(tried))
        edges = [
            last_fit(lambda x: bool(np.isfinite(self._length_at(x))), *tried[[k, k + 1] if known[k] else [k + 1, k]])
            for k in np.flatnonzero(known[1:] != known[:-1])
        ]
        return np.unique(np.concatenate([tried[known], edges]))
