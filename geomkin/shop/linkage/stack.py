"""How the plates of a linkage lie on each other so that nothing collides, and what is cut of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ...arguments import checked
from ...brief import one_line
from ...errors import DesignError
from ...linkage.motion import Motion
from ...part import Part
from ...plane.primitives import Circle
from ...plane.vec import Complex, direction_deg, dot
from .layers import Meetings, Order, Passing, order
from .plates import Assembly, LinkStock, Plate, assemble
from .sweep import path_in

# Moving plates that the search takes at most: the worst case of 15 takes five seconds. Each more triples that; fewer
# refuse linkages that could be stacked.
LARGEST = 15
# Directions tried for the two piles that hold up a bridge, in half a turn. Fewer make the bridge longer than need be;
# more take time and save a few hundredths of it at most.
DIRECTIONS = 36
# Joints that the bridge carries.
Way = tuple[str, ...]


@dataclass(frozen=True)
class PinSpan:
    """A pin of a stack. first, last: lowest and highest layer; length mm; holes, slots: plates it turns or runs in."""

    name: str
    first: int
    last: int
    length: float
    holes: tuple[str, ...]
    slots: tuple[str, ...]

    __repr__ = one_line


@dataclass(frozen=True)
class Collision:
    """A pin that meets a plate while the driver goes from `first` to `last`; unit: deg or mm."""

    pin: str
    plate: str
    first: float
    last: float
    unit: str

    __repr__ = one_line

    def __str__(self) -> str:
        return f"pin {self.pin} meets {self.plate} from {self.first:.4g} to {self.last:.4g} {self.unit}"


@dataclass(frozen=True, eq=False)
class Stack:
    """How plates lie on each other.

    layers: the layer of each plate, the fixed one 0, upwards. pins: what each joins and how long it is.
    collisions: empty where the stack can be built; otherwise those of the stack that has the fewest. plates:
    as they are to be cut, ground and bridge apart. spacers: how many discs hold up the bridge, 0 without one.
    """

    layers: Mapping[str, int]
    pins: tuple[PinSpan, ...]
    collisions: tuple[Collision, ...]
    plates: Mapping[str, Plate]
    spacers: int = 0

    __repr__ = one_line

    def summary(self) -> dict[str, object]:
        """The same as plain lists for a file, layers from the bottom up."""
        rows: list[list[str]] = [[] for _ in range(1 + max(self.layers.values()))]
        for name, layer in self.layers.items():
            rows[layer].append(name)
        pins = [
            {
                "name": pin.name,
                "layers": [pin.first, pin.last],
                "length_mm": float(f"{pin.length:.10g}"),
                "holes_in": list(pin.holes),
                "slots_in": list(pin.slots),
            }
            for pin in self.pins
        ]
        return {"layers": rows, "pins": pins, "collisions": [str(c) for c in self.collisions]}


@checked
def stack_links(motion: Motion, stock: LinkStock = LinkStock()) -> Stack:
    """The plates of a linkage in the fewest layers, and among those with the least total length of pins.

    The ground at the bottom carries all fixed pivots and slots. Where that cannot be, a second fixed plate on
    top, the bridge, carries some of them: again the fewest layers, then the fewest carried. Two piles of
    discs, beside all that moves, hold it up. Exact for the motion's frames, and between them as far as
    `Sweep` tells, for frames a few degrees apart that follow each other. What no stack can do is told by the
    collisions of the one that has the fewest. Raises DesignError for more than 15 moving plates, where no frame
    closes, and for many linkages at once. Derived here.
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
    needs is one more plate, and the discs that hold the bridge up are the part `spacer`, as many as its count says.
    Without it, the fixed body is one plate. Raises DesignError where no frame closes, where openings run into each
    other, where guide pins find no room, and for many linkages at once. Derived here.
    """
    plates = stack.plates if stack else assemble(motion, stock).plates
    parts = [plate.part(name, stock, motion.linkage) for name, plate in plates.items()]
    if stack and stack.spacers:
        disc, hole = Circle(0j, stock.bar_width / 2), Circle(0j, stock.hole_diameter / 2)
        parts.append(Part("spacer", disc, (hole,), stock.thickness, count=stack.spacers, body=motion.linkage.ground))
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
    bridge = "bridge"
    while bridge in plates:
        bridge += "_"
    spans = []
    for pin in meetings.assembly.pins:
        fixed = bridge if pin.joint in way else ground
        holes, slots = (tuple(fixed if n == ground else n for n in names) for names in (pin.holes, pin.slots))
        ends = [top if name == bridge else layers[name] for name in holes + slots]
        length = (max(ends) - min(ends) + 1) * stock.thickness
        spans.append(PinSpan(pin.name, min(ends), max(ends), length, holes, slots))
    collisions = tuple(_collisions(meetings, spans, layers))
    if not way:
        return Stack(layers, tuple(spans), collisions, plates)
    plates[ground], plates[bridge] = split(meetings.assembly, ground, way)
    layers[bridge] = top
    for k, place in enumerate(pile_places(meetings.motion, meetings.assembly, stock.bar_width + meetings.play)):
        name = f"spacer_{k + 1}"
        plates[ground].openings[name] = plates[bridge].openings[name] = (place,)
        spans.append(PinSpan(name, 0, top, (top + 1) * stock.thickness, (ground, bridge), ()))
    return Stack(layers, tuple(spans), collisions, plates, spacers=2 * (top - 1))


def _collisions(meetings: Meetings, spans: list[PinSpan], layers: Mapping[str, int]) -> Iterator[Collision]:
    slides = meetings.motion.linkage.driven_slider is not None
    for (name, plate), runs in meetings.pin_and_plate.items():
        pin = next(span for span in spans if span.name == name)
        if pin.first <= layers[plate] <= pin.last:
            for run in runs:
                first, last = run if slides else np.degrees(run)
                yield Collision(name, plate, float(first), float(last), "mm" if slides else "deg")


def ways(assembly: Assembly, ground: str) -> list[Way]:
    """All choices of joints for the bridge, the fewest first; the first is none."""
    fixed = list(dict.fromkeys(pin.joint for pin in assembly.pins if ground in pin.plates))
    # All of them on the bridge would be the same stack upside down.
    return [way for size in range(max(1, len(fixed))) for way in combinations(fixed, size)]


def split(assembly: Assembly, ground: str, way: Way) -> tuple[Plate, Plate]:
    """Ground and bridge, each with its own openings."""
    joints = {pin.name: pin.joint for pin in assembly.pins}
    plates = Plate(ground), Plate(ground)
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
