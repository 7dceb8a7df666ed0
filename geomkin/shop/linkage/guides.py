"""Where two guide pins keep a sliding plate from turning."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ...plane.hulls import separation
from ...plane.vec import Complex, Mask

# Least distance of the two guide pins in widths of the bar. Nearer, the play of the pins in their slot lets the
# plate cock and jam; farther makes plate and slot longer for nothing.
APART = 2.0


Opening = Sequence[complex]
Slot = tuple[complex, complex]


def guide_places(
    width: float,
    travel: Slot,
    ahead: complex,
    point: complex,
    direction: complex,
    taken: Iterable[Opening],
    taken_on_guide: Iterable[Opening],
) -> tuple[tuple[complex, complex], tuple[Slot, Slot]] | None:
    """Places of two guide pins on a sliding plate, and the ends of the slot of each on its guide.

    width: of the bars, mm, the least distance kept from all other openings. travel: from where to where `point`
    of the plate slides on the guide. ahead, direction: of the slide, in the frames of guide and plate. taken,
    taken_on_guide: their openings, one place for a hole, two for a slot's ends. The pins come as near to the
    point as they can; slots that would leave less than a bar's width between them are one, and come twice. None
    where there is no room.
    """
    used, used_on_guide = [np.array(z) for z in taken], [np.array(z) for z in taken_on_guide]
    start, end = travel
    length = abs(end - start)
    # How far to look: beyond all openings there is room.
    far = length + 2 * APART * width + max([0.0, *(float(np.abs(z - point).max()) for z in used)])
    far += max([0.0, *(float(np.abs(z - start).max()) for z in used_on_guide)])
    # A quarter of the width finds a place near enough to the best; with more than 200 places, pairs take seconds.
    step = max(width / 4, far / 100)
    grid = step * np.arange(-int(far / step), int(far / step) + 1)
    grid = grid[_clear((point + grid * direction)[:, None], used, width)]
    one, two = (grid[k] for k in np.triu_indices(len(grid), 1))
    wide = two - one >= APART * width
    one, two = one[wide], two[wide]
    shared = two - one - length < width
    slots = (
        np.stack([start + one * ahead, np.where(shared, end + two * ahead, end + one * ahead)], axis=1),
        np.stack([np.where(shared, start + one * ahead, start + two * ahead), end + two * ahead], axis=1),
    )
    free = np.flatnonzero(_clear(slots[0], used_on_guide, width) & _clear(slots[1], used_on_guide, width))
    if not len(free):
        return None
    one, two = one[free], two[free]
    best = np.lexsort((one, np.abs(one + two), two - one, np.maximum(np.abs(one), np.abs(two))))[0]
    (a, b), (c, d) = (slot[free[best]].tolist() for slot in slots)
    return (complex(point + one[best] * direction), complex(point + two[best] * direction)), ((a, b), (c, d))


def _clear(places: Complex, taken: Sequence[Complex], width: float) -> Mask:
    """Whether openings (n, 1 or 2) keep their distance from all that are taken."""
    clear = np.ones(len(places), dtype=bool)
    # Rounding must not choose between places exactly at the distance.
    width = width * (1 - 1e-9)
    for opening in taken:
        clear &= separation(places, np.broadcast_to(opening, (len(places), len(opening)))) >= width
    return clear
