"""The sign of a dyad whose branch is followed: it changes where the two branches meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...plane.vec import Array

# Units of drive about a meeting within which a gap of rounding is taken for none. Smaller, and frames beside a meeting
# of slowly turning links are open by rounding; larger, and a gap that is really open there is taken for closed.
BESIDE = 1e-3


@dataclass(frozen=True, eq=False)
class Meetings:
    """The sign of a dyad: `start` at the drive `first`, and the other one beyond each meeting of its branches.

    at: drives of the meetings, (n,); of: the linkage that each belongs to, in a flat count. gap: mm below which
    rounding alone keeps a gap from zero. unit: of the drive, rad or mm. linkages: shape of the sizes.
    """

    start: Array | int
    first: float
    at: Array
    of: Array
    gap: float
    unit: float
    linkages: tuple[int, ...]

    def sign(self, q: Array, gaps: tuple[Array, ...]) -> Array:
        """Signs, (drives, linkages), where the dyad has these gaps at the drives q, (drives, 1); 0 at a meeting."""
        row, many = q.reshape(-1), int(np.prod(self.linkages))
        changes, beside = np.zeros((many, len(row)), dtype=int), np.zeros((many, len(row)), dtype=bool)
        for own in np.unique(self.of).tolist():
            at = np.sort(self.at[self.of == own])
            passed, ends = np.searchsorted(at, row), np.concatenate([[-np.inf], at, [np.inf]])
            changes[own] = passed - np.searchsorted(at, self.first)
            beside[own] = np.minimum(row - ends[passed], ends[passed + 1] - row) < BESIDE * self.unit
        signs = self.start * np.where(changes % 2, -1, 1).T.reshape(-1, *self.linkages)
        least = np.fmin.reduce(np.broadcast_arrays(*gaps))
        meets = beside.T.reshape(signs.shape) & (least <= 0) & (least >= -self.gap)
        return np.where(meets, 0, signs)
