"""A second fixed plate on top of a linkage: what it carries, and the two piles that hold it up."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import combinations, product
from string import ascii_uppercase

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.records import record
from ...making.assembly import Bill, shaft_bill
from ...making.bores import fits_of
from ...making.fasteners import Fastener, gathered
from ...making.motors import fixed_under
from ...model.part import Bought, Part
from ...plane.primitives import Circle
from ...plane.vec import Complex, direction_deg, dot
from ..motion import Motion
from .collisions import path_in
from .layers import Heads, Meetings, Order, Passing, Reach, Run, order, placed, runs
from .plates import Assembly, Pin, Plate, assemble, opened, unused
from .stock import LinkStock

# Directions tried for the two piles that hold up a bridge, in half a turn. Fewer make the bridge longer than need be;
# more take time and save a few hundredths of it at most.
DIRECTIONS = 36
# Joints that the bridge carries.
Way = tuple[str, ...]


def ways(assembly: Assembly, ground: str) -> list[Way]:
    """All choices of joints for the bridge, the fewest first; the first is none. A motor is never above."""
    fixed = list(dict.fromkeys(pin.joint for pin in assembly.pins if ground in pin.plates))
    on_ground = {pin.joint for pin in assembly.pins if pin.shaft}
    # All of them on the bridge would be the same stack upside down.
    some = (way for size in range(max(1, len(fixed))) for way in combinations(fixed, size))
    return [way for way in some if not on_ground & set(way)]


def split(assembly: Assembly, ground: str, way: Way) -> tuple[Plate, Plate]:
    """Ground and bridge, each with its own openings."""
    joints = {pin.name: pin.joint for pin in assembly.pins}
    plates = Plate(ground, {}, assembly.plates[ground].seat), Plate(ground)
    for name, places in assembly.plates[ground].openings.items():
        plates[joints.get(name, name) in way].openings[name] = places
    return plates


def pile_places(motion: Motion, assembly: Assembly, near: float) -> tuple[complex, complex]:
    """Places in the ground's frame on two sides of all that moves, at least `near` mm from every plate's centres.

    The two sides are those between which the mechanism is narrowest.
    """
    ground = motion.linkage.ground
    still = assembly.plates[ground].centres
    moving = [path_in(motion, ground, p.body, p.centres) for name, p in assembly.plates.items() if name != ground]
    middle = complex(still.mean())

    def out(direction: Complex) -> float:
        reach = max(float(dot(direction, still).max()), *(path.reach(complex(direction)) for path in moving))
        return reach - float(dot(direction, middle)) + near

    directions = direction_deg(180 / DIRECTIONS * np.arange(DIRECTIONS))
    widths = [out(u) + out(-u) for u in directions]
    # Compared to ten digits, so that rounding does not choose between two directions that are equally good.
    best = directions[min(range(DIRECTIONS), key=lambda k: (float(f"{widths[k]:.10g}"), k))]
    return middle + complex(best) * out(best), middle - complex(best) * out(-best)


# Moving plates that the search takes at most: the worst case of 15 takes five seconds. Each more triples that; fewer
# refuse linkages that could be stacked.
LARGEST = 15


@record
class PinSpan:
    """A pin of a stack.

    first, last: lowest and highest layer; length: through all of them, mm; holes, slots: plates it turns or runs in;
    spacers: layers, empty of its plates, where a disc keeps them apart. motor: what is bought where it is the shaft of
    a motor, which is screwed below the ground; empty for a pin.
    """

    name: str
    first: int
    last: int
    length: float
    holes: tuple[str, ...]
    slots: tuple[str, ...]
    spacers: tuple[int, ...] = ()
    motor: Bill = ()


@record
class Collision:
    """A pin that meets a plate, or a head that meets something, while the driver goes from `first` to `last`.

    unit: deg or mm.
    """

    pin: str
    plate: str
    first: float
    last: float
    unit: str

    def __str__(self) -> str:
        return f"pin {self.pin} meets {self.plate} from {self.first:.4g} to {self.last:.4g} {self.unit}"


@record(eq=False)
class Stack:
    """How plates lie on each other.

    layers: the layer of each plate, the fixed one 0, upwards. pins: what each joins and how long it is.
    collisions: empty where the stack can be built; otherwise those of the stack that has the fewest. plates:
    as they are to be cut, ground and bridge apart. fastener: what holds the pins; where its heads would meet
    plates, layers between them are empty.
    """

    layers: Mapping[str, int]
    pins: tuple[PinSpan, ...]
    collisions: tuple[Collision, ...]
    plates: Mapping[str, Plate]
    fastener: Fastener

    @property
    def spacers(self) -> int:
        """How many discs keep plates apart: on pins that cross empty layers, and under a bridge."""
        return sum(len(pin.spacers) for pin in self.pins)

    @cached_property
    def letters(self) -> Mapping[str, str]:
        """A short name for each pin, engraved at its holes: A to Z, then AA and so on."""
        signs = [*ascii_uppercase, *("".join(two) for two in product(ascii_uppercase, repeat=2))]
        return dict(zip((pin.name for pin in self.pins), signs))

    @property
    def bought(self) -> tuple[Bought, ...]:
        """What is bought to join the plates, for joints by their letters."""
        return gathered([(self.letters[pin.name], self.bill(pin)) for pin in self.pins])

    def bill(self, pin: PinSpan) -> Bill:
        """What one of its pins takes."""
        return pin.motor or self.fastener.bill(pin.length)

    @property
    def steps(self) -> tuple[str, ...]:
        """How it is put together, from the bottom up: a line for each layer."""
        return tuple(self._steps())

    def _steps(self) -> Iterator[str]:
        of = self.letters
        motors, pins = ([pin for pin in self.pins if bool(pin.motor) == turns] for turns in (True, False))
        from_above = [pin for pin in pins if pin.first == 0 and self.fastener.length(pin.length)]
        for layer in range(1 + max(self.layers.values())):
            plates = [name for name, at in self.layers.items() if at == layer]
            told = [
                (
                    "put {} through from below",
                    [of[pin.name] for pin in pins if pin.first == layer and pin not in from_above],
                ),
                ("lay {}", plates),
                ("{}", [fixed_under(plates[0], of[pin.name]) for pin in motors if pin.first == layer]),
                ("a spacer on {}", [of[pin.name] for pin in self.pins if layer in pin.spacers]),
                (
                    "nothing on {}, which a plate here passes",
                    [of[pin.name] for pin in pins if layer in self._bare(pin)],
                ),
                ("close {}", [of[pin.name] for pin in pins if pin.last == layer and pin not in from_above]),
                # Where their nuts are out of the way, and room is left for heads alone.
                ("put {} through from above, nuts below", [of[pin.name] for pin in from_above if pin.last == layer]),
                ("fix {}", [self._on_motor(pin) for pin in motors if pin.last == layer]),
            ]
            yield f"layer {layer}: {'; '.join(how.format(', '.join(names)) for how, names in told if names)}"

    def _on_motor(self, pin: PinSpan) -> str:
        """How the crank is put on a motor's shaft, which alone holds it where layers under it are empty."""
        low, crank = (next(name for name in pin.holes if self.layers[name] == layer) for layer in (pin.first, pin.last))
        crossed = pin.last - pin.first - 1
        height = f", {crossed * pin.length / (crossed + 2):.6g} mm above {low}" if crossed else ""
        return f"{crank} on the motor's shaft {self.letters[pin.name]}, flat on flat{height}"

    def _bare(self, pin: PinSpan) -> set[int]:
        """Layers that a pin crosses with neither plate nor spacer."""
        held = {self.layers[name] for name in pin.holes + pin.slots}.union(pin.spacers)
        return set(range(pin.first, pin.last + 1)) - held

    def summary(self) -> dict[str, object]:
        """The same as plain lists for a file, layers from the bottom up."""
        rows: list[list[str]] = [[] for _ in range(1 + max(self.layers.values()))]
        for name, layer in self.layers.items():
            rows[layer].append(name)
        pins = [
            {
                "name": pin.name,
                "letter": self.letters[pin.name],
                "layers": [pin.first, pin.last],
                "length_mm": float(f"{pin.length:.10g}"),
                "holes_in": list(pin.holes),
                "slots_in": list(pin.slots),
                "spacers_in": list(pin.spacers),
            }
            for pin in self.pins
        ]
        bought = [item.data for item in self.bought]
        collisions = [str(c) for c in self.collisions]
        return {"layers": rows, "pins": pins, "collisions": collisions, "bought": bought, "steps": list(self.steps)}


@checked
def stack_links(motion: Motion, stock: LinkStock = LinkStock()) -> Stack:
    """The plates of a linkage in the fewest layers, and among those with the least total length of pins.

    The ground at the bottom carries all fixed pivots and slots. Where that cannot be, a second fixed plate on
    top, the bridge, carries some of them: again the fewest layers, then the fewest carried. Two piles of
    discs, beside all that moves, hold it up. Exact for the motion's frames, and between them as far as
    `Sweep` tells, for frames a few degrees apart that follow each other. What no stack can do is told by the
    collisions of the one that has the fewest. Raises DesignError for more than 15 moving plates, where no frame
    closes, for more frames than can be looked at, and for many linkages at once. Derived here.
    """
    found = assemble(motion, stock)
    meetings = Meetings(motion, stock, found)
    if len(meetings.moving) > LARGEST:
        raise DesignError(
            "bodies", f"found {len(meetings.moving)} plates that move", f"give at most {LARGEST}, or make it in pieces"
        )
    # Where openings run into each other whatever the bridge carries, `link_parts` says which.
    fitting: list[Way] = [way for way in ways(found, meetings.ground) if _fits(meetings, way)] or [()]
    for some in ([way for way in fitting if not way], [way for way in fitting if way]):
        clean = [(way, best) for way in some if (best := _order(meetings, way))]
        if clean:
            return _stack(meetings, *min(clean, key=lambda c: (len(c[1].layers), len(c[0]), c[1].length)))
    least = _order(meetings, fitting[0], clean=False)
    assert least is not None
    return _stack(meetings, fitting[0], least)


@checked
def link_parts(motion: Motion, stock: LinkStock = LinkStock(), stack: Stack | None = None) -> tuple[Part, ...]:
    """The plates of a linkage, each in its body's own frame: holes for pins and traced points, slots for slides.

    motion: over the whole way that the linkage is to go; slots are as long as the travel over its frames. stack:
    `stack_links(motion, stock)`, where the plates are to lie on each other so that nothing collides: a bridge that it
    needs is one more plate, and the discs that keep plates apart are the part `spacer`, as many as its count says.
    Without it, the fixed body is one plate. Raises DesignError where no frame closes, where openings run into each
    other or lie over a motor, where guide pins find no room, and for many linkages at once. Derived here.
    """
    plates = stack.plates if stack else assemble(motion, stock).plates
    letters = stack.letters if stack else {}
    parts = [plate.part(name, stock, motion.linkage, letters) for name, plate in plates.items()]
    if stack and stack.spacers:
        disc, hole = Circle(0j, stock.bar_width / 2), Circle(0j, stock.hole_diameter / 2)
        fits = fits_of(stock.pin_diameter, stock.clearance)
        name = unused("spacer", plates)
        parts.append(Part(name, disc, (hole,), stock.thickness, count=stack.spacers, fits=fits))
    return tuple(parts)


def _fits(meetings: Meetings, way: Way) -> bool:
    """Whether no openings of the ground, or of the bridge, run into each other."""
    plates = split(meetings.assembly, meetings.ground, way)
    return not any(True for plate in plates for _ in plate.crossings(meetings.stock))


def _order(meetings: Meetings, way: Way, clean: bool = True) -> Order | None:
    """The best order of the moving plates when the bridge carries the joints of `way`."""
    ground, pins = meetings.ground, meetings.assembly.pins
    bits = {name: 1 << k for k, name in enumerate(meetings.moving)}
    meets = [sum(b for other, b in bits.items() if frozenset((name, other)) in meetings.plates) for name in bits]
    passing = [
        Passing(
            joins=sum(bits[name] for name in pin.plates if name != ground),
            bottom=ground in pin.plates and pin.joint not in way,
            top=ground in pin.plates and pin.joint in way,
            hits=sum(bit for name, bit in bits.items() if (pin.name, name) in meetings.pin_and_plate),
        )
        for pin in pins
    ]
    return order(meets, passing, clean)


def _stack(meetings: Meetings, way: Way, best: Order) -> Stack:
    ground, stock = meetings.ground, meetings.stock
    top = 1 + len(best.layers)
    plates, layers = dict(meetings.assembly.plates), {ground: 0}
    for k, name in enumerate(meetings.moving):
        layers[name] = next(1 + n for n, row in enumerate(best.layers) if row >> k & 1)
    bridge = unused("bridge", plates)
    carried = {pin.name: pin.joint in way for pin in meetings.assembly.pins}
    pins = list(meetings.assembly.pins)
    if way:
        plates[ground], plates[bridge] = split(meetings.assembly, ground, way)
        layers[bridge] = top
        for k, place in enumerate(pile_places(meetings.motion, meetings.assembly, stock.bar_width + meetings.play)):
            name = unused(f"spacer_{k + 1}", opened(plates))
            plates[ground].openings[name] = plates[bridge].openings[name] = (place,)
            pins.append(Pin(name, name, ground, place, (ground, bridge), ()))
    spans = []
    for pin in pins:
        fixed = bridge if carried.get(pin.name) else ground
        holes, slots = (tuple(fixed if n == ground else n for n in names) for names in (pin.holes, pin.slots))
        ends = [layers[name] for name in holes + slots]
        spans.append(PinSpan(pin.name, min(ends), max(ends), 0.0, holes, slots))
    return _spread(meetings, Stack(layers, tuple(spans), (), plates, stock.fastener_used), pins)


def _spread(meetings: Meetings, stack: Stack, pins: Sequence[Pin]) -> Stack:
    """The stack with layers left empty where heads need them, and what collides in it."""
    reaches = tuple(Reach(pin, span.first, span.last) for pin, span in zip(pins, stack.pins))
    heads = Heads(meetings, reaches, stack.layers, stack.plates)
    gaps = heads.gaps()
    places = placed(gaps)
    layers = {name: places[layer] for name, layer in stack.layers.items()}
    joints = {pin.name for pin in meetings.assembly.pins}
    spans: list[PinSpan] = []
    discs_in: dict[int, list[Pin]] = {}
    for pin, span in zip(pins, stack.pins):
        first, last = places[span.first], places[span.last]
        own = {layers[name] for name in span.holes + span.slots}
        # Under a crank on a motor's shaft is the hole for the motor's boss, so that it is held by the shaft alone.
        discs = [] if pin.shaft else [n for n in range(first + 1, last) if n not in own]
        if span.name in joints:
            # A pile fills all between its plates; another pin only where no plate comes in the disc's way.
            empty, held = [n for n in discs if n not in places], [n for n in discs if n in places]
            clear = (n for n in held if heads.disc_clears(pin, places.index(n), discs_in.get(n, ()), gaps))
            discs = sorted([*empty, *clear])
        for n in discs:
            discs_in.setdefault(n, []).append(pin)
        length = (last - first + 1) * meetings.stock.thickness
        spans.append(replace(span, first=first, last=last, length=length, spacers=tuple(discs)))
    spans = [
        replace(span, motor=_motor_bill(meetings.stock, span.length, heads.is_open(reach))) if reach.pin.shaft else span
        for span, reach in zip(spans, reaches)
    ]
    found = replace(stack, layers=layers, pins=tuple(spans))
    return replace(found, collisions=tuple(_collisions(meetings, found, heads.collisions(gaps))))


def _motor_bill(stock: LinkStock, length: float, is_open: bool) -> Bill:
    """The motor, its shaft through plates of a length together, mm, and no longer where anything passes over it."""
    assert stock.shaft is not None
    return shaft_bill(stock.shaft, length, base=stock.thickness, is_cut=not is_open)


def _collisions(meetings: Meetings, stack: Stack, others: Iterable[tuple[str, str, Run]]) -> Iterator[Collision]:
    slides = meetings.motion.linkage.driven_slider is not None
    spans = {span.name: span for span in stack.pins}
    pins = (
        (name, plate, run)
        for (name, plate), pair in meetings.pin_and_plate.items()
        if spans[name].first <= stack.layers[plate] <= spans[name].last
        for run in runs(meetings.motion, pair)
    )
    for name, what, run in (*pins, *others):
        first, last = run if slides else np.degrees(run)
        yield Collision(name, what, float(first), float(last), "mm" if slides else "deg")
