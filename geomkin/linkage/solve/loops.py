"""Bodies that no dyad places: all their loop equations at once, from an estimate, followed from there."""

from __future__ import annotations

import cmath
from functools import cached_property

import numpy as np

from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Real, Whole, direction_deg
from ..linkage import Linkage
from .continuation import Equations, Trace, approached, polished, solved
from .loop_equations import LoopEquations, State
from .placement import Coefficients, Placement, Poses

# How far drives may be from the first one, rad, or sizes of the linkage where the driver slides: a path is followed
# in steps of about a twentieth of that unit, a third of a millisecond each. Farther, and a slip of units takes minutes.
FARTHEST = 80 * np.pi


@record(eq=False)
class Loops(Placement):
    """`waiting` bodies by their joints to each other and to `placed` ones.

    turns: whether the driver does, rather than slide. follow: whether the placed bodies keep a smooth continuation.
    The first frame starts from the linkage's estimate of its pins; every other one is the pose that the motion
    leads to from there, whatever frames lie between. Drives beyond the first limit on the way are open.
    """

    linkage: Linkage
    waiting: tuple[str, ...]
    oriented: frozenset[str]
    placed: frozenset[str]
    turns: bool
    follow: bool

    def __post_init__(self) -> None:
        if self.linkage.is_batch:
            raise DesignError("bodies", "found arrays in a linkage that is no chain of dyads", "give one at a time")
        rows, columns = self.equations.rows, len(self.equations.columns)
        # Never more: the count is right as a whole, and the bodies that are placed have all the joints that this takes.
        if rows < columns:
            raise DesignError(
                "bodies",
                f"{', '.join(self.waiting)} have {rows} conditions for {columns} freedoms, so they are loose",
                "join them to more bodies, and take away as much elsewhere",
            )
        lacking = [pin for pin in self._waiting_pins if pin not in self.linkage.estimate]
        if lacking:
            raise DesignError(
                "estimate",
                f"{', '.join(self.waiting)} are no chain of dyads and need a start; missing: {', '.join(lacking)}",
                "give roughly where each of these pins is when the driver is at its first position",
            )

    def __getstate__(self) -> dict[str, object]:
        # A path holds functions, which no copy in another process can have.
        return {name: value for name, value in self.__dict__.items() if name != "_last_trace"}

    @cached_property
    def equations(self) -> LoopEquations:
        """What the joints ask of the waiting bodies."""
        return LoopEquations(self.linkage, self.waiting, self.oriented, self.placed)

    @property
    def _waiting_pins(self) -> list[str]:
        return [p for p, bodies in self.linkage.pins.items() if not set(bodies) - set(self.waiting)]

    @cached_property
    def _unit(self) -> float:
        """The drive's unit in a trace, rad or mm, in which it compares with the other unknowns."""
        return 1.0 if self.turns else self.equations.size

    def place(self, p0: Poses, branch: Whole | int) -> None:
        q = p0.drive
        state = self.equations.gathered(p0, len(q))
        found = np.full((len(q), len(self.equations.columns)), np.nan)
        if len(q):
            far = float(np.abs(q - q[0]).max())
            if far > FARTHEST * self._unit:
                raise DesignError(
                    "drive",
                    f"goes {far:.6g} from its first value in a linkage that is no chain of dyads",
                    f"give drives within {FARTHEST * self._unit:.6g} of the first",
                )
            trace = self._trace(p0, state)
            if trace is not None:
                found = trace.at(q / self._unit)
        origin, turn = self.equations.posed(state, found)
        for name in self.waiting:
            k = self.equations.names.index(name)
            p0.origin[name], p0.turn[name] = origin[:, k], turn[:, k]

    def _trace(self, p0: Poses, state: State) -> Trace | None:
        """The path through the pose of the first frame; None where the estimate leads to no pose."""
        here = state[0][:1], state[1][:1]
        # Kept, and none but the last one: curves and searches ask for the same path hundreds of times. What is
        # followed to the first frame is known no further than the row goes.
        row = (float(p0.drive.min()), float(p0.drive.max())) if self.follow else ()
        key = (float(p0.drive[0]), here[0].tobytes(), here[1].tobytes(), *row)
        if key in self._last_trace:
            return self._last_trace[key]
        equations, drive = self._between(p0), p0.drive[:1] / self._unit
        told = np.append(self._start(here), drive)[None]
        start = approached(equations, told)
        if not np.isfinite(start).all():
            # A hollow on the way to no pose, which whole steps may leap.
            start = polished(equations, told)
        # Angles may have gone round and round on the way.
        turns = np.array([axis == "angle" for _, axis in self.equations.columns]) * np.round(start / (2 * np.pi))
        if np.any(turns):
            start = polished(equations, np.append(start - 2 * np.pi * turns, drive)[None])
        trace = Trace(equations, np.append(start, drive)) if np.isfinite(start).all() else None
        self._last_trace.clear()
        self._last_trace[key] = trace
        return trace

    @cached_property
    def _last_trace(self) -> dict[tuple[object, ...], Trace | None]:
        return {}

    def _between(self, p0: Poses) -> Equations:
        """The conditions and their slopes by unknowns and drive, whatever the drive."""
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
        """A body's points in its frame, and where it is half of an actuator those of the other half."""
        points, driven = {p: complex(z) for p, z in self.linkage.bodies[body].items()}, self.equations.driven
        if driven and body in (driven.body, driven.along):
            other = driven.along if body == driven.body else driven.body
            drive = float(state[0][0, -1].real)
            points |= {p: complex(driven.seen(other, z, drive)) for p, z in self.linkage.bodies[other].items()}
        return points

    def _start(self, state: State) -> Real:
        """Unknowns of the first frame from the estimate of the pins."""
        names, size = self.equations.names, self.equations.size
        # A few points each: as plain numbers in a fifth of the time that rows of them take.
        ahead, origin, frame = direction_deg(self.linkage.ground_angle_deg), complex(self.linkage.origin), state[0][0]
        turns = state[1][0]
        pins = {p: (complex(z) - origin) * complex(ahead).conjugate() for p, z in self.linkage.estimate.items()}
        for pin, bodies in self.linkage.pins.items():
            for body in set(bodies) & self.placed:
                k = names.index(body)
                pins[pin] = complex(frame[k]) + complex(turns[k]) * complex(self.linkage.bodies[body][pin])
        values: list[float] = []
        for name in self.waiting:
            points = [(z, pins[p]) for p, z in self._points(name, state).items() if p in pins]
            direction = complex(turns[names.index(name)])
            if name not in self.oriented:
                own, seen = _mean([z for z, _ in points]), _mean([z for _, z in points])
                direction = sum(((z - own).conjugate() * (there - seen) for z, there in points), 0j)
                direction = direction / abs(direction) if direction != 0 else 1 + 0j
            place = _mean([there - direction * z for z, there in points])
            values += [place.real / size, place.imag / size]
            values += [] if name in self.oriented else [cmath.phase(direction)]
        return np.array(values)

    def reached(self, p0: Poses) -> Complex | None:
        return p0.origin[self.waiting[0]]

    def transmission_angle(self, p0: Poses) -> Real | None:
        return self.equations.transmission_angle(self.equations.gathered(p0, len(p0.origin[self.waiting[0]])))

    def _derivative(self, poses: Poses, orders: tuple[Coefficients, ...]) -> None:
        """The waiting bodies' derivatives: linear equations whose right side is what the others' motion does."""
        known: tuple[Poses | Coefficients, ...] = (poses, *orders)
        states = [self.equations.gathered(p, len(poses.drive)) for p in known]
        ends = self.equations.ends(states[0])
        right = -self.equations.conditions(len(orders), states, ends)
        moved = self.equations.moving(solved(self.equations.jacobian(states[0], ends), right))
        for name in self.waiting:
            k = self.equations.names.index(name)
            orders[-1].origin[name] = states[-1][0][:, k] + moved[0][:, k]
            orders[-1].turn[name] = states[-1][1][:, k] + moved[1][:, k]

    def first(self, p0: Poses, p1: Coefficients) -> None:
        self._derivative(p0, (p1,))

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        self._derivative(p0, (p1, p2))


def _mean(points: list[complex]) -> complex:
    """Of a few points; of none the origin."""
    return sum(points) / len(points) if points else 0j
