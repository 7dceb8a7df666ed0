"""Room for what stands out of plates at the ends of their pins: layers that stay empty for heads and nuts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from .layers import Meetings, Run, runs
from .plates import Pin, Plate
from .sweep import path_in

# Shares of a sheet's thickness by which a head may be higher than whole layers: rounding must not add a layer.
HAIR = 1e-9
# Rounds in which gaps grow until no head meets a plate; each adds a layer, and no screw gets longer for ever.
ROUNDS = 100


@dataclass(frozen=True)
class Reach:
    """A pin in its layers: the lowest and the highest that it joins."""

    pin: Pin
    first: int
    last: int


@dataclass(frozen=True)
class Disc:
    """What is round about a pin beside its plates, and the heights between which it stands, in layers from below."""

    pin: Pin
    what: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Heads:
    """Heads and nuts of a stack, and what they would meet.

    reaches: the pins by layers without gaps. layers: of the plates, likewise. plates: as they are cut.
    """

    meetings: Meetings
    reaches: tuple[Reach, ...]
    layers: Mapping[str, int]
    plates: Mapping[str, Plate]
    _met: dict[tuple[str, str], list[Run]] = field(default_factory=dict)

    def gaps(self) -> list[int]:
        """Empty layers above each layer but the highest, the fewest, from below, in which heads meet no plate."""
        gaps = [0] * max(self.layers.values())
        for _ in range(ROUNDS):
            wanted, places = list(gaps), placed(gaps)
            up: dict[int, list[tuple[Pin, int]]] = {}
            for reach in self.reaches:
                below, above = (int(np.ceil(high - HAIR)) for high in self._ends(reach, places))
                if self._meets(reach.pin, places, places[reach.last] + 1, places[reach.last] + above):
                    wanted[reach.last] = max(wanted[reach.last], above)
                if self._meets(reach.pin, places, places[reach.first] - below, places[reach.first] - 1):
                    wanted[reach.first - 1] = max(wanted[reach.first - 1], below)
                up.setdefault(reach.last, []).append((reach.pin, above))
            for reach in self.reaches:
                below = int(np.ceil(self._ends(reach, places)[0] - HAIR))
                for pin, above in up.get(reach.first - 1, ()):
                    if below and above and self._discs_meet(pin, reach.pin):
                        wanted[reach.first - 1] = max(wanted[reach.first - 1], below + above)
            if wanted == gaps:
                break
            gaps = wanted
        return gaps

    def _meets(self, pin: Pin, places: list[int], low: int, high: int) -> bool:
        """Whether a pin's head meets a plate in layers from `low` to `high`."""
        near = [name for name, layer in self.layers.items() if low <= places[layer] <= high]
        return any(self._runs(pin, name) for name in near)

    def _runs(self, pin: Pin, name: str) -> list[Run]:
        """When a pin's head would meet a plate, were it in its layer."""
        if (pin.name, name) not in self._met:
            stock, plate = self.meetings.stock, self.plates[name]
            path = path_in(self.meetings.motion, plate.body, pin.body, pin.place)
            near = stock.bar_width / 2 + self._across(pin) / 2 + self.meetings.play
            self._met[pin.name, name] = runs(path, path.gap(plate.centres) < near)
        return self._met[pin.name, name]

    def _discs_meet(self, one: Pin, two: Pin) -> list[Run]:
        """When heads of two pins would meet, were they in one layer."""
        key = f"pin {one.name}", two.name
        if key not in self._met:
            path = path_in(self.meetings.motion, one.body, two.body, two.place)
            near = (self._across(one) + self._across(two)) / 2 + self.meetings.play
            self._met[key] = runs(path, path.gap(np.array([one.place])) < near)
        return self._met[key]

    def _ends(self, reach: Reach, places: list[int]) -> tuple[float, float]:
        """How far a pin stands out below and above, in layers: the nut is where it is out of the way.

        A motor's shaft ends with its plates.
        """
        if reach.pin.shaft:
            return 0.0, 0.0
        stock = self.meetings.stock
        grip = (places[reach.last] - places[reach.first] + 1) * stock.thickness
        head, nut = (high / stock.thickness for high in stock.fastener_used.ends(grip))
        return (nut, head) if reach.first == 0 else (head, nut)

    def _across(self, pin: Pin) -> float:
        """Diameter of what is round about a pin, mm."""
        return max(self.meetings.stock.fastener_used.across, pin.shaft)

    def is_open(self, shaft: Reach) -> bool:
        """Whether a motor's shaft may be longer than its plates: no plate and no pin above would meet it."""
        plates = (name for name, layer in self.layers.items() if layer > shaft.last)
        pins = (reach.pin for reach in self.reaches if reach is not shaft and reach.last >= shaft.last)
        met = any(self._runs(shaft.pin, name) for name in plates)
        return not met and not any(self._discs_meet(pin, shaft.pin) for pin in pins)

    def rings(self, gaps: list[int]) -> Iterator[tuple[Pin, int]]:
        """Pins that cross empty layers, each with every such layer: a ring there keeps their plates apart.

        A motor's shaft needs none, for its crank is fixed on it, but stands there itself.
        """
        places = placed(gaps)
        for reach in self.reaches:
            for k in range(reach.first, reach.last):
                yield from ((reach.pin, layer) for layer in range(places[k] + 1, places[k + 1]))

    def disc_clears(self, pin: Pin, layer: int, others: Iterable[Pin], gaps: list[int]) -> bool:
        """Whether a disc on a pin meets nothing in a layer, counted without gaps: plates, heads, discs of other pins.

        Discs are as wide as bars.
        """
        stock, play = self.meetings.stock, self.meetings.play
        half = stock.bar_width / 2
        # Of plates the middle lines count, from which they reach half a bar.
        around = [(plate.body, plate.centres, half) for n, plate in self.plates.items() if self.layers[n] == layer]
        around += [(other.body, np.array([other.place]), half) for other in others]
        heads = [one for one in self._heads_in(placed(gaps), placed(gaps)[layer]) if one is not pin]
        around += [(head.body, np.array([head.place]), stock.fastener_used.across / 2) for head in heads]
        return not any(
            (path_in(self.meetings.motion, body, pin.body, pin.place).gap(centres) < half + wide + play).any()
            for body, centres, wide in around
        )

    def _heads_in(self, places: list[int], at: int) -> Iterator[Pin]:
        """Pins of which a head or nut stands in a layer, counted with gaps."""
        for reach in self.reaches:
            below, above = self._ends(reach, places)
            low, high = places[reach.first], places[reach.last] + 1
            if low - below < at + 1 - HAIR < low or high <= at < high + above - HAIR:
                yield reach.pin

    def collisions(self, gaps: list[int]) -> Iterator[tuple[str, str, Run]]:
        """What still meets: a pin, by name, that and what its head or ring meets, and when."""
        places = placed(gaps)
        discs = [Disc(p, "shaft" if p.shaft else "ring", layer, layer + 1) for p, layer in self.rings(gaps)]
        for reach in self.reaches:
            below, above = self._ends(reach, places)
            low, high = places[reach.first], places[reach.last] + 1
            discs += [Disc(reach.pin, "end", low - below, low), Disc(reach.pin, "end", high, high + above)]
        for disc in discs:
            for name, layer in self.layers.items():
                at = places[layer]
                if disc.low < at + 1 - HAIR and disc.high > at + HAIR:
                    yield from (
                        (disc.pin.name, f"{name} by its {disc.what}", run) for run in self._runs(disc.pin, name)
                    )
        told = set()
        for one, two in combinations(discs, 2):
            pair = one.pin.name, two.pin.name
            if pair[0] == pair[1] or pair in told or min(one.high, two.high) <= max(one.low, two.low) + HAIR:
                continue
            for run in self._discs_meet(one.pin, two.pin):
                told.add(pair)
                yield pair[0], f"the {two.what} of {pair[1]} by its {one.what}", run


def placed(gaps: list[int]) -> list[int]:
    """Where each layer lies, counted with the empty ones."""
    return [k + sum(gaps[:k]) for k in range(len(gaps) + 1)]
