"""Values between the entries of a table over one turn, which was got ready beforehand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...plane.vec import Array, Real

# How many entries tables are tried with.
ENTRIES = (100.0, 1000.0, 10000.0)


def linear(drive: Real, values: Callable[[Real], Array], entries: float) -> Callable[[], Array]:
    """Straight lines between values (..., n) at so many even steps of a turn, at drives (frames,) within one turn."""
    count = int(entries)
    here = values(np.arange(count) * (2 * np.pi / count))
    rise = np.roll(here, -1, axis=-1) - here

    def call() -> Array:
        k, s = _places(drive, count)
        found: Array = here[..., k] + s * rise[..., k]
        return found

    return call


def cubic(drive: Real, values: Callable[[Real], Array], entries: float) -> Callable[[], Array]:
    """The same with a cubic through the four nearest entries (Lagrange's)."""
    count = int(entries)
    here = values(np.arange(count) * (2 * np.pi / count))
    before, ahead, after = (np.roll(here, k, axis=-1) for k in (1, -1, -2))
    one = ahead - here / 2 - before / 3 - after / 6
    two, three = (before + ahead) / 2 - here, (here - ahead) / 2 + (after - before) / 6

    def call() -> Array:
        k, s = _places(drive, count)
        found: Array = here[..., k] + s * (one[..., k] + s * (two[..., k] + s * three[..., k]))
        return found

    return call


def _places(drive: Real, count: int) -> tuple[Array, Real]:
    """The entry before each drive, and how far past it that is, in entries."""
    place = drive * (count / (2 * np.pi))
    k = place.astype(np.intp)
    return k % count, place - k
