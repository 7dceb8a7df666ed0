"""In which layers to put plates that must not meet each other, nor pins that pass them: an exact search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Passing:
    """A pin as the layers see it; plates are bits of whole numbers, plate k the bit 1 << k.

    joins: plates that it joins. bottom, top: whether it goes down to what lies below all layers, or up to
    what lies above. hits: plates that it cannot pass.
    """

    joins: int
    bottom: bool
    top: bool
    hits: int

    def through(self, below: int) -> bool:
        """Whether it goes from the plates `below`, or the bottom, up to any other, or the top."""
        return bool((self.bottom or self.joins & below) and (self.top or self.joins & ~below))


@dataclass(frozen=True)
class Order:
    """Plates of each layer as bits, from below. collisions: of pins; length: of all pins, in layers."""

    collisions: int
    length: int
    layers: tuple[int, ...]


def order(meets: Sequence[int], pins: Sequence[Passing], clean: bool = True) -> Order | None:
    """The fewest layers for plates of which plate k cannot share a layer with the plates meets[k].

    Among as few layers the least length of pins. clean: without collisions of pins, None where that cannot be;
    otherwise with the fewest. What happens in a layer depends only on which plates lie below it, not on their
    order, so that the best way to each set of plates is all that is kept: exact, and the same on every run.
    """
    count = len(meets)
    alone = [True] * (1 << count)
    for plates in range(1, 1 << count):
        lowest = (plates & -plates).bit_length() - 1
        rest = plates & (plates - 1)
        alone[plates] = alone[rest] and not meets[lowest] & rest
    # For each set of plates: collisions, layers, length of pins, and the plates of the uppermost layer.
    best: dict[int, tuple[int, int, int, int]] = {0: (0, 0, 0, 0)}
    for below in range((1 << count) - 1):
        if below not in best:
            continue
        collisions, layers, length, _ = best[below]
        # A pin that starts in the next layer needs no look: its own plate there meets whatever it hits.
        through = [pin for pin in pins if pin.through(below)]
        barred = [pin.hits for pin in through]
        anywhere = 0
        for hits in barred:
            anywhere |= hits
        rest = ((1 << count) - 1) & ~(below | anywhere if clean else below)
        chosen = rest
        while chosen:
            if alone[chosen]:
                hit = sum((hits & chosen).bit_count() for hits in barred) if chosen & anywhere else 0
                way = collisions + hit, layers + 1, length + len(through), chosen
                if below | chosen not in best or way[:3] < best[below | chosen][:3]:
                    best[below | chosen] = way
            chosen = (chosen - 1) & rest
    full = (1 << count) - 1
    if full not in best:
        return None
    layers_down, left = [], full
    while left:
        layers_down.append(best[left][3])
        left &= ~best[left][3]
    return Order(best[full][0], best[full][2], tuple(layers_down[::-1]))
