"""The equations of bodies whose loops are solved together: the conditions of their joints, and their Jacobian."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

import numpy as np

from ...core.records import record
from ...plane.vec import Array, Complex, Mask, Real, Whole
from ..joints.slide import AbstractSlide, Slider
from ..linkage import Linkage
from .placement import Coefficients, Poses

# Origins, mm, and directions of all bodies, (..., bodies): unit complex, or derivatives of the angle.
State = tuple[Complex, Array]
# Origins of bodies, mm, and arms from them, mm.
Ends = tuple[Complex, Complex]
# Indices: a slice if they are evenly spaced, which is five times faster, or an array.
Places = slice | Whole


@record(eq=False)
class LoopEquations:
    """Conditions of the joints of `waiting` bodies, and the unknowns that satisfy them.

    Unknown are each waiting body's position and, unless it is `oriented`, its angle; `placed` bodies are known. Lengths
    are in units of `size`, so that they compare with angles in rad for any size of linkage.
    """

    linkage: Linkage
    waiting: tuple[str, ...]
    oriented: frozenset[str]
    placed: frozenset[str]

    @cached_property
    def names(self) -> list[str]:
        """The bodies, and last the drive of an actuator among them, which counts as a placed body: its origin is q."""
        return [*self.linkage.bodies, *([self.driven.name] if self.driven else [])]

    @cached_property
    def _number(self) -> dict[str, int]:
        return {name: k for k, name in enumerate(self.names)}

    @cached_property
    def driven(self) -> Slider | None:
        """The driven slider if both its bodies are waiting."""
        slider = self.linkage.driven_slider
        return slider if slider and {slider.body, slider.along} <= set(self.waiting) else None

    @cached_property
    def size(self) -> float:
        """The largest distance named by the linkage, mm."""
        return float(self.linkage.size) or 1.0

    @cached_property
    def columns(self) -> list[tuple[int, str]]:
        """The unknowns: body and coordinate."""
        return [
            (self.names.index(b), axis)
            for b in self.waiting
            for axis in (("x", "y") if b in self.oriented else ("x", "y", "angle"))
        ]

    @property
    def rows(self) -> int:
        """Number of conditions."""
        return 2 * len(self._pins[0]) + len(self._rails[0]) + int(self._rails[-1].sum()) + bool(self.driven)

    @cached_property
    def _chains(self) -> list[tuple[str, list[str]]]:
        """Each pin with the bodies that it joins, a placed one first."""
        chains = []
        for pin, bodies in self.linkage.pins.items():
            waiting = [b for b in bodies if b in self.waiting]
            if waiting:
                chains.append((pin, [b for b in bodies if b in self.placed][:1] + waiting))
        return chains

    @cached_property
    def _pins(self) -> tuple[Whole, Complex, Whole, Complex]:
        """Pairs of points that must coincide: bodies, places, bodies, places."""
        pairs = [(one, two, pin) for pin, chain in self._chains for one, two in pairwise(chain)]
        ends = [[(self.names.index(p[k]), self.linkage.bodies[p[k]][p[2]]) for p in pairs] for k in (0, 1)]
        one, two = ([np.array([e[k] for e in end], dtype=(int, complex)[k]) for k in (0, 1)] for end in ends)
        return one[0], one[1], two[0], two[1]

    @cached_property
    def _slides(self) -> list[AbstractSlide]:
        return [slide for slide in self.linkage.slides if {*slide.bodies} & {*self.waiting}]

    @cached_property
    def _rails(self) -> tuple[Whole, Complex, Whole, Complex, Complex, Complex, Mask]:
        """Slides: body, its point, guide, the line's point and direction, the body's rotation, if it is unknown."""
        slides = self._slides
        return (
            np.array([self.names.index(s.body) for s in slides], dtype=int),
            np.array([s.point for s in slides], dtype=complex),
            np.array([self.names.index(s.along) for s in slides], dtype=int),
            np.array([s.through for s in slides], dtype=complex),
            np.array([s.direction for s in slides], dtype=complex),
            np.array([s.direction * np.exp(1j * np.radians(s.sizes.get("angle_deg", 0.0))) for s in slides], complex),
            np.array([s.is_aligned and not {*s.bodies} & self.oriented for s in slides], dtype=bool),
        )

    @cached_property
    def _ends(self) -> tuple[Whole, Complex]:
        """All points that joints keep together, bodies and places: both of every pin, then of every slider."""
        one, z1, two, z2 = self._pins
        body, z, guide, through = self._rails[:4]
        return np.concatenate([one, two, body, guide]), np.concatenate([z1, z2, z, through])

    @cached_property
    def _parts(self) -> tuple[slice, slice, slice, slice]:
        """Slices of the ends that belong to the pins and to the slides."""
        pins, rails = len(self._pins[0]), len(self._rails[0])
        ends = np.cumsum([0, pins, pins, rails, rails]).tolist()
        return slice(*ends[0:2]), slice(*ends[1:3]), slice(*ends[2:4]), slice(*ends[3:5])

    def ends(self, state: State) -> Ends:
        """Points that joints keep together: their bodies' origins, and the arms from there to them, (..., points)."""
        bodies, places = self._ends
        return state[0].take(bodies, axis=-1), state[1].take(bodies, axis=-1) * places

    def conditions(self, order: int, states: list[State], ends: Ends) -> Real:
        """Closure errors of all joints, (..., rows), or their derivatives of an order.

        states: the pose and its derivatives up to that order; ends: those of the pose.
        """
        bodies, (origins, arms) = self._ends[0], ends

        def points(k: int) -> Complex:
            if k == 0:
                position: Complex = origins + arms
                return position
            h = states[1][1].take(bodies, axis=-1)
            if k == 1:
                return states[1][0].take(bodies, axis=-1) + 1j * h * arms
            second: Complex = (1j * states[2][1].take(bodies, axis=-1) - h**2) * arms
            return states[2][0].take(bodies, axis=-1) + second

        one, two, sliding, guiding = self._parts
        highest = points(order)
        pins = highest[..., one] - highest[..., two]
        at_pins: Real = np.concatenate([pins.real, pins.imag], axis=-1) / self.size
        body, _, guide, _, direction, turn, both = self._rails
        if not len(body):
            return at_pins
        line = np.conj(states[0][1][..., guide] * direction)
        apart = [z[..., sliding] - z[..., guiding] for z in (*map(points, range(order)), highest)]
        if order == 0:
            relative = line * apart[0]
        elif order == 1:
            relative = line * (apart[1] - 1j * states[1][1][..., guide] * apart[0])
        else:
            h, h2 = states[1][1][..., guide], states[2][1][..., guide]
            relative = line * (apart[2] - 2j * h * apart[1] - (1j * h2 + h**2) * apart[0])
        rotations = states[order][1][..., body[both]], states[order][1][..., guide[both]]
        # The angle, since its sine would accept a body that is turned by 180 deg.
        misalignment = (
            np.angle(rotations[0] * np.conj(rotations[1] * turn[both])) if order == 0 else rotations[0] - rotations[1]
        )
        rows: list[Array] = [at_pins, relative.imag / self.size, misalignment]
        if self.driven:
            along = relative.real[..., self._slides.index(self.driven)] - states[order][0][..., -1].real
            rows.append(along[..., None] / self.size)
        return np.concatenate(rows, axis=-1)

    def jacobian(self, state: State, ends: Ends) -> Real:
        """d(conditions)/d(unknowns), (..., rows, columns)."""
        _, _, sliding, guiding = self._parts
        origin, rotated = ends
        arms: Complex = 1j * rotated
        blocks: list[Array] = [arms]
        if len(self._rails[0]):
            line = np.conj(state[1][..., self._rails[2]] * self._rails[4])
            apart = (origin[..., sliding] + rotated[..., sliding]) - (origin[..., guiding] + rotated[..., guiding])
            blocks += [line * self.size, line * (self.size * 1j), line * arms[..., sliding]]
            blocks.append(line * (arms[..., guiding] + 1j * apart))
        fixed, row, column, part, length = self._slopes
        slopes: Real = np.empty((*state[0].shape[:-1], *fixed.shape))
        slopes[...] = fixed
        parts = np.concatenate(blocks, axis=-1) if len(blocks) > 1 else np.ascontiguousarray(arms)
        slopes[..., row, column] = parts.view(float).take(part, axis=-1) / length
        return slopes

    @cached_property
    def _slopes(self) -> tuple[Real, Whole, Whole, Whole, Real]:
        """The Jacobian's constants; for the other elements row, column, index into the blocks, and divisor."""
        constant, variable, pins, first = (
            np.zeros((self.rows, len(self.columns))),
            [],
            len(self._pins[0]),
            len(self._ends[0]),
        )
        column = {unknown: k for k, unknown in enumerate(self.columns)}
        for k, pair in enumerate(zip(self._pins[0].tolist(), self._pins[2].tolist())):
            for end, (body, sign) in enumerate(zip(pair, (1, -1))):
                for part, axis in enumerate("xy"):
                    row = k + part * pins
                    if (body, axis) in column:
                        constant[row, column[body, axis]] = sign
                    if (body, "angle") in column:
                        variable.append((row, column[body, "angle"], 2 * (k + end * pins) + part, sign))
        rails, guides, both = self._rails[0].tolist(), self._rails[2].tolist(), self._rails[-1]
        for k, pair in enumerate(zip(rails, guides)):
            # The condition across the line, and for the driven slider also the one along it.
            targets = [(2 * pins + k, 1)] + [(self.rows - 1, 0)] * (self._slides[k] is self.driven)
            for end, (body, sign) in enumerate(zip(pair, (1, -1))):
                for k_axis, axis in enumerate(("x", "y", "angle")):
                    if (body, axis) in column:
                        of = first + (k_axis + (end if axis == "angle" else 0)) * len(rails) + k
                        variable += [(row, column[body, axis], 2 * of + part, sign) for row, part in targets]
                if both[k]:
                    constant[2 * pins + len(rails) + int(both[:k].sum()), column[body, "angle"]] = sign
        rows, columns, parts, signs = (np.array([one[k] for one in variable], dtype=int) for k in range(4))
        return constant, rows, columns, parts, signs * self.size

    @cached_property
    def _unknowns(self) -> tuple[tuple[Places, Places], ...]:
        """For x, y and the angle: the columns of these unknowns, and their bodies."""
        by_axis = [[(k, body) for k, (body, a) in enumerate(self.columns) if a == axis] for axis in ("x", "y", "angle")]
        pairs = [np.array(indices, dtype=int).reshape(-1, 2).T for indices in by_axis]
        return tuple((_places(columns), _places(bodies)) for columns, bodies in pairs)

    def moving(self, rates: Real) -> State:
        """Velocities of bodies, (..., bodies), if only the unknowns change, at `rates`, (..., columns)."""
        shape = (*rates.shape[:-1], len(self.names))
        origin, rotation, (x, y, angle) = np.zeros(shape, dtype=complex), np.zeros(shape), self._unknowns
        lengths = self.size * rates
        origin.real[..., x[1]], origin.imag[..., y[1]] = lengths[..., x[0]], lengths[..., y[0]]
        rotation[..., angle[1]] = rates[..., angle[0]]
        return origin, rotation

    def posed(self, state: State, unknowns: Real) -> State:
        """A state with the unknowns, (..., columns), written into it."""
        origin, direction, (x, y, angle) = state[0].copy(), state[1].copy(), self._unknowns
        lengths = self.size * unknowns
        origin.real[..., x[1]], origin.imag[..., y[1]] = lengths[..., x[0]], lengths[..., y[0]]
        direction[..., angle[1]] = np.exp(1j * unknowns[..., angle[0]])
        return origin, direction

    def gathered(self, p: Poses | Coefficients, frames: int) -> State:
        """Origins and directions, or their derivatives, of all bodies; zero where a body is not known yet."""
        origin = np.zeros((frames, len(self.names)), dtype=complex)
        rotation = np.zeros((frames, len(self.names)), dtype=complex if isinstance(p, Poses) else float)
        angles = p.direction if isinstance(p, Poses) else p.theta_prime
        for known, into in ((angles, rotation), (p.origin, origin)):
            for name, values in known.items():
                # The drive of an actuator that is elsewhere in the linkage is not needed here.
                if name in self._number:
                    into[:, self._number[name]] = values
        return origin, rotation

    def transmission_angle(self, state: State) -> Real:
        """Smallest angle over the joints, rad, (frames,), between the directions in which their sides let them move.

        Derived here. It equals the transmission angle at a dyad's inner joint, wherever the dyad is, and pi/2 less the
        pressure angle at a bar that pushes a point. It is zero exactly if the linkage locks, and depends neither on
        lengths of levers, nor on units, nor on the bodies' frames.

        Open one joint by a small e with the driver held: that moves the linkage by the inverse of the Jacobian. At a
        pin the ends then move by v1 e and v2 e, v1 - v2 = 1. Such pairs of velocities, and those that the pin allows,
        v1 = v2, are two planes, whose smallest angle is half the reported angle mu: cos mu = 1 - 1/s^2, s the largest
        singular value of v1 over v2; pi/2, the maximum, if s is less than 1. At a slider both bodies move along one
        direction relative to each other, and mu is its angle from the line.
        """
        least = np.full(len(state[0]), np.nan)
        known = np.isfinite(state[0]).all(axis=-1) & np.isfinite(state[1]).all(axis=-1)
        closed = state[0][known], state[1][known]
        jacobian = self.jacobian(closed, self.ends(closed))
        regular = np.linalg.slogdet(jacobian)[0] != 0
        closed = closed[0][regular], closed[1][regular]
        # Rows: motion of all bodies if one condition alone is missed by 1.
        missed = np.swapaxes(np.linalg.inv(jacobian[regular]), -1, -2)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            angles = [
                np.full(len(missed), 0.5 * np.pi),
                *self._at_pins(closed, missed),
                *self._at_rails(closed, missed),
            ]
        least[np.flatnonzero(known)[regular]] = np.nan_to_num(np.min(angles, axis=0), nan=0.0)
        least[np.flatnonzero(known)[~regular]] = 0.0
        return least

    def _at_pins(self, state: State, missed: Real) -> list[Real]:
        pairs, angles, first = len(self._pins[0]), [], 0
        for pin, chain in self._chains:
            for k in range(1 if len(chain) == 2 else 0, len(chain)):
                # Body k of the chain leaves the others: the pairs before and after it open in opposite directions.
                lone = sum(
                    sign * missed[:, [first + pair, pairs + first + pair]]
                    for pair, sign in ((k - 1, -1), (k, 1))
                    if 0 <= pair < len(chain) - 1
                )
                moves = self.moving(np.asarray(lone))
                velocities = [self._velocity(state, moves, self.names.index(b), complex(self.linkage.bodies[b][pin]))
                        for b in (chain[k], chain[k - 1 if k else 1])]  # fmt: skip
                one = sum(np.abs(w[:, 0]) ** 2 for w in velocities)
                two = sum(np.abs(w[:, 1]) ** 2 for w in velocities)
                both = sum(np.real(np.conj(w[:, 0]) * w[:, 1]) for w in velocities)
                square = 0.5 * (one + two) + np.hypot(0.5 * (one - two), both)
                sine = np.sqrt(np.maximum(2 - 1 / square, 0) / square)
                angles.append(np.arctan2(sine, 1 - 1 / square))
            first += len(chain) - 1
        return angles

    def _at_rails(self, state: State, missed: Real) -> list[Real]:
        angles = []
        for k, (body, z, guide, through, direction, _, _) in enumerate(zip(*self._rails)):
            moves = self.moving(missed[:, [2 * len(self._pins[0]) + k]])
            ends = [state[0][:, b] + state[1][:, b] * p for b, p in ((body, z), (guide, through))]
            apart = self._velocity(state, moves, body, z) - self._velocity(state, moves, guide, through)
            rotation = (1j * moves[1][:, 0, guide] * (ends[0] - ends[1]) / self.size)[:, None]
            along = np.conj(state[1][:, guide] * direction) * (apart - rotation)[:, 0]
            angles.append(np.arctan2(1.0, np.abs(along.real)))
        return angles

    def _velocity(self, state: State, moves: State, body: int, z: complex) -> Complex:
        """Velocity of a point, in units of size, (frames, moves)."""
        return (moves[0][..., body] + 1j * moves[1][..., body] * (state[1][:, body] * z)[:, None]) / self.size


def _places(which: Whole) -> Places:
    steps = {*np.diff(which).tolist()} or {1}
    step = steps.pop()
    even = len(which) and not steps and step > 0
    return slice(int(which[0]), int(which[-1]) + 1, step) if even else which
