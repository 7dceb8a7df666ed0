"""The plates and pins of a linkage that would meet in one layer, and an order of layers in which none do."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from itertools import combinations, compress

import numpy as np

from ...core.records import record
from ...making.attachments import attached_holes
from ...making.fasteners import size_of
from ...plane.vec import Complex, Mask, Whole
from ..motion import Motion
from .collisions import Pair, meeting, relative_paths
from .plates import LinkAssembly, LinkPlate, Pin
from .stock import LinkStock

# Smallest distance of plates and pins, in clearances of a pin in its hole, by which each plate can shift.
PLAY = 2.0

# First and last drive, rad or mm.
Run = tuple[float, float]


@record(eq=False)
class Meetings:
    """Plates and pins that would meet in one layer, seen from above: edges nearer than the play count as meeting.

    Two pins need no test: if two pass through one layer, one has a plate there that surrounds it, which the other meets
    first.
    """

    motion: Motion
    stock: LinkStock
    assembly: LinkAssembly

    @property
    def ground(self) -> str:
        """Name of the fixed plate, which is not tested, since it is alone in its layer."""
        return self.motion.linkage.ground

    @cached_property
    def play(self) -> float:
        """Smallest distance of edges, mm."""
        return PLAY * self.stock.pin_clearance

    @cached_property
    def moving(self) -> list[str]:
        """The plates that move."""
        return [name for name in self.assembly.plates if name != self.ground]

    @cached_property
    def layered(self) -> dict[str, int]:
        """Number of each moving plate in the search of layers; gears in mesh have one, since they share a layer."""
        first = {name: train[0] for train in self.assembly.gears for name in train}
        numbers = {name: k for k, name in enumerate(dict.fromkeys(first.get(name, name) for name in self.moving))}
        return {name: numbers[first.get(name, name)] for name in self.moving}

    @cached_property
    def plates(self) -> set[frozenset[str]]:
        """Pairs of moving plates that meet, including those joined by a pin."""
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
        """Meeting pairs that no pin joins: plates; pins and plates. All are tested at once."""
        all_plates, stock, hulls = (
            self.assembly.plates,
            self.stock,
            {name: self.assembly.plates[name].hull(self.stock.bar_width) for name in self.moving},
        )
        plates = {
            pair: Pair(all_plates[one].body, hulls[one], all_plates[two].body, hulls[two], stock.bar_width + self.play)
            for one, two in combinations(self.moving, 2)
            if (pair := frozenset((one, two))) not in self._joined
        }
        pins = {
            (pin.name, name): Pair(all_plates[name].body, hulls[name], pin.body, np.array([pin.place]), self._near(pin))
            for pin in self.assembly.pins
            for name in self.moving
            if name not in pin.plates
        }
        met = meeting(self.motion, [*plates.values(), *pins.values()])
        return set(compress(plates, met)), dict(compress(pins.items(), met[len(plates) :]))

    def _near(self, pin: Pin) -> float:
        """Smallest permitted distance of a pin's centre from the corners of a plate, mm."""
        return self.stock.bar_width / 2 + (pin.shaft or self.stock.pin_diameter) / 2 + self.play


def runs(motion: Motion, pair: Pair) -> list[Run]:
    """Ranges of the drive in which a pair is nearer than permitted, each from its least to its greatest drive."""
    path = relative_paths(motion, pair.body, pair.other, pair.places)
    numbers = np.flatnonzero(path.gap(pair.corners) < pair.near)
    if not len(numbers):
        return []
    groups = np.split(numbers, np.flatnonzero(np.diff(path.frames[numbers]) > 1) + 1)
    ends = np.append(path.frames[1:], -1)
    ranges = []
    for group in groups:
        first, last = path.frames[group[0]], path.frames[group[-1]]
        last = last + 1 if ends[group[-1]] == last + 1 else last
        low, high = sorted(path.drive[[first, last]].tolist())
        ranges.append((low, high))
    return ranges


@record
class Passing:
    """A pin for the search of layers; plates are bits of integers, plate k the bit 1 << k.

    joins: plates that it joins. bottom, top: whether it continues to the plate below or above all layers. hits: plates
    that it cannot pass.
    """

    joins: int
    bottom: bool
    top: bool
    hits: int

    def through(self, below: Whole) -> Mask:
        """Whether it leads from the plates `below`, or the bottom, up to any other plate, or the top."""
        from_below, up = self.joins & below != 0, self.joins & ~below != 0
        passes: Mask = (self.bottom | from_below) & (self.top | up)
        return passes


@record
class Order:
    """Plates of each layer as bits, from below. collisions: of pins; length: of all pins, in layers."""

    collisions: int
    length: int
    layers: tuple[int, ...]


def order(meets: Sequence[int], pins: Sequence[Passing], clean: bool = True) -> Order | None:
    """The fewest layers for plates of which plate k cannot share a layer with the plates meets[k]: an exact search.

    With equal numbers of layers, the smallest total length of pins. clean: without collisions of pins, None if
    impossible; otherwise with the fewest. A layer depends only on the set of plates below it, not on their order, so
    that only the best result for each set is stored: exact, and the same on every run.
    """
    count = len(meets)
    every = np.arange(1 << count)
    # For each set of plates: whether no two meet; the number of pins that pass above it, and the plates they hit.
    apart, through, barred = np.ones(1 << count, dtype=bool), np.zeros_like(every), np.zeros_like(every)
    for k, others in enumerate(meets):
        apart[1 << k : 2 << k] = apart[: 1 << k] & (every[: 1 << k] & others == 0)
    for pin in pins:
        passes = pin.through(every)
        through += passes
        barred |= np.where(passes, pin.hits, 0)
    # Lists, since access to single elements of arrays is slow.
    is_apart, lengths, hit_by = apart.tolist(), through.tolist(), barred.tolist()
    # For each set of plates: collisions, layers, length of pins, and the plates of the uppermost layer.
    best: dict[int, tuple[int, int, int, int]] = {0: (0, 0, 0, 0)}
    for below in range((1 << count) - 1):
        if below not in best:
            continue
        collisions, layers, length, _ = best[below]
        # A pin that starts in the next layer needs no test: its plate there already excludes the plates it would hit.
        anywhere = hit_by[below]
        hits = [] if clean or not anywhere else [pin.hits for pin in pins if pin.through(every[below])]
        remaining = ((1 << count) - 1) & ~(below | anywhere if clean else below)
        chosen = remaining
        while chosen:
            if is_apart[chosen]:
                hit = sum((some & chosen).bit_count() for some in hits) if chosen & anywhere else 0
                candidate = collisions + hit, layers + 1, length + lengths[below], chosen
                if below | chosen not in best or candidate[:3] < best[below | chosen][:3]:
                    best[below | chosen] = candidate
            chosen = (chosen - 1) & remaining
    full = (1 << count) - 1
    if full not in best:
        return None
    layers_down, unassigned = [], full
    while unassigned:
        layers_down.append(best[unassigned][3])
        unassigned &= ~best[unassigned][3]
    return Order(best[full][0], best[full][2], tuple(layers_down[::-1]))


# Share of a sheet's thickness by which a head may exceed whole layers, so that rounding does not add a layer.
HAIR = 1e-9
# Largest number of rounds in which gaps grow until no head meets a plate.
ROUNDS = 100
# A pin and a plate, or two pins.
Key = tuple[str, str]


@record
class LayeredPin:
    """A pin with the lowest and highest layer that it joins."""

    pin: Pin
    first: int
    last: int


@record
class Disc:
    """A head, nut, ring or shaft around a pin, and its heights, in layers from below."""

    pin: Pin
    what: str
    low: float
    high: float


@record(eq=False)
class Heads:
    """Heads and nuts of a stack, and what they would meet.

    layered_pins: the pins by layers without gaps. layers: of the plates, likewise. plates: as cut.
    """

    meetings: Meetings
    layered_pins: tuple[LayeredPin, ...]
    layers: Mapping[str, int]
    plates: Mapping[str, LinkPlate]
    _pairs: dict[Key, Pair] = field(default_factory=dict)
    _met: dict[Key, bool] = field(default_factory=dict)

    def gaps(self) -> list[int]:
        """Number of empty layers above each layer except the highest, the fewest for which heads meet no plate."""
        gaps = [0] * max(self.layers.values())
        for _ in range(ROUNDS):
            needed, places = list(gaps), with_empty_layers(gaps)
            requests = list(self._requests(places))
            self._test(key for _, _, keys in requests for key in keys)
            for gap, high, keys in requests:
                if any(self._met[key] for key in keys):
                    needed[gap] = max(needed[gap], high)
            if needed == gaps:
                break
            gaps = needed
        return gaps

    def _requests(self, places: list[int]) -> Iterator[tuple[int, int, list[Key]]]:
        """Gaps, the height each needs if any of some pairs meets, and those pairs."""
        up: dict[int, list[tuple[Pin, int]]] = {}
        heights = []
        for layered in self.layered_pins:
            below, above = (int(np.ceil(high - HAIR)) for high in self._ends(layered, places))
            heights.append(below)
            yield (
                layered.last,
                above,
                self._in_layers(layered.pin, places, places[layered.last] + 1, places[layered.last] + above),
            )
            yield (
                layered.first - 1,
                below,
                self._in_layers(layered.pin, places, places[layered.first] - below, places[layered.first] - 1),
            )
            up.setdefault(layered.last, []).append((layered.pin, above))
        for layered, below in zip(self.layered_pins, heights):
            for pin, above in up.get(layered.first - 1, ()):
                if below and above:
                    yield layered.first - 1, below + above, [self._two_discs(pin, layered.pin)]

    def _in_layers(self, pin: Pin, places: list[int], low: int, high: int) -> list[Key]:
        """Pairs of a pin's head and each plate in layers from `low` to `high`."""
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
            # Rings are loose on their pins and give way.
            play = 0.0 if "ring" in what else self.meetings.play
            near = (self._across(one, what[0]) + self._across(two, what[1])) / 2 + play
            self._pairs[key] = Pair(one.body, np.array([one.place]), two.body, np.array([two.place]), near)
        return key

    @cached_property
    def _hulls(self) -> dict[str, Complex]:
        return {name: plate.hull(self.meetings.stock.bar_width) for name, plate in self.plates.items()}

    def _test(self, keys: Iterable[Key]) -> None:
        """Determine for pairs whether they would meet in one layer."""
        new = [key for key in dict.fromkeys(keys) if key not in self._met]
        self._met.update(zip(new, meeting(self.meetings.motion, [self._pairs[key] for key in new]).tolist()))

    def _ends(self, layered: LayeredPin, places: list[int]) -> tuple[float, float]:
        """Heights of a pin's ends below and above its plates, in layers; the nut is where it is out of the way.

        A motor's shaft ends with its plates.
        """
        if layered.pin.shaft:
            return 0.0, 0.0
        stock = self.meetings.stock
        grip = (places[layered.last] - places[layered.first] + 1) * stock.thickness
        head, nut = (high / stock.thickness for high in stock.fastener_used.ends(grip))
        return (nut, head) if layered.first == 0 else (head, nut)

    def _across(self, pin: Pin, what: str = "end") -> float:
        """Diameter of the disc around a pin, mm; rings are as wide as bars."""
        stock = self.meetings.stock
        return stock.bar_width if what == "ring" else max(stock.fastener_used.across, pin.shaft)

    def is_open(self, shaft: LayeredPin) -> bool:
        """Whether a motor's shaft may be longer than its plates: no plate and no pin above would meet it."""
        plates = (name for name, layer in self.layers.items() if layer > shaft.last)
        pins = (layered.pin for layered in self.layered_pins if layered is not shaft and layered.last >= shaft.last)
        keys = [
            *(self._head_and_plate(shaft.pin, name) for name in plates),
            *(self._two_discs(pin, shaft.pin) for pin in pins),
        ]
        self._test(keys)
        return not any(self._met[key] for key in keys)

    def rings(self, gaps: list[int]) -> Iterator[tuple[Pin, int]]:
        """Pins that cross empty layers, each with every such layer: a ring there keeps their plates apart.

        A motor's shaft needs none, since its crank is fixed on it, but occupies the layer itself. Piles are omitted:
        they are clear of all that moves.
        """
        places, ground = with_empty_layers(gaps), self.meetings.ground
        for layered in self.layered_pins:
            if all(self.plates[name].body == ground for name in layered.pin.plates):
                continue
            for k in range(layered.first, layered.last):
                yield from ((layered.pin, layer) for layer in range(places[k] + 1, places[k + 1]))

    def disc_clears(self, pin: Pin, layer: int, others: Iterable[Pin], gaps: list[int]) -> bool:
        """Whether a disc on a pin meets nothing in a layer, counted without gaps: plates, heads, discs of other pins.

        Discs are as wide as bars.
        """
        stock, play = self.meetings.stock, self.meetings.play
        half = stock.bar_width / 2
        # Plates are given by their centres, from which they extend by half a bar.
        obstacles = [(plate.body, self._hulls[n], half) for n, plate in self.plates.items() if self.layers[n] == layer]
        obstacles += [(other.body, np.array([other.place]), half) for other in others]
        heads = [
            head_pin
            for head_pin in self._heads_in(with_empty_layers(gaps), with_empty_layers(gaps)[layer])
            if head_pin is not pin
        ]
        obstacles += [(head.body, np.array([head.place]), stock.fastener_used.across / 2) for head in heads]
        place = np.array([pin.place])
        pairs = [Pair(body, corners, pin.body, place, half + radius + play) for body, corners, radius in obstacles]
        return not meeting(self.meetings.motion, pairs).any()

    def _heads_in(self, places: list[int], at: int) -> Iterator[Pin]:
        """Pins whose head or nut is in a layer, counted with gaps."""
        for layered in self.layered_pins:
            below, above = self._ends(layered, places)
            low, high = places[layered.first], places[layered.last] + 1
            if low - below < at + 1 - HAIR < low or high <= at < high + above - HAIR:
                yield layered.pin

    def collisions(self, gaps: list[int]) -> Iterator[tuple[str, str, Run]]:
        """Remaining collisions: name of the pin, text that says what its head or ring meets, range of the drive."""
        places = with_empty_layers(gaps)
        discs = [Disc(p, "shaft" if p.shaft else "ring", layer, layer + 1) for p, layer in self.rings(gaps)]
        for layered in self.layered_pins:
            below, above = self._ends(layered, places)
            low, high = places[layered.first], places[layered.last] + 1
            discs += [Disc(layered.pin, "end", low - below, low), Disc(layered.pin, "end", high, high + above)]
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
        self._test(key for _, _, key in (*plates, *heads))
        for disc, name, key in plates:
            for run in self._runs(key):
                yield disc.pin.name, f"{name} by its {disc.what}", run
        reported = set()
        for one, two, key in heads:
            if key not in reported:
                for run in self._runs(key):
                    reported.add(key)
                    yield one.pin.name, f"the {two.what} of {two.pin.name} by its {one.what}", run

    def _runs(self, key: Key) -> list[Run]:
        return runs(self.meetings.motion, self._pairs[key]) if self._met[key] else []


def with_empty_layers(gaps: list[int]) -> list[int]:
    """Layer numbers counted with the empty layers."""
    return [k + sum(gaps[:k]) for k in range(len(gaps) + 1)]


def passed_attachments(
    motion: Motion, stock: LinkStock, plates: Mapping[str, LinkPlate], layers: Mapping[str, int]
) -> Iterator[tuple[str, str]]:
    """Names of the attachments and of the plates that pass over their holes, within the height of what is fixed there.

    Which side an attachment is on is not known, so that the larger height counts on both.
    """
    for name, plate in plates.items():
        for item, middle in plate.attached:
            holes, size = attached_holes([(item, middle)], stock.clearance), size_of(item.screw)
            near = stock.bar_width / 2 + PLAY * stock.pin_clearance
            near += max([size.across / 2 if size else 0.0, *(hole.radius for hole in holes)])
            for other, layer in layers.items():
                gap, body = (abs(layer - layers[name]) - 1) * stock.thickness, plates[other].body
                if 0 <= gap < max(item.projections(stock.thickness)) and other != name:
                    hull = plates[other].hull(stock.bar_width)
                    pairs = [Pair(body, hull, plate.body, np.array([hole.centre]), near) for hole in holes]
                    if meeting(motion, pairs).any():
                        yield item.name, other
