"""The steps of a linkage run over its frames, in blocks, no further than the order asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..plane.vec import Array, cross, direction_deg, dot
from .closure import Driven
from .continued import followed, run
from .dyads import Dyad
from .linkage import Linkage
from .loops import Loops
from .motion import Solution
from .steps import Pass, Step

# Frames worked on at once. Fewer spend their time on calls; more no longer fit a processor's cache.
BLOCK = 16384


@dataclass(frozen=True, eq=False)
class Chain(Solution):
    """A linkage's steps over a row of drives; nothing is worked out before it is asked for.

    signs: the branch of each dyad by its joint; follow: those are where the first frame stands.
    """

    linkage: Linkage
    steps: tuple[Step, ...]
    drive: Array
    signs: Mapping[str, int]
    follow: bool

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """(frames,) or (frames, linkages)."""
        places = (z for points in self.linkage.bodies.values() for z in points.values())
        return (len(self.drive), *np.broadcast_shapes(*(np.shape(z) for z in places)))

    def origin(self, body: str, order: int) -> Array:
        return self._seen(body, order, False)

    def turn(self, body: str, order: int) -> Array:
        return self._seen(body, order, True)

    @cached_property
    def closed(self) -> Array:
        closed = np.ones(self.shape, dtype=bool)
        for step in self.steps:
            reached = step.reached(self._passes(0)[0])
            if reached is not None:
                closed &= np.isfinite(reached)
        return closed

    @cached_property
    def branches(self) -> Mapping[str, Array]:
        found = {}
        for step in self.steps:
            if isinstance(step, Driven):
                with np.errstate(invalid="ignore"):
                    r = step.roots(Pass(drive=self._column(self.drive)), self._branch[step.joint]).r
                sign = np.where(self.closed, np.sign(r), 0)
            elif isinstance(step, Dyad):
                sign = self._branch[step.joint]
            else:
                continue
            found[step.joint] = np.where(self.closed, sign, 0).astype(int)
        return found

    @cached_property
    def transmission_angle(self) -> Array:
        angles = []
        for step in self.steps:
            ways = step.meeting(self._passes(0)[0])
            if ways is not None:
                angles.append(np.arctan2(np.abs(cross(*ways)), np.abs(dot(*ways))))
        least = np.full(self.shape, np.pi / 2)
        for angle in angles:
            least = np.minimum(least, angle)
        return np.where(self.closed, least, np.nan)

    def _column(self, q: Array) -> Array:
        """Drives against all linkages."""
        return q.reshape(-1, *(1,) * (len(self.shape) - 1))

    @cached_property
    def _kept(self) -> dict[int, list[Pass]]:
        return {}

    @cached_property
    def _history(self) -> tuple[list[Pass], Mapping[str, Array | int]] | None:
        """All passes and branches by continuation, for linkages that no formula continues."""
        plain = [step for step in self.steps if isinstance(step, Dyad) and not isinstance(step, Driven)]
        if any(isinstance(step, Loops) for step in self.steps) or (self.follow and plain):
            return followed(self.steps, self.linkage.ground, self.drive, self.signs, self.follow)
        return None

    @cached_property
    def _branch(self) -> Mapping[str, Array | int]:
        """Signs that the steps take: a number, or one per frame where continuation found them."""
        if self._history is not None:
            return self._history[1]
        if not self.follow:
            return self.signs
        return {s.joint: s.sign_from(self.drive, self.signs[s.joint]) for s in self.steps if isinstance(s, Driven)}

    def _passes(self, order: int) -> list[Pass]:
        """Passes up to an order at least, in the fixed body's frame."""
        kept = self._kept
        for k in range(order, 3):
            if k in kept:
                return kept[k]
        kept[order] = self._history[0] if self._history is not None else self._in_blocks(order)
        return kept[order]

    def _in_blocks(self, order: int) -> list[Pass]:
        many = int(np.prod(self.shape[1:]))
        size = max(1, BLOCK // many)
        if len(self.drive) <= size:
            return run(self.steps, self.linkage.ground, self._column(self.drive), self._branch, order)
        whole: list[Pass] = []
        for start in range(0, len(self.drive), size):
            q = self._column(self.drive[start : start + size])
            block = run(self.steps, self.linkage.ground, q, self._branch, order)
            whole = whole or [_room(p, self.shape) for p in block]
            for full, part in zip(whole, block):
                for target, source in ((full.origin, part.origin), (full.turn, part.turn)):
                    for name, values in source.items():
                        if np.ndim(values):
                            target[name][start : start + size] = values
        return whole

    def _seen(self, body: str, order: int, turn: bool) -> Array:
        """Origin or turn as seen from outside the fixed body's frame, at every frame, nan where open."""
        kept = self._kept_seen
        if (body, order, turn) not in kept:
            p = self._passes(order)[order]
            values = np.asarray(p.turn[body] if turn else p.origin[body])
            ahead = complex(direction_deg(self.linkage.ground_angle_deg))
            if ahead != 1 and not (turn and order):
                values = values * ahead
            if order == 0 and not turn and self.linkage.origin != 0:
                values = values + self.linkage.origin
            if turn and order == 0 or not turn:
                values = values.astype(complex, copy=False)
            if body != self.linkage.ground and not self._all_closed:
                values = np.where(self.closed, values, np.nan)
            kept[body, order, turn] = np.broadcast_to(values, self.shape)
        return kept[body, order, turn]

    @cached_property
    def _all_closed(self) -> bool:
        return bool(self.closed.all())

    @cached_property
    def _kept_seen(self) -> dict[tuple[str, int, bool], Array]:
        return {}


def _room(p: Pass, shape: tuple[int, ...]) -> Pass:
    """An empty pass for all frames, after that of the first block; what is one number stays so."""

    def room(values: Mapping[str, Array]) -> dict[str, Array]:
        return {k: np.empty(shape, np.asarray(v).dtype) if np.ndim(v) else v for k, v in values.items()}

    return Pass(room(p.origin), room(p.turn))
