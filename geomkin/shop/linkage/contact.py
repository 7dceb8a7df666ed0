"""Which plates and pins of a linkage meet while it moves, and when."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from ...linkage.motion import Motion
from ...plane.vec import Array
from .assembly import Assembly, path_in
from .stock import LinkStock
from .sweep import Sweep

# Plates and pins keep apart by this many clearances of a pin in its hole: each of two plates can shift by half
# of it on either pin. Less lets edges rub; more needs layers that could be saved.
PLAY = 2.0

# From where to where the driver goes, rad or mm.
Run = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Contacts:
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
        near = self.stock.bar_width / 2 + self.stock.pin_diameter / 2 + self.play
        found = {}
        for pin in self.assembly.pins:
            for name in self.moving:
                if name not in pin.plates:
                    plate = self.assembly.plates[name]
                    path = path_in(self.motion, plate.body, pin.body, pin.place)
                    if runs := _runs(path, path.gap(plate.centres) < near):
                        found[pin.name, name] = runs
        return found


def _runs(path: Sweep, hit: Array) -> list[Run]:
    """Runs of steps that hit, each from its first step's start to its last step's end."""
    numbers = np.flatnonzero(hit)
    if not len(numbers):
        return []
    groups = np.split(numbers, np.flatnonzero(np.diff(path.frames[numbers]) > 1) + 1)
    ends = np.append(path.frames[1:], -1)
    runs = []
    for group in groups:
        first, last = path.frames[group[0]], path.frames[group[-1]]
        last = last + 1 if ends[group[-1]] == last + 1 else last
        runs.append((float(path.drive[first]), float(path.drive[last])))
    return runs
