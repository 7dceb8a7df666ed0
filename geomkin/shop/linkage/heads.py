"""Room for what stands out of plates at the ends of their pins: layers that stay empty for heads and nuts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from ...cached import cached_property
from ...plane.vec import Complex
from .layers import Meetings, Run, runs
from .near import Pair, meeting
from .plates import Pin, Plate

# Shares of a sheet's thickness by which a head may be higher than whole layers: rounding must not add a layer.
HAIR = 1e-9
# Rounds in which gaps grow until no head meets a plate; each adds a layer, and no screw gets longer for ever.
ROUNDS = 100
# A pin and a plate, or two pins.
Key = tuple[str, str]


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
    _pairs: dict[Key, Pair] = field(default_factory=dict)
    _met: dict[Key, bool] = field(default_factory=dict)

    def gaps(self) -> list[int]:
        """Empty layers above each layer but the highest, the fewest, from below, in which heads meet no plate."""
        gaps = [0] * max(self.layers.values())
        for _ in range(ROUNDS):
            wanted, places = list(gaps), placed(gaps)
            asked = list(self._asked(places))
            self._look(key for _, _, keys in asked for key in keys)
            for gap, high, keys in asked:
                if any(self._met[key] for key in keys):
                    wanted[gap] = max(wanted[gap], high)
            if wanted == gaps:
                break
            gaps = wanted
        return gaps

    def _asked(self, places: list[int]) -> Iterator[tuple[int, int, list[Key]]]:
        """Gaps, how high each must be where any of some pairs meets, and those pairs."""
        up: dict[int, list[tuple[Pin, int]]] = {}
        heights = []
        for reach in self.reaches:
            below, above = (int(np.ceil(high - HAIR)) for high in self._ends(reach, places))
            heights.append(below)
            yield (
                reach.last,
                above,
                self._in_layers(reach.pin, places, places[reach.last] + 1, places[reach.last] + above),
            )
            yield (
                reach.first - 1,
                below,
                self._in_layers(reach.pin, places, places[reach.first] - below, places[reach.first] - 1),
            )
            up.setdefault(reach.last, []).append((reach.pin, above))
        for reach, below in zip(self.reaches, heights):
            for pin, above in up.get(reach.first - 1, ()):
                if below and above:
                    yield reach.first - 1, below + above, [self._two_discs(pin, reach.pin)]

    def _in_layers(self, pin: Pin, places: list[int], low: int, high: int) -> list[Key]:
        """A pin's head and each plate in layers from `low` to `high`."""
        return [self._head_and_plate(pin, name) for name, layer in self.layers.items() if low <= places[layer] <= high]

    def _head_and_plate(self, pin: Pin, name: str) -> Key:
        key = pin.name, name
        if key not in self._pairs:
            stock, plate = self.meetings.stock, self.plates[name]
            near = stock.bar_width / 2 + self._across(pin) / 2 + self.meetings.play
            self._pairs[key] = Pair(plate.body, self._hulls[name], pin.body, np.array([pin.place]), near)
        return key

    def _two_discs(self, one: Pin, two: Pin, what: tuple[str, str] = ("end", "end")) -> Key:
        key = f"{what[0]} of {one.name}", f"{what[1]} of {two.name}"
        if key not in self._pairs:
            # Rings are loose on their pins, and yield to what touches them.
            play = 0.0 if "ring" in what else self.meetings.play
            near = (self._across(one, what[0]) + self._across(two, what[1])) / 2 + play
            self._pairs[key] = Pair(one.body, np.array([one.place]), two.body, np.array([two.place]), near)
        return key

    @cached_property
    def _hulls(self) -> dict[str, Complex]:
        return {name: plate.hull for name, plate in self.plates.items()}

    def _look(self, keys: Iterable[Key]) -> None:
        """Find out of pairs whether they would meet, were they in one layer."""
        new = [key for key in dict.fromkeys(keys) if key not in self._met]
        self._met.update(zip(new, meeting(self.meetings.motion, [self._pairs[key] for key in new]).tolist()))

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

    def _across(self, pin: Pin, what: str = "end") -> float:
        """Diameter of what is round about a pin, mm; rings are as wide as bars."""
        stock = self.meetings.stock
        return stock.bar_width if what == "ring" else max(stock.fastener_used.across, pin.shaft)

    def is_open(self, shaft: Reach) -> bool:
        """Whether a motor's shaft may be longer than its plates: no plate and no pin above would meet it."""
        plates = (name for name, layer in self.layers.items() if layer > shaft.last)
        pins = (reach.pin for reach in self.reaches if reach is not shaft and reach.last >= shaft.last)
        keys = [
            *(self._head_and_plate(shaft.pin, name) for name in plates),
            *(self._two_discs(pin, shaft.pin) for pin in pins),
        ]
        self._look(keys)
        return not any(self._met[key] for key in keys)

    def rings(self, gaps: list[int]) -> Iterator[tuple[Pin, int]]:
        """Pins that cross empty layers, each with every such layer: a ring there keeps their plates apart.

        A motor's shaft needs none, for its crank is fixed on it, but stands there itself. Piles are left out: they
        stand clear of all that moves.
        """
        places, ground = placed(gaps), self.meetings.ground
        for reach in self.reaches:
            if all(self.plates[name].body == ground for name in reach.pin.plates):
                continue
            for k in range(reach.first, reach.last):
                yield from ((reach.pin, layer) for layer in range(places[k] + 1, places[k + 1]))

    def disc_clears(self, pin: Pin, layer: int, others: Iterable[Pin], gaps: list[int]) -> bool:
        """Whether a disc on a pin meets nothing in a layer, counted without gaps: plates, heads, discs of other pins.

        Discs are as wide as bars.
        """
        stock, play = self.meetings.stock, self.meetings.play
        half = stock.bar_width / 2
        # Of plates the middle lines count, from which they reach half a bar.
        around = [(plate.body, self._hulls[n], half) for n, plate in self.plates.items() if self.layers[n] == layer]
        around += [(other.body, np.array([other.place]), half) for other in others]
        heads = [one for one in self._heads_in(placed(gaps), placed(gaps)[layer]) if one is not pin]
        around += [(head.body, np.array([head.place]), stock.fastener_used.across / 2) for head in heads]
        place = np.array([pin.place])
        pairs = [Pair(body, corners, pin.body, place, half + wide + play) for body, corners, wide in around]
        return not meeting(self.meetings.motion, pairs).any()

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
        plates = [
            (disc, name, self._head_and_plate(disc.pin, name))
            for disc in discs
            for name, layer in self.layers.items()
            if disc.low < places[layer] + 1 - HAIR and disc.high > places[layer] + HAIR
        ]
        heads = [
            (one, two, self._two_discs(one.pin, two.pin, (one.what, two.what)))
            for one, two in combinations(discs, 2)
            if one.pin.name != two.pin.name and min(one.high, two.high) > max(one.low, two.low) + HAIR
        ]
        self._look(key for _, _, key in (*plates, *heads))
        for disc, name, key in plates:
            for run in self._runs(key):
                yield disc.pin.name, f"{name} by its {disc.what}", run
        told = set()
        for one, two, key in heads:
            if key not in told:
                for run in self._runs(key):
                    told.add(key)
                    yield one.pin.name, f"the {two.what} of {two.pin.name} by its {one.what}", run

    def _runs(self, key: Key) -> list[Run]:
        return runs(self.meetings.motion, self._pairs[key]) if self._met[key] else []


def placed(gaps: list[int]) -> list[int]:
    """Where each layer lies, counted with the empty ones."""
    return [k + sum(gaps[:k]) for k in range(len(gaps) + 1)]
