"""Bodies that no dyad places: all their loop equations at once, by Newton-Raphson from an estimate, continued."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import DesignError
from ..plane.vec import Array, direction_deg
from .linkage import Linkage, Slider
from .newton import newton_raphson
from .steps import Pass, Step

# Largest share of a step's own motion that its prediction may miss: more, and the solution found may be on
# another branch than the one the step started from.
ASTRAY = 0.5


@dataclass(frozen=True, eq=False)
class Loops(Step):
    """`waiting` bodies by their joints to each other and to `placed` ones; `oriented` ones keep their direction.

    Unknown are the place of each waiting body and the angle of those that are not oriented. The first frame
    starts from the linkage's estimate of its pins, every other one from the frame before it and its
    derivatives, so frames must be near each other. From a frame that does not converge on, all are open.
    """

    linkage: Linkage
    waiting: tuple[str, ...]
    oriented: frozenset[str]
    placed: frozenset[str]

    def __post_init__(self) -> None:
        shape = np.broadcast_shapes(*(np.shape(z) for points in self.linkage.bodies.values() for z in points.values()))
        if shape:
            raise DesignError("bodies", "found arrays in a linkage that is no chain of dyads", "give one at a time")
        if len(self._rows) != len(self._columns):
            many = len(self._rows) > len(self._columns)
            raise DesignError(
                "bodies",
                f"{', '.join(self.waiting)} have {len(self._rows)} conditions for {len(self._columns)} freedoms, so "
                f"they are {'locked' if many else 'loose'}",
                "take a bar or a pin away there and add one elsewhere" if many else "join them to more bodies",
            )
        lacking = [pin for pin in self._waiting_pins if pin not in self.linkage.estimate]
        if lacking:
            raise DesignError(
                "estimate",
                f"{', '.join(self.waiting)} are no chain of dyads and need a start; missing: {', '.join(lacking)}",
                "give roughly where each of these pins is when the driver is at its first position",
            )

    @property
    def _waiting_pins(self) -> list[str]:
        return [p for p, bodies in self.linkage.pins.items() if not set(bodies) - set(self.waiting)]

    @cached_property
    def _names(self) -> list[str]:
        """The bodies, and last the drive of an actuator among them, which counts as placed: its origin is q."""
        return [*self.linkage.bodies, *([self._driven.name] if self._driven else [])]

    @cached_property
    def _driven(self) -> Slider | None:
        """The driven slider where both its bodies are here."""
        slider = self.linkage.driven_slider
        return slider if slider and {slider.body, slider.along} <= set(self.waiting) else None

    @cached_property
    def _columns(self) -> list[tuple[int, str]]:
        """The unknowns: body and which coordinate of it."""
        return [
            (self._names.index(b), axis)
            for b in self.waiting
            for axis in (("x", "y") if b in self.oriented else ("x", "y", "angle"))
        ]

    @cached_property
    def _pins(self) -> list[tuple[int, complex, int, complex]]:
        """Pairs of points that must meet: body, place, body, place."""
        pairs = []
        for pin, bodies in self.linkage.pins.items():
            standing = [b for b in bodies if b in self.placed]
            chain = standing[:1] + [b for b in bodies if b in self.waiting]
            for one, two in zip(chain[:-1], chain[1:]):
                places = [self.linkage.bodies[b][pin] for b in (one, two)]
                pairs.append((self._names.index(one), places[0], self._names.index(two), places[1]))
        return pairs

    @cached_property
    def _rails(self) -> list[tuple[int, complex, int, complex, complex, complex, bool]]:
        """Sliders here: body, its point, guide, the line's point and direction, the body's turn, if it is unknown.

        The driven one comes last.
        """
        return [
            (
                self._names.index(s.body), s.point, self._names.index(s.along), s.through, complex(s.direction),
                complex(s.direction * np.exp(1j * np.radians(s.angle_deg))), not {s.body, s.along} & self.oriented,
            )
            for s in sorted(self.linkage.sliders, key=lambda s: s is self._driven)
            if {s.body, s.along} & set(self.waiting)
        ]  # fmt: skip

    @cached_property
    def _rows(self) -> list[str]:
        rails = [r for rail in self._rails for r in ["off"] + ["turn"] * rail[-1]]
        return ["x", "y"] * len(self._pins) + rails + ["along"] * bool(self._driven)

    def _conditions(self, order: int, states: list[tuple[Array, Array]]) -> Array:
        """The conditions, (frames, rows), or their derivative of an order, from (frames, bodies) origins and turns."""

        def at(body: int, z: complex, k: int) -> Array:
            arm = states[0][1][:, body] * z
            if k == 0:
                return states[0][0][:, body] + arm
            h = states[1][1][:, body]
            if k == 1:
                return states[1][0][:, body] + 1j * h * arm
            return states[2][0][:, body] + (1j * states[2][1][:, body] - h**2) * arm

        rows: list[Array] = []
        for one, z1, two, z2 in self._pins:
            apart = at(one, z1, order) - at(two, z2, order)
            rows += [apart.real, apart.imag]
        for body, z, guide, through, direction, turn, both in self._rails:
            line = np.conj(states[0][1][:, guide] * direction)
            apart = [at(body, z, k) - at(guide, through, k) for k in range(order + 1)]
            if order == 0:
                off = line * apart[0]
            elif order == 1:
                off = line * (apart[1] - 1j * states[1][1][:, guide] * apart[0])
            else:
                h, h2 = states[1][1][:, guide], states[2][1][:, guide]
                off = line * (apart[2] - 2j * h * apart[1] - (1j * h2 + h**2) * apart[0])
            rows.append(off.imag)
            if both:
                turns = states[order][1]
                sine = np.imag(np.conj(turns[:, guide] * turn) * turns[:, body]) if order == 0 else None
                rows.append(turns[:, body] - turns[:, guide] if sine is None else sine)
        if self._driven:
            rows.append(off.real - states[order][0][:, -1].real)
        return np.stack(rows, axis=1)

    def _jacobian(self, state: tuple[Array, Array]) -> Array:
        """d(conditions)/d(unknowns), (frames, rows, columns): the first derivative where one unknown alone moves."""
        still = np.zeros(state[0].shape, dtype=complex), np.zeros(state[0].shape)
        columns = []
        for body, axis in self._columns:
            origin, turn = still[0].copy(), still[1].copy()
            if axis == "angle":
                turn[:, body] = 1
            else:
                origin[:, body] = 1 if axis == "x" else 1j
            columns.append(self._conditions(1, [state, (origin, turn)]))
        return np.stack(columns, axis=2)

    def _gather(self, p: Pass, order: int, frames: int) -> tuple[Array, Array]:
        """Origins and turns of all bodies as arrays (frames, bodies); zero where a body is not known yet."""
        origin = np.zeros((frames, len(self._names)), dtype=complex)
        turn = np.zeros((frames, len(self._names)), dtype=complex if order == 0 else float)
        for k, name in enumerate(self._names):
            if name in p.origin:
                origin[:, k] = p.origin[name]
            if name in p.turn:
                turn[:, k] = p.turn[name]
        return origin, turn

    def _with(self, state: tuple[Array, Array], unknowns: Array) -> tuple[Array, Array]:
        """A state, (frames, bodies), with the unknowns, (frames, columns), written into it."""
        origin, turn = state[0].copy(), state[1].copy()
        for k, (body, axis) in enumerate(self._columns):
            if axis == "x":
                origin[:, body] = unknowns[:, k] + 1j * unknowns[:, k + 1]
            elif axis == "angle":
                turn[:, body] = np.exp(1j * unknowns[:, k])
        return origin, turn

    def _points(self, body: str, state: tuple[Array, Array]) -> dict[str, complex]:
        """A body's points in its frame, and where it is half of an actuator those of the other half."""
        points = dict(self.linkage.bodies[body])
        if self._driven and body in (self._driven.body, self._driven.along):
            other = self._driven.along if body == self._driven.body else self._driven.body
            drive = float(state[0][0, -1].real)
            points |= {p: complex(self._driven.seen(other, z, drive)) for p, z in self.linkage.bodies[other].items()}
        return points

    def _start(self, state: tuple[Array, Array]) -> Array:
        """Unknowns of the first frame from the estimate of the pins."""
        ahead = direction_deg(self.linkage.ground_angle_deg)
        pins = {p: (z - self.linkage.origin) * np.conj(ahead) for p, z in self.linkage.estimate.items()}
        for one, z1, _, _ in self._pins:
            if self._names[one] in self.placed:
                place = state[0][0, one] + state[1][0, one] * z1
                pins |= {p: place for p, z in self.linkage.bodies[self._names[one]].items() if z == z1}
        values: list[float] = []
        for name in self.waiting:
            points = {p: z for p, z in self._points(name, state).items() if p in pins}
            own = np.array(list(points.values()), dtype=complex)
            seen = np.array([pins[p] for p in points], dtype=complex)
            direction = state[1][0, self._names.index(name)]
            if name not in self.oriented:
                direction = np.sum(np.conj(own - own.mean()) * (seen - seen.mean()))
                direction = direction / abs(direction) if direction != 0 else 1.0
            place = (seen - direction * own).mean()
            values += [place.real, place.imag] + ([] if name in self.oriented else [float(np.angle(direction))])
        return np.array(values)

    def place(self, p0: Pass, branch: Array | int) -> None:
        q = p0.drive
        frames = len(q)
        state = self._gather(p0, 0, frames)
        size = max(abs(z) for points in self.linkage.bodies.values() for z in points.values())
        found = np.full((frames, len(self._columns)), np.nan)
        guess = self._start(state)
        for k in range(frames):
            here = state[0][k : k + 1], state[1][k : k + 1]
            step = q[k] - q[k - 1] if k else 0.0
            if k > 1 and q[k - 1] != q[k - 2]:
                guess = found[k - 1] + (found[k - 1] - found[k - 2]) * (step / (q[k - 1] - q[k - 2]))
            root = newton_raphson(
                lambda u, here=here: self._conditions(0, [self._with(here, u[None])])[0],  # type: ignore[misc]
                lambda u, here=here: self._jacobian(self._with(here, u[None]))[0],  # type: ignore[misc]
                guess,
            )
            astray = k > 1 and np.abs(root.value - guess).max() > ASTRAY * np.abs(root.value - found[k - 1]).max()
            if not root.converged or root.residual > 1e-9 * size or (astray and step != 0):
                break
            found[k] = guess = root.value
        origin, turn = self._with(state, found)
        p0.kept[self] = origin, turn
        self._scatter(p0, origin, turn)

    def reached(self, p0: Pass) -> Array | None:
        return p0.origin[self.waiting[0]]

    def _scatter(self, p: Pass, origin: Array, turn: Array) -> None:
        for name in self.waiting:
            k = self._names.index(name)
            p.origin[name] = origin[:, k]
            p.turn[name] = turn[:, k]

    def _derivative(self, order: int, passes: list[Pass]) -> None:
        """The waiting bodies' derivatives: linear equations whose right side is what the others' motion does."""
        first = passes[0].kept[self]
        frames = len(first[0])
        states = [first] + [self._gather(p, k + 1, frames) for k, p in enumerate(passes[1:])]
        right = -self._conditions(order, states)
        jacobian = self._jacobian(first)
        known = np.isfinite(right).all(axis=1) & np.isfinite(jacobian).all(axis=(1, 2))
        rates = np.full(right.shape, np.nan)
        with np.errstate(all="ignore"):
            rates[known] = np.linalg.solve(jacobian[known], right[known][..., None])[..., 0]
        origin, turn = states[order]
        for k, (body, axis) in enumerate(self._columns):
            if axis == "x":
                origin[:, body] = rates[:, k] + 1j * rates[:, k + 1]
            elif axis == "angle":
                turn[:, body] = rates[:, k]
        self._scatter(passes[order], origin, turn)

    def first(self, p0: Pass, p1: Pass) -> None:
        self._derivative(1, [p0, p1])

    def second(self, p0: Pass, p1: Pass, p2: Pass) -> None:
        self._derivative(2, [p0, p1, p2])
