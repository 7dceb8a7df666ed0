"""Parts laid out flat, apart and at full size: where each copy stands on the sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..brief import one_line
from .cut import Cut, Loop

# Operations that a cutting program tells apart, each with its colour index, for programs that know only those, and its
# RGB; colour-blind readers tell them apart too.
LAYERS: dict[str, tuple[int, tuple[int, int, int]]] = {
    "CUT": (1, (213, 94, 0)),
    "HOLE": (5, (0, 114, 178)),
    "ENGRAVE": (3, (0, 158, 115)),
    "LABEL": (6, (204, 121, 167)),
    "REFERENCE": (8, (110, 110, 110)),
}
# Clear space between parts, mm: less lets kerf and heat of one cut reach the next part.
GAP = 5.0


@dataclass(frozen=True, eq=False)
class Placed:
    """One copy of a part and the shift, complex mm, that takes its own frame to the sheet."""

    cut: Cut
    shift: complex

    __repr__ = one_line

    @property
    def loops(self) -> tuple[Loop, ...]:
        """All of it on the sheet, in the order of the work.

        Holes first, then marks, then the outline: what is cut free drops or tilts, and takes no more cuts.
        """
        outline, *holes = self.cut.loops
        inner = [holes[k] for k in nearest_next([hole.points[0] for hole in holes], outline.box[0])]
        return tuple(loop.moved(self.shift, self.cut.digits) for loop in (*inner, *self.cut.marks, outline))


@dataclass(frozen=True, eq=False)
class Sheet:
    """All copies; the sheet reaches from the origin to (width, height), mm, margins included."""

    placed: tuple[Placed, ...]
    width: float
    height: float

    __repr__ = one_line

    @property
    def extents(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of all that is cut, mm."""
        low, high = np.array([p.loops[-1].box for p in self.placed]).T
        return complex(low.real.min(), low.imag.min()), complex(high.real.max(), high.imag.max())


def nearest_next(places: Sequence[complex], start: complex) -> list[int]:
    """An order of places, mm, in which each is the nearest one to the last: a head that moves less is done sooner."""
    left, order, here = np.array(places, dtype=complex), [], start
    for _ in places:
        # To the micrometre, so that no last digit chooses between two that are equally far.
        order.append(int(np.argmin(np.round(np.abs(left - here), 3))))
        here, left[order[-1]] = complex(left[order[-1]]), np.inf
    return order


def lay_out(cuts: Sequence[Cut]) -> Sheet:
    """Rows of parts, highest first, in a sheet about as wide as it is high."""
    copies = [c for c in cuts for _ in range(c.part.count)]
    sizes = [c.box[1] - c.box[0] for c in copies]
    order = sorted(range(len(copies)), key=lambda k: (-sizes[k].imag, k))
    room = sum((s.real + GAP) * (s.imag + GAP) for s in sizes)
    across = max(max(s.real for s in sizes) + 2 * GAP, float(np.sqrt(room)) * 1.2)
    placed: dict[int, Placed] = {}
    x = y = GAP
    row = width = 0.0
    for k in order:
        low, size = copies[k].box[0], sizes[k]
        if x > GAP and x + size.real + GAP > across:
            x, y, row = GAP, y + row + GAP, 0.0
        # Whole millimetres keep the parts' own decimals, so that all copies are alike.
        placed[k] = Placed(copies[k], complex(np.ceil(x - low.real), np.ceil(y - low.imag)))
        top = placed[k].shift + low + size
        x, row, width = top.real + GAP, max(row, top.imag - y), max(width, top.real + GAP)
    starts = [complex(placed[k].shift + copies[k].loops[0].points[0]) for k in range(len(copies))]
    return Sheet(
        tuple(placed[k] for k in nearest_next(starts, 0j)), np.ceil(width).item(), np.ceil(y + row + GAP).item()
    )
