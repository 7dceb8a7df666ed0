"""The steps of a linkage run over its frames, no further than the order asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...plane.vec import Array, direction_deg
from .branch import Chosen
from .driver_dyads import Driven
from .continued import sides_along
from .dyads import Dyad
from ..linkage import Linkage
from ..motion import Solution
from .row import Row, run, started
from .steps import Pass, Step

# The system's allocator gives freed arrays back at once and then pays for every page of the next one, which
# triples the time of rows of 10,000 frames; once a block of this size, bytes, was freed it keeps smaller ones.
# Larger has no effect.
KEPT = 31 << 20
np.empty(KEPT, dtype=np.uint8)


@dataclass(frozen=True, eq=False)
class Chain(Solution):
    """A linkage's steps over a row of drives, on a branch; nothing is worked out before it is asked for."""

    linkage: Linkage
    steps: tuple[Step, ...]
    drive: Array
    branch: Chosen

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
            reached = step.reached(self._upto(0)[0])
            if reached is not None:
                closed &= np.isfinite(reached)
        return closed

    @property
    def poses(self) -> Pass:
        """Where all bodies are, in the fixed body's frame; nan from the first one on that cannot be placed."""
        return self._upto(0)[0]

    @cached_property
    def signs(self) -> Mapping[str, Array]:
        found: dict[str, Array] = {}
        for step in self.steps:
            if not isinstance(step, Dyad):
                continue
            sign = self._row.side(step, self.poses)
            if isinstance(step, Driven):
                with np.errstate(invalid="ignore"):
                    r = step.roots(Pass(drive=self._column(self.drive)), sign).r
                sign = np.where(np.isfinite(r), np.sign(r), sign)
            found[step.joint] = np.broadcast_to(sign, self.shape)
        return found

    @cached_property
    def branches(self) -> Mapping[str, Array]:
        return {joint: np.where(self.closed, sign, 0).astype(int) for joint, sign in self.signs.items()}

    @cached_property
    def transmission_angle(self) -> Array:
        least = np.full(self.shape, np.nan)
        for step in self.steps:
            angle = step.transmission_angle(self._upto(0)[0])
            if angle is not None:
                least = np.fmin(least, angle)
        return np.where(self.closed, least, np.nan)

    def _column(self, q: Array) -> Array:
        """Drives against all linkages."""
        return q.reshape(-1, *(1,) * (len(self.shape) - 1))

    @cached_property
    def _row(self) -> Row:
        return sides_along(self.linkage, self.steps, self.drive, self.shape[1:], self.branch)

    @cached_property
    def _started(self) -> list[Pass]:
        """Passes of as many orders as were asked for so far, in the fixed body's frame."""
        return [started(self.linkage.ground, self._column(self.drive), self._row.before)]

    def _upto(self, order: int) -> list[Pass]:
        passes = self._started
        if len(passes) <= order or len(passes[0].turn) == 1:
            run(self._row, passes, order)
        return passes

    def _seen(self, body: str, order: int, turn: bool) -> Array:
        """Origin or turn as seen from outside the fixed body's frame, at every frame, nan where open."""
        kept = self._kept
        if (body, order, turn) not in kept:
            p = self._upto(order)[order]
            values = np.asarray(p.turn[body] if turn else p.origin[body])
            if self._ahead != 1 and not (turn and order):
                values = values * self._ahead
            if order == 0 and not turn and np.any(self.linkage.origin != 0):
                values = values + self.linkage.origin
            if order == 0 or not turn:
                values = values.astype(complex, copy=False)
            if body != self.linkage.ground and not self._all_closed:
                values = np.where(self.closed, values, np.nan)
            kept[body, order, turn] = values if values.shape == self.shape else np.broadcast_to(values, self.shape)
        return kept[body, order, turn]

    @cached_property
    def _kept(self) -> dict[tuple[str, int, bool], Array]:
        return {}

    @cached_property
    def _ahead(self) -> complex:
        return complex(direction_deg(self.linkage.ground_angle_deg))

    @cached_property
    def _all_closed(self) -> bool:
        return bool(self.closed.all())
