"""Which plates and pins of a linkage would meet in one layer, and the layers in which none do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, compress

import numpy as np

from ...cached import cached_property
from ...linkage.motion import Motion
from ...plane.vec import Mask, Whole
from .near import Pair, meeting
from .plates import Assembly, Pin
from .stock import LinkStock
from .sweep import path_in

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
        return self._joined | self._met[0]

    @property
    def pin_and_plate(self) -> dict[tuple[str, str], Pair]:
        """Pins and the moving plates that they meet."""
        return self._met[1]

    @cached_property
    def _joined(self) -> set[frozenset[str]]:
        return {frozenset(pair) for pin in self.assembly.pins for pair in combinations(pin.plates, 2)}

    @cached_property
    def _met(self) -> tuple[set[frozenset[str]], dict[tuple[str, str], Pair]]:
        """What no pin joins and yet meets: plates; pins and plates. All are looked at in one go."""
        of, stock, hulls = (
            self.assembly.plates,
            self.stock,
            {name: self.assembly.plates[name].hull for name in self.moving},
        )
        plates = {
            pair: Pair(of[one].body, hulls[one], of[two].body, hulls[two], stock.bar_width + self.play)
            for one, two in combinations(self.moving, 2)
            if (pair := frozenset((one, two))) not in self._joined
        }
        pins = {
            (pin.name, name): Pair(of[name].body, hulls[name], pin.body, np.array([pin.place]), self._near(pin))
            for pin in self.assembly.pins
            for name in self.moving
            if name not in pin.plates
        }
        met = meeting(self.motion, [*plates.values(), *pins.values()])
        return set(compress(plates, met)), dict(compress(pins.items(), met[len(plates) :]))

    def _near(self, pin: Pin) -> float:
        """How near the middle of a pin may come to a plate's corners, mm."""
        return self.stock.bar_width / 2 + (pin.shaft or self.stock.pin_diameter) / 2 + self.play


def runs(motion: Motion, pair: Pair) -> list[Run]:
    """When a pair comes nearer than it may: runs of steps, each from its least to its greatest drive."""
    path = path_in(motion, pair.body, pair.other, pair.places)
    numbers = np.flatnonzero(path.gap(pair.corners) < pair.near)
    if not len(numbers):
        return []
    groups = np.split(numbers, np.flatnonzero(np.diff(path.frames[numbers]) > 1) + 1)
    ends = np.append(path.frames[1:], -1)
    found = []
    for group in groups:
        first, last = path.frames[group[0]], path.frames[group[-1]]
        last = last + 1 if ends[group[-1]] == last + 1 else last
        low, high = sorted(path.drive[[first, last]].tolist())
        found.append((low, high))
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

    def through(self, below: Whole) -> Mask:
        """Whether it goes from the plates `below`, or the bottom, up to any other, or the top."""
        from_below, up = self.joins & below != 0, self.joins & ~below != 0
        passes: Mask = (self.bottom | from_below) & (self.top | up)
        return passes


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
    every = np.arange(1 << count)
    # Of each set of plates, whether no two meet; how many pins go through above it, and what those hit.
    apart, through, barred = np.ones(1 << count, dtype=bool), np.zeros_like(every), np.zeros_like(every)
    for k, others in enumerate(meets):
        apart[1 << k : 2 << k] = apart[: 1 << k] & (every[: 1 << k] & others == 0)
    for pin in pins:
        passes = pin.through(every)
        through += passes
        barred |= np.where(passes, pin.hits, 0)
    # Lists, for arrays are slow one by one.
    is_apart, lengths, hit_by = apart.tolist(), through.tolist(), barred.tolist()
    # For each set of plates: collisions, layers, length of pins, and the plates of the uppermost layer.
    best: dict[int, tuple[int, int, int, int]] = {0: (0, 0, 0, 0)}
    for below in range((1 << count) - 1):
        if below not in best:
            continue
        collisions, layers, length, _ = best[below]
        # A pin that starts in the next layer need not be tested: its plate there already keeps off what it would hit.
        anywhere = hit_by[below]
        hits = [] if clean or not anywhere else [pin.hits for pin in pins if pin.through(every[below])]
        rest = ((1 << count) - 1) & ~(below | anywhere if clean else below)
        chosen = rest
        while chosen:
            if is_apart[chosen]:
                hit = sum((some & chosen).bit_count() for some in hits) if chosen & anywhere else 0
                way = collisions + hit, layers + 1, length + lengths[below], chosen
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
