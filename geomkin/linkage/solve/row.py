"""Steps run over a row of drives, each on its side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...errors import DesignError
from ...plane.vec import Array
from .dyads import Dyad
from ..linkage import Linkage
from .iterate import Loops
from .meetings import Meetings
from .steps import Pass, Step, Turned

# Steps of the rows that branches are followed along: rad, and of a slider as a share of the linkage's reach.
# Coarser, and of two change points beside each other both are missed.
FINEST_TURN, FINEST_SHARE = np.pi / 180, 1 / 2880
# Frames times linkages of such a row at most: more take a gigabyte.
MOST = 400_000


@dataclass(frozen=True, eq=False)
class Row:
    """Steps at any drives of a range that holds `drive`, on the sides of dyads found so far, by joint.

    linkages: shape of the sizes; unit: of the drive, rad or the reach in mm.
    """

    linkage: Linkage
    steps: Sequence[Step]
    drive: Array
    linkages: tuple[int, ...]
    unit: float
    sides: dict[str, Array | int | Meetings]

    def column(self, q: Array) -> Array:
        """Drives against all linkages."""
        return q.reshape(-1, *(1,) * len(self.linkages))

    def placed(self, q: Array, count: int) -> Pass:
        """The first `count` steps at drives (n,)."""
        p = started(self.linkage.ground, self.column(q))
        for step in self.steps[:count]:
            step.place(p, self.side(step, p))
        return p

    def before(self, q: Array) -> list[Pass]:
        """Passes of order 0 and 1 at drives (n,) of all steps but those that look between the frames."""
        passes = [started(self.linkage.ground, self.column(q))]
        run(replace(self, steps=[step for step in self.steps if not isinstance(step, Loops)]), passes, 1)
        return passes

    def side(self, step: Step, p: Pass) -> Array | int:
        """The sign that a step takes where those before it stand."""
        if not isinstance(step, Dyad):
            return 1
        side = self.sides[step.joint]
        return side.sign(p.drive, step.gaps(p)) if isinstance(side, Meetings) else side

    def nodes(self) -> Array:
        """Drives in even steps over the whole range and a little beyond it, within the linkage's reach."""
        low, high = float(self.drive.min()), float(self.drive.max())
        turns, many = isinstance(self.steps[0], Turned), int(np.prod(self.linkages))
        if not turns:
            low, high = (float(np.clip(q, -self.unit, self.unit)) for q in (low, high))
        finest = FINEST_TURN if turns else FINEST_SHARE * self.unit
        parts = np.ceil((high - low) / finest) + 2
        if parts * many > MOST and turns and many < MOST / 8:
            found, most = np.degrees(high - low), MOST // many - 3
            raise DesignError("drive", f"found {found:.6g} deg to follow a branch over", f"give at most {most} deg")
        if parts * many > MOST:
            raise DesignError(
                "bodies", f"found {many} linkages to follow", f"give at most {int(MOST // parts)} at a time"
            )
        return np.linspace(low - finest, high + finest, int(parts) + 1)


def started(ground: str, q: Array, elsewhere: Callable[[Array], list[Pass]] | None = None) -> Pass:
    """A first pass with nothing placed but the fixed body."""
    return Pass({ground: np.zeros(())}, {ground: np.ones(())}, q, {}, elsewhere)


def run(row: Row, passes: list[Pass], order: int) -> None:
    """Carry started passes on up to an order, in the fixed body's frame; what is there is not done again."""
    ground = row.linkage.ground
    # What cannot close is nan, and what is singular is not finite: both are meant.
    with np.errstate(all="ignore"):
        if len(passes[0].turn) == 1:
            for step in row.steps:
                step.place(passes[0], row.side(step, passes[0]))
        if order > 0 and len(passes) == 1:
            passes.append(_still(ground))
            for step in row.steps:
                step.first(passes[0], passes[1])
        if order > 1 and len(passes) == 2:
            passes.append(_still(ground))
            for step in row.steps:
                step.second(passes[0], passes[1], passes[2])


def _still(ground: str) -> Pass:
    return Pass({ground: np.zeros(())}, {ground: np.zeros(())})
