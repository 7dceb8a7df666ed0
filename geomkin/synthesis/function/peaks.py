"""The peaks of an error: where it is largest between its neighbours, not only at samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...plane.vec import Mask, Real
from .minimax import AbstractTask

# Half widths of the parabolas that a peak is followed by, one after the other. Wider, and they tell of more than the
# top; narrower, and rounding moves them.
WIDTHS = (2e-3, 2e-4)


def peaks(task: AbstractTask, p: Real, most: int, looks: int) -> tuple[Real, Real, Mask]:
    """Places s (many, most) at which |error| is largest between its neighbours, to rounding, and the errors there.

    looks: equal parts in which they are looked for. The largest are told; where there are fewer, the rest is the first
    place, and the third result says which are peaks.
    """
    s = np.linspace(0, 1, looks + 1)
    size = np.abs(task.error(p, s[None]))
    edge = np.full((len(p), 1), -np.inf)
    before, after = np.hstack([edge, size[:, :-1]]), np.hstack([size[:, 1:], edge])
    top = np.where((size >= before) & (size > after), size, -np.inf)
    k = np.sort(np.argsort(-top, axis=1)[:, :most], axis=1)
    real = np.isfinite(np.take_along_axis(top, k, 1))
    low, high = s[np.maximum(k - 1, 0)] * real, s[np.minimum(k + 1, looks)] * real
    # An eighth each time: from 1e-2 to where a flat top is level to rounding.
    for _ in range(8):
        places = low[..., None] + (high - low)[..., None] * np.linspace(0, 1, 17)
        e = np.abs(task.error(p, places.reshape(len(p), -1))).reshape(places.shape)
        at = np.argmax(e, axis=2)[..., None]
        low, best, high = (np.take_along_axis(places, np.clip(at + j, 0, 16), 2)[..., 0] for j in (-1, 0, 1))
    return best, task.error(p, best), real


@dataclass(frozen=True, eq=False)
class AtPeaks(AbstractTask):
    """A task that is looked at on its peaks, which move with the candidate; the first `fixed` places stay.

    The derivative of a peak's height is that at its place; its curvature is not, which differences of derivatives at
    the place as it moves tell.
    """

    task: AbstractTask
    fixed: int

    @property
    def free(self) -> Mask:
        return self.task.free

    def error(self, p: Real, s: Real) -> Real:
        return self.task.error(p, self._moved(p, s))

    def slopes(self, p: Real, s: Real) -> Real:
        return self.task.slopes(p, self._moved(p, s))

    def limits(self, p: Real) -> tuple[Real, Real]:
        return self.task.limits(p)

    def _moved(self, p: Real, s: Real) -> Real:
        """s with all but the fixed places moved to the tops of the parabolas there."""
        s = np.broadcast_to(s, (len(p), s.shape[1]))
        near = s[:, self.fixed :]
        for width in WIDTHS:
            middle = np.clip(near, width, 1 - width)
            places = np.concatenate([middle - width, middle, middle + width], axis=1)
            with np.errstate(all="ignore"):
                low, here, high = np.split(self.task.error(p, places), 3, axis=1)
                top = 0.5 * (low - high) / (low - 2 * here + high)
                ways = np.where(np.isfinite(top), np.clip(top, -2, 2), 0.0)
            near = np.clip(middle + width * ways, 0, 1)
        return np.concatenate([s[:, : self.fixed], near], axis=1)
