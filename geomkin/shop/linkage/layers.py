"""Which plates and pins of a linkage would meet in one layer, and the layers in which none do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from ...linkage.motion import Motion
from ...plane.vec import Mask
from .plates import Assembly
from .stock import LinkStock
from .sweep import Sweep, path_in

# Least distance of plates and pins, in clearances of a pin in its hole, by which each plate can shift on its pins. Less
# lets edges rub; more needs layers that could be saved.
PLAY = 2.0

# From where to where the driver goes, rad or mm.
Run = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Meetings:
    """What would meet if it were in one layer, seen from above: edges nearer than the play count as meeting.

    Two pins need no look: of two that pass through one layer, one has a plate there that surrounds it, and
    that the other meets first.
    """

    motion: Motion
    stock: LinkStock
    assembly: Assembly

    @property
    def ground(self) -> str:
        """Name of the fixed plate, which nothing here is compared with: it has its layer to itself."""
        return self.motion.linkage.ground

    @cached_property
    def play(self) -> float:
        """Least distance of edges, mm."""
        return PLAY * self.stock.clearance

    @cached_property
    def moving(self) -> list[str]:
        """The plates that move."""
        return [name for name in self.assembly.plates if name != self.ground]

    @cached_property
    def plates(self) -> set[frozenset[str]]:
        """Pairs of moving plates that meet, those joined by a pin among them."""
        meeting = {frozenset(pair) for pin in self.assembly.pins for pair in combinations(pin.plates, 2)}
        for one, two in combinations(self.moving, 2):
            if frozenset((one, two)) not in meeting:
                a, b = self.assembly.plates[one], self.assembly.plates[two]
                path = path_in(self.motion, a.body, b.body, b.centres)
                if (path.gap(a.centres) < self.stock.bar_width + self.play).any():
                    meeting.add(frozenset((one, two)))
        return meeting

    @cached_property
    def pin_and_plate(self) -> dict[tuple[str, str], list[Run]]:
        """Pins and the moving plates that they meet, and when."""
        found = {}
        for pin in self.assembly.pins:
            near = self.stock.bar_width / 2 + (pin.shaft or self.stock.pin_diameter) / 2 + self.play
            for name in self.moving:
                if name not in pin.plates:
                    plate = self.assembly.plates[name]
                    path = path_in(self.motion, plate.body, pin.body, pin.place)
                    if met := runs(path, path.gap(plate.centres) < near):
                        found[pin.name, name] = met
        return found


def runs(path: Sweep, hit: Mask) -> list[Run]:
    """Runs of steps that hit, each from its first step's start to its last step's end."""
    numbers = np.flatnonzero(hit)
    if not len(numbers):
        return []
    groups = np.split(numbers, np.flatnonzero(np.diff(path.frames[numbers]) > 1) + 1)
    ends = np.append(path.frames[1:], -1)
    found = []
    for group in groups:
        first, last = path.frames[group[0]], path.frames[group[-1]]
        last = last + 1 if ends[group[-1]] == last + 1 else last
        found.append((float(path.drive[first]), float(path.drive[last])))
    return found


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
    """The fewest layers for plates of which plate k cannot share a layer with the plates meets[k]: an exact search.

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
        # A pin that starts in the next layer need not be tested: its plate there already keeps off what it would hit.
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
