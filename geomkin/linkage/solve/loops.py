"""Bodies that are in no dyad: all their loop equations at once, solved from an estimate and followed from there."""

from __future__ import annotations

import cmath
from functools import cached_property

import numpy as np

from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Real, Whole, direction_deg
from ..linkage import Linkage
from .continuation import Equations, Trace, approached, polished_points, solved
from .loop_equations import LoopEquations, State
from .placement import Coefficients, Placement, Poses

# Largest distance of a drive from the first one, rad, or sizes of the linkage if the driver slides. A path is followed
# in steps of about a twentieth of that unit, a third of a millisecond each, so that a mistake in units takes minutes.
FARTHEST = 80 * np.pi


@record(eq=False)
class Loops(Placement):
    """`waiting` bodies, placed by their joints to each other and to `placed` ones.

    turns: whether the driver turns, rather than slides. follow: whether the placed bodies continue smoothly. The first
    frame starts from the linkage's estimate of its pins; every other one is the pose that the motion leads to from
    there, whatever frames lie between. Drives beyond the first limit are open.
    """

    linkage: Linkage
    waiting: tuple[str, ...]
    oriented: frozenset[str]
    placed: frozenset[str]
    turns: bool
    follow: bool

    def __post_init__(self) -> None:
        if self.linkage.is_batch:
            raise DesignError(
                "bodies", "found arrays in a linkage that is not a chain of dyads", "give one at a time", "conflict"
            )
        rows, columns = self.equations.rows, len(self.equations.columns)
        # Never more: the mobility of the whole linkage is right, and the placed bodies have all the joints they need.
        if rows < columns:
            problem = (
                f"{', '.join(self.waiting)} have {rows} conditions for {columns} degrees of freedom: under-constrained"
            )
            raise DesignError("bodies", problem, "join them to more bodies, and remove as many joints elsewhere")
        missing = [pin for pin in self._waiting_pins if pin not in self.linkage.estimate]
        if missing:
            problem = (
                f"{', '.join(self.waiting)} are not a chain of dyads and need a start; missing: {', '.join(missing)}"
            )
            remedy = "give the approximate position of each of these pins with the driver at its first position"
            raise DesignError("estimate", problem, remedy, "missing-key")

    def __getstate__(self) -> dict[str, object]:
        # A trace holds functions, which cannot be pickled.
        return {name: value for name, value in self.__dict__.items() if name != "_last_trace"}

    @cached_property
    def equations(self) -> LoopEquations:
        """The conditions of the joints of the waiting bodies."""
        return LoopEquations(self.linkage, self.waiting, self.oriented, self.placed)

    @property
    def _waiting_pins(self) -> list[str]:
        return [p for p, bodies in self.linkage.joint_points.items() if not set(bodies) - set(self.waiting)]

    @cached_property
    def _unit(self) -> float:
        """Unit of the drive in a trace, rad or mm, in which it is comparable with the other unknowns."""
        return 1.0 if self.turns else self.equations.size

    def place(self, p0: Poses, branch: Whole | int) -> None:
        q = p0.drive
        state = self.equations.gathered(p0, len(q))
        unknowns = np.full((len(q), len(self.equations.columns)), np.nan)
        if len(q):
            distance = float(np.abs(q - q[0]).max())
            if distance > FARTHEST * self._unit:
                problem = f"goes {distance:.6g} from its first value in a linkage that is not a chain of dyads"
                remedy = f"give drives within {FARTHEST * self._unit:.6g} of the first"
                raise DesignError("drive", problem, remedy, "out-of-range")
            trace = self._trace(p0, state)
            if trace is not None:
                unknowns = trace.at(q / self._unit)
        origin, direction = self.equations.posed(state, unknowns)
        for name in self.waiting:
            k = self.equations.names.index(name)
            p0.origin[name], p0.direction[name] = origin[:, k], direction[:, k]

    def _trace(self, p0: Poses, state: State) -> Trace | None:
        """The path through the pose of the first frame; None if the estimate leads to no pose."""
        first_state = state[0][:1], state[1][:1]
        # The last trace is cached, since curves and searches need the same one hundreds of times. A followed branch is
        # known only over the range of the drives, which is then part of the key.
        drive_span = (float(p0.drive.min()), float(p0.drive.max())) if self.follow else ()
        key = (float(p0.drive[0]), first_state[0].tobytes(), first_state[1].tobytes(), *drive_span)
        if key in self._last_trace:
            return self._last_trace[key]
        equations, drive = self._between(p0), p0.drive[:1] / self._unit
        estimate = np.append(self._start(first_state), drive)[None]
        start = approached(equations, estimate)
        if not np.isfinite(start).all():
            # A minimum of the error that is not a pose; whole steps may pass it.
            start = polished_points(equations, estimate)
        # Angles may have grown by whole turns during the iteration.
        turns = np.array([axis == "angle" for _, axis in self.equations.columns]) * np.round(start / (2 * np.pi))
        if np.any(turns):
            start = polished_points(equations, np.append(start - 2 * np.pi * turns, drive)[None])
        trace = Trace(equations, np.append(start, drive)) if np.isfinite(start).all() else None
        self._last_trace.clear()
        self._last_trace[key] = trace
        return trace

    @cached_property
    def _last_trace(self) -> dict[tuple[object, ...], Trace | None]:
        return {}

    def _between(self, p0: Poses) -> Equations:
        """The conditions, and their slopes by unknowns and drive, at any drive."""
        elsewhere = p0.elsewhere
        assert elsewhere is not None

        def at(points: Real) -> tuple[Real, Real]:
            passes = elsewhere(points[:, -1] * self._unit)
            states = [self.equations.gathered(p, len(points)) for p in passes]
            states[0] = self.equations.posed(states[0], points[:, :-1])
            ends = self.equations.ends(states[0])
            by_drive = self._unit * self.equations.conditions(1, states, ends)
            slopes = np.concatenate([self.equations.jacobian(states[0], ends), by_drive[..., None]], axis=-1)
            return self.equations.conditions(0, states, ends), slopes

        return at

    def _points(self, body: str, state: State) -> dict[str, complex]:
        """A body's points in its frame; for half of an actuator also those of the other half."""
        points, driven = {p: complex(z) for p, z in self.linkage.bodies[body].items()}, self.equations.driven
        if driven and body in (driven.body, driven.along):
            other = driven.along if body == driven.body else driven.body
            drive = float(state[0][0, -1].real)
            points |= {
                p: complex(driven.in_other_frame(other, z, drive)) for p, z in self.linkage.bodies[other].items()
            }
        return points

    def _start(self, state: State) -> Real:
        """Unknowns of the first frame from the estimate of the pins."""
        names, size = self.equations.names, self.equations.size
        # Plain numbers, which for a few points are five times faster than arrays.
        origin, origins, directions = complex(self.linkage.origin), state[0][0], state[1][0]
        ground = complex(direction_deg(self.linkage.ground_angle_deg)).conjugate()
        pins = {p: (complex(z) - origin) * ground for p, z in self.linkage.estimate.items()}
        for pin, bodies in self.linkage.joint_points.items():
            for body in set(bodies) & self.placed:
                k = names.index(body)
                pins[pin] = complex(origins[k]) + complex(directions[k]) * complex(self.linkage.bodies[body][pin])
        values: list[float] = []
        for name in self.waiting:
            points = [(z, pins[p]) for p, z in self._points(name, state).items() if p in pins]
            direction = complex(directions[names.index(name)])
            if name not in self.oriented:
                local_mean, mean = _mean([z for z, _ in points]), _mean([z for _, z in points])
                direction = sum(((z - local_mean).conjugate() * (pin - mean) for z, pin in points), 0j)
                direction = direction / abs(direction) if direction != 0 else 1 + 0j
            place = _mean([pin - direction * z for z, pin in points])
            values += [place.real / size, place.imag / size]
            values += [] if name in self.oriented else [cmath.phase(direction)]
        return np.array(values)

    def reached(self, p0: Poses) -> Complex | None:
        return p0.origin[self.waiting[0]]

    def transmission_angle(self, p0: Poses) -> Real:
        return self.equations.transmission_angle(self.equations.gathered(p0, len(p0.origin[self.waiting[0]])))

    def _derivative(self, poses: Poses, orders: tuple[Coefficients, ...]) -> None:
        """The waiting bodies' derivatives, from linear equations whose right side is the motion of the others."""
        known: tuple[Poses | Coefficients, ...] = (poses, *orders)
        states = [self.equations.gathered(p, len(poses.drive)) for p in known]
        ends = self.equations.ends(states[0])
        right = -self.equations.conditions(len(orders), states, ends)
        moved = self.equations.moving(solved(self.equations.jacobian(states[0], ends), right))
        for name in self.waiting:
            k = self.equations.names.index(name)
            orders[-1].origin[name] = states[-1][0][:, k] + moved[0][:, k]
            orders[-1].theta_prime[name] = states[-1][1][:, k] + moved[1][:, k]

    def first(self, p0: Poses, p1: Coefficients) -> None:
        self._derivative(p0, (p1,))

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        self._derivative(p0, (p1, p2))


def _mean(points: list[complex]) -> complex:
    """Mean of a few points; the origin if there are none."""
    return sum(points) / len(points) if points else 0j
