"""The order of a linkage's plates in layers, with a second fixed plate on top if needed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import combinations, permutations, product
from string import ascii_uppercase

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import to_digits
from ...core.records import record
from ...core.units import Sentence, mm, sentences
from ...making.assembly import Bill, glue_bill, shaft_bill
from ...making.bores import fits_of
from ...making.fasteners import Fastener, PinPlace, SnapPin, alike, gathered, pin_parts
from ...making.materials import STEEL_DENSITY
from ...making.motors import fixed_under
from ...model.material import Mass
from ...model.part import Bought, Part
from ...model.scene import layer_name
from ...plane.primitives import Circle, rounded_hull
from ...plane.vec import Complex, direction_deg, dot
from ..motion import Motion
from .collisions import relative_paths
from .layers import Heads, LayeredPin, Meetings, Order, Passing, Run, order, runs, with_empty_layers
from .plates import LinkAssembly, LinkPlate, Pin, assemble, opened, unused
from .stock import LinkStock

# Number of directions tried, within half a turn, for the two piles that support a bridge.
DIRECTIONS = 36
# Name of the plates between a motor and the ground.
MOTOR_PLATE = "motor_plate"
# How joints are closed, and how their pins come from above, by the form of the fastener.
CLOSED = {"screw": "close {}", "rod": "close {}", "snap": "press {} in from below until the barbs snap out above"}
FROM_ABOVE = {
    "screw": "put {} through from above, nuts below",
    "rod": "",
    "snap": "press {} in from above until the barbs snap out below",
}
# Joints that the bridge carries.
Carried = tuple[str, ...]


def bridge_options(assembly: LinkAssembly, ground: str) -> list[Carried]:
    """All choices of joints for the bridge, the fewest first; the first is none. A motor is never on the bridge."""
    fixed = list(dict.fromkeys(pin.joint for pin in assembly.pins if ground in pin.plates))
    on_ground = {pin.joint for pin in assembly.pins if pin.shaft}
    # All joints on the bridge would be the same stack upside down.
    options = (joints for size in range(max(1, len(fixed))) for joints in combinations(fixed, size))
    return [joints for joints in options if not on_ground & set(joints)]


def split(assembly: LinkAssembly, ground: str, carried: Carried) -> tuple[LinkPlate, LinkPlate]:
    """Ground and bridge, each with its openings."""
    joints = {pin.name: pin.joint for pin in assembly.pins}
    plates = replace(assembly.plates[ground], openings={}), LinkPlate(ground)
    for name, places in assembly.plates[ground].openings.items():
        plates[joints.get(name, name) in carried].openings[name] = places
    return plates


def pile_places(motion: Motion, assembly: LinkAssembly, width: float, play: float) -> tuple[complex, complex]:
    """Positions in the ground's frame on two sides of all that moves, for discs as wide as bars, mm, with some play.

    The two sides are those between which the mechanism is narrowest.
    """
    ground = motion.linkage.ground
    fixed = assembly.plates[ground].centres
    moving = [
        relative_paths(motion, ground, p.body, p.hull(width)) for name, p in assembly.plates.items() if name != ground
    ]
    middle = complex(fixed.mean())

    def out(direction: Complex) -> float:
        extent = max(float(dot(direction, fixed).max()), *(path.extent(complex(direction)) for path in moving))
        return extent - float(dot(direction, middle)) + width + play

    directions = direction_deg(180 / DIRECTIONS * np.arange(DIRECTIONS))
    widths = [out(u) + out(-u) for u in directions]
    # Compared to ten digits, so that rounding does not choose between equally good directions.
    best = directions[min(range(DIRECTIONS), key=lambda k: (to_digits(widths[k], 10), k))]
    return middle + complex(best) * out(best), middle - complex(best) * out(-best)


# Largest number of moving plates: the worst case of 15 takes five seconds, and each more triples the time.
LARGEST = 15


@record
class PinSpan:
    """A pin of a stack.

    Parameters
    ----------
    name : str
        Name of the joint.
    first, last : int
        Lowest and highest layer.
    length : float
        Through all layers, mm.
    holes, slots : tuple of str
        Plates in which it turns, and plates in whose slots it runs.
    spacers : tuple of int
        Layers without its plates, in which a disc keeps the others apart.
    motor : tuple
        Bill of the motor, if the pin is the shaft of a motor, which is screwed below the ground; otherwise empty.
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
        span = mm(self.first, self.last, unit=self.unit, between=" to ")
        return Sentence(f"pin {self.pin} meets {self.plate} from {span:.4g}")


@record(eq=False)
class Stack:
    """Layers of the plates of a linkage, and the pins through them.

    Parameters
    ----------
    layers : mapping of str to int
        Layer of each plate, the fixed one 0, upwards.
    pins : tuple of PinSpan
        The pins.
    collisions : tuple of Collision
        Empty if the stack can be built; otherwise those of the stack with the fewest.
    plates : mapping of str to LinkPlate
        The plates as cut, ground and bridge separately.
    fastener : Fastener
        Fastener of the pins. Layers stay empty where its heads would meet plates.
    frame : tuple of str
        Holes of the ground for the rods of a frame that joins copies.
    motor_plates : int
        Number of plates between the motor and the ground, for a boss that is higher than the ground is thick.
    """

    layers: Mapping[str, int]
    pins: tuple[PinSpan, ...]
    collisions: tuple[Collision, ...]
    plates: Mapping[str, LinkPlate]
    fastener: Fastener
    frame: tuple[str, ...] = ()
    motor_plates: int = 0

    @property
    def spacers(self) -> int:
        """Number of discs that keep plates apart: on pins that cross empty layers, and under a bridge."""
        return sum(len(pin.spacers) for pin in self.pins)

    @cached_property
    def letters(self) -> Mapping[str, str]:
        """Letter of each pin and of each rod of a frame, engraved at its holes: A to Z, then AA and so on."""
        signs = [*ascii_uppercase, *("".join(two) for two in product(ascii_uppercase, repeat=2))]
        return dict(zip((*(pin.name for pin in self.pins), *self.frame), signs))

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Bought items that join the plates, with the letters of their joints."""
        return gathered([(self.letters[pin.name], self.bill(pin)) for pin in self.pins])

    def bill(self, pin: PinSpan) -> Bill:
        """Bought items of one pin.

        Parameters
        ----------
        pin : PinSpan
            A pin of this stack.

        Returns
        -------
        tuple
        """
        return pin.motor or self.fastener.bill(pin.length)

    @property
    def snap_pins(self) -> list[PinPlace]:
        """The printed pins, if they join the plates."""
        pin = self.fastener
        pins = [span for span in self.pins if not span.motor] if isinstance(pin, SnapPin) else []
        return [PinPlace(self.letters[span.name], pin, span.length) for span in pins]  # type: ignore[arg-type]

    @property
    def steps(self) -> tuple[str, ...]:
        """Assembly steps from the bottom up, one line for each layer."""
        return sentences((*self.steps_with({}), *self.closing))

    @property
    def closing(self) -> tuple[str, ...]:
        """How joints are closed; nothing for rods."""
        if self.fastener.form != "screw":
            return ()
        fixing = [
            self.letters[pin.name]
            for pin in self.pins
            if pin.first and len({self.plates[name].body for name in pin.holes + pin.slots}) == 1
        ]
        tight = f"; only {' and '.join(fixing)}, which fixes a gear on its crank, is tight" if fixing else ""
        return (f"a joint is closed by its washer and nut, which stay so loose that the links turn{tight}",)

    def steps_with(self, rods: Mapping[str, tuple[int, str]]) -> Iterator[str]:
        """The same if some pins are rods that another copy shares.

        Parameters
        ----------
        rods : mapping
            By the pin's name, the layer in which its rod is put in, and the step.
        """
        letters, form = self.letters, self.fastener.form
        printed = {place.letter: name for name, group in alike(self.snap_pins).items() for place in group}
        names = {pin: f"{printed[at]} at {at}" if at in printed else at for pin, at in letters.items()}
        motors = [pin for pin in self.pins if pin.motor]
        pins = [pin for pin in self.pins if not pin.motor and pin.name not in rods]
        from_above = [pin for pin in pins if pin.first == 0 and self.fastener.length(pin.length)]
        for layer in range(1 + max(self.layers.values())):
            plates = [name for name, own_layer in self.layers.items() if own_layer == layer]
            steps = [
                (
                    "put {} through from below",
                    [names[pin.name] for pin in pins if pin.first == layer and pin not in from_above],
                ),
                ("lay {}", plates),
                (
                    "{}",
                    [
                        fixed_under(plates[0], letters[pin.name], pin.motor[1][1], self.motor_plates)
                        for pin in motors
                        if pin.first == layer
                    ],
                ),
                ("a spacer on {}", [letters[pin.name] for pin in self.pins if layer in pin.spacers]),
                (
                    "nothing on {}, which a plate here passes",
                    [letters[pin.name] for pin in pins if layer in self._uncovered_layers(pin)],
                ),
                (CLOSED[form], [names[pin.name] for pin in pins if pin.last == layer and pin not in from_above]),
                # Nuts and barbs are below the ground, since only heads have room above.
                (FROM_ABOVE[form], [names[pin.name] for pin in from_above if pin.last == layer]),
                ("fix {}", [self._on_motor(pin) for pin in motors if pin.last == layer]),
                ("{}", [step for at, step in rods.values() if at == layer]),
            ]
            yield f"{layer_name(layer)}: {'; '.join(how.format(', '.join(names)) for how, names in steps if names)}"

    def _on_motor(self, pin: PinSpan) -> str:
        """How the crank is fixed on a motor's shaft, the only support if layers below it are empty."""
        low, *turning = sorted(pin.holes, key=self.layers.__getitem__)
        crossed, sheets = self.layers[turning[0]] - pin.first - 1, pin.last - pin.first + 1
        height = f", {mm(crossed * pin.length / sheets):.6g} above {low}" if crossed else ""
        seat = self.plates[turning[0]].seat
        fit = seat.fits[0] if seat else None
        fixed = ", flat on flat" if fit and fit.flat else ""
        fixed += "" if fit and (fit.is_press or fit.play < 0) else ", and glue it"
        return f"{', '.join(turning)} on the motor's shaft {self.letters[pin.name]}{fixed}{height}"

    def _uncovered_layers(self, pin: PinSpan) -> set[int]:
        """Layers that a pin crosses without a plate or spacer."""
        occupied = {self.layers[name] for name in pin.holes + pin.slots}.union(pin.spacers)
        return set(range(pin.first, pin.last + 1)) - occupied

    def summary(self) -> dict[str, object]:
        """The stack as plain lists for a file, layers from the bottom up."""
        rows: list[list[str]] = [[] for _ in range(1 + max(self.layers.values()))]
        for name, layer in self.layers.items():
            rows[layer].append(name)
        pins = [
            {
                "name": pin.name,
                "letter": self.letters[pin.name],
                "layers": [pin.first, pin.last],
                "length_mm": to_digits(pin.length, 10),
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
    """Arrange the plates of a linkage in the fewest layers, and among these with the least total length of pins.

    The ground at the bottom carries all fixed pivots and slots. If that is not possible, a second fixed plate on top,
    the bridge, carries some of them: again the fewest layers, then the fewest carried. Two piles of discs, outside all
    that moves, support it.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage over its whole range, in frames a few degrees apart.
    stock : LinkStock
        Sheet and pins.

    Returns
    -------
    Stack
        If every stack has collisions, the one with the fewest.

    Raises
    ------
    DesignError
        If there are more than 15 moving plates, no frame is closed, there are too many frames, or the motion is of
        arrays of linkages.

    Notes
    -----
    Exact for the motion's frames, and between them to second order. Derived here.
    """
    return stack_assembly(motion, stock, assemble(motion, stock))


def stack_assembly(motion: Motion, stock: LinkStock, assembly: LinkAssembly) -> Stack:
    """Arrange given plates as `stack_links` does."""
    meetings = Meetings(motion, stock, assembly)
    if (count := len({*meetings.layered.values()})) > LARGEST:
        problem = f"found {count} plates that move"
        raise DesignError("bodies", problem, f"give at most {LARGEST}, or make it in pieces", "too-much-work")
    if stock.fastener_used.form == "snap" and (slotted := next((pin for pin in assembly.pins if pin.slots), None)):
        problem = f"found snap, but pin {slotted.name} runs in a slot, in which flat pins turn and slip out"
        raise DesignError("printing.pins", problem, 'give "bought"', "conflict")
    # If openings overlap whatever the bridge carries, `link_parts` reports which.
    options = bridge_options(meetings.assembly, meetings.ground)
    fitting: list[Carried] = [carried for carried in options if _fits(meetings, carried)] or [()]
    for some in ([carried for carried in fitting if not carried], [carried for carried in fitting if carried]):
        clean = [(carried, best) for carried in some if (best := _order(meetings, carried))]
        if clean:
            return _stack(meetings, *min(clean, key=lambda c: (len(c[1].layers), len(c[0]), c[1].length)))
    least = _order(meetings, fitting[0], clean=False)
    assert least is not None
    return _stack(meetings, fitting[0], least)


def fastener_masses(motion: Motion, stock: LinkStock, stack: Stack) -> dict[str, Mass]:
    """Masses of the screws or rods of a stack, with the discs on them, by the body of the lowest plate of each.

    Their inertia about themselves is left out. A motor's shaft belongs to the motor, not to a body.
    """
    disc = np.pi / 4 * (stock.bar_width**2 - stock.spacer_hole**2) * stock.thickness
    spacer = disc * stock.material.density if stock.material else 0.0
    bodies: dict[str, Mass] = {}
    for pin in stack.pins:
        if pin.holes:
            plate = stack.plates[min(pin.holes, key=stack.layers.__getitem__)]
            body, place = plate.body, plate.openings[pin.name][0]
        else:
            # A pin that slides in all its plates is a body of its own.
            body = motion.linkage.pins[pin.name][0]
            place = complex(motion.linkage.bodies[body][pin.name])
        density = getattr(stack.fastener, "density", STEEL_DENSITY)
        steel = 0.0 if pin.motor else density * stack.fastener.volume(pin.length)
        mass = Mass(1e-9 * (steel + spacer * len(pin.spacers)), place)
        bodies[body] = bodies[body] + mass if body in bodies else mass
    return bodies


@checked
def link_parts(motion: Motion, stock: LinkStock = LinkStock(), stack: Stack | None = None) -> tuple[Part, ...]:
    """The plates of a linkage, each in its body's frame: holes for pins and traced points, slots for slides.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage over its whole range; slots are as long as the travel over its frames.
    stock : LinkStock
        Sheet and pins.
    stack : Stack, optional
        `stack_links(motion, stock)`, if the plates are to be stacked without collisions: it adds a bridge, if needed,
        and the part `spacer` with its count. Without it the fixed body is one plate.

    Returns
    -------
    tuple of Part

    Raises
    ------
    DesignError
        If no frame is closed, openings overlap or are over a motor, guide pins have no room, or the motion is of arrays
        of linkages.

    Notes
    -----
    Derived here.
    """
    plates = stack.plates if stack else assemble(motion, stock).plates
    letters = stack.letters if stack else {}
    parts = [plate.part(name, stock, motion.linkage, letters) for name, plate in plates.items()]
    if stack and stack.spacers:
        disc, hole = Circle(0j, stock.bar_width / 2), Circle(0j, stock.spacer_hole / 2)
        fits = fits_of(stock.pin_diameter, stock.clearance)
        name = unused("spacer", plates)
        parts.append(
            Part(name, disc, (hole,), stock.thickness, count=stack.spacers, fits=fits, material=stock.material)
        )
    if stack and stack.motor_plates:
        parts.append(motor_packing(stack, stock))
    pins = pin_parts(stack.snap_pins) if stack else ()
    parts += (replace(pin, name=unused(pin.name, plates), material=stock.material) for pin in pins)
    return tuple(parts)


def motor_packing(stack: Stack, stock: LinkStock) -> Part:
    """The plates under the ground that take up the rest of the motor's boss, in the ground's frame."""
    ground = next(plate for plate in stack.plates.values() if plate.seat and plate.seat.rim.size)
    assert ground.seat is not None
    outline = rounded_hull(ground.seat.rim, stock.bar_width / 2)
    name = unused(MOTOR_PLATE, stack.plates)
    return Part(
        name,
        outline,
        ground.seat.holes,
        stock.thickness,
        body=ground.body,
        count=stack.motor_plates,
        fits=ground.seat.fits,
        material=stock.material,
    )


def _fits(meetings: Meetings, carried: Carried) -> bool:
    """Whether the openings of ground and bridge do not overlap."""
    plates = split(meetings.assembly, meetings.ground, carried)
    return not any(True for plate in plates for _ in plate.crossings(meetings.stock))


def _order(meetings: Meetings, carried: Carried, clean: bool = True) -> Order | None:
    """The best order of the moving plates if the bridge carries the joints `carried`."""
    ground, pins = meetings.ground, meetings.assembly.pins
    layered = meetings.layered
    meets = [0] * len({*layered.values()})
    for pair in meetings.plates:
        for one, other in permutations(layered[name] for name in pair) if ground not in pair else ():
            meets[one] |= (1 << other) * (one != other)
    passing = [
        Passing(
            joins=_bits(layered[name] for name in pin.plates if name != ground),
            bottom=ground in pin.plates and pin.joint not in carried,
            top=(ground in pin.plates and pin.joint in carried) or pin.name == meetings.assembly.open_pin,
            hits=_bits(k for name, k in layered.items() if (pin.name, name) in meetings.pin_and_plate),
        )
        for pin in pins
    ]
    if pack := _bits(layered[name] for name in meetings.assembly.pack):
        passing.append(Passing(pack, bottom=False, top=False, hits=_bits(layered.values()) & ~pack))
    return order(meets, passing, clean)


def _bits(numbers: Iterable[int]) -> int:
    return sum(1 << k for k in {*numbers})


def _stack(meetings: Meetings, carried_joints: Carried, best: Order) -> Stack:
    ground, stock = meetings.ground, meetings.stock
    top = 1 + len(best.layers)
    plates, layers = dict(meetings.assembly.plates), {ground: 0}
    for name, k in meetings.layered.items():
        layers[name] = next(1 + n for n, row in enumerate(best.layers) if row >> k & 1)
    bridge = unused("bridge", plates)
    on_bridge = {pin.name: pin.joint in carried_joints for pin in meetings.assembly.pins}
    pins = list(meetings.assembly.pins)
    if carried_joints:
        plates[ground], plates[bridge] = split(meetings.assembly, ground, carried_joints)
        layers[bridge] = top
        for k, place in enumerate(pile_places(meetings.motion, meetings.assembly, stock.bar_width, meetings.play)):
            name = unused(f"spacer_{k + 1}", opened(plates))
            plates[ground].openings[name] = plates[bridge].openings[name] = (place,)
            pins.append(Pin(name, name, ground, place, (ground, bridge), ()))
    spans = []
    for pin in pins:
        fixed = bridge if on_bridge.get(pin.name) else ground
        holes, slots = (tuple(fixed if n == ground else n for n in names) for names in (pin.holes, pin.slots))
        ends = [layers[name] for name in holes + slots]
        ends += [top - 1] if pin.name == meetings.assembly.open_pin else []
        spans.append(PinSpan(pin.name, min(ends), max(ends), 0.0, holes, slots))
    stack = Stack(layers, tuple(spans), (), plates, stock.fastener_used, motor_plates=stock.motor_plates)
    return _spread(meetings, stack, pins)


def _spread(meetings: Meetings, stack: Stack, pins: Sequence[Pin]) -> Stack:
    """The stack with empty layers where heads need them, and its collisions."""
    layered_pins = tuple(LayeredPin(pin, span.first, span.last) for pin, span in zip(pins, stack.pins))
    heads = Heads(meetings, layered_pins, stack.layers, stack.plates)
    gaps = heads.gaps()
    places = with_empty_layers(gaps)
    layers = {name: places[layer] for name, layer in stack.layers.items()}
    joints = {pin.name for pin in meetings.assembly.pins}
    spans: list[PinSpan] = []
    discs_in: dict[int, list[Pin]] = {}
    for pin, span in zip(pins, stack.pins):
        first, last = places[span.first], places[span.last]
        occupied = {layers[name] for name in span.holes + span.slots}
        # Under a crank on a motor's shaft is the hole for the motor's boss, so only the shaft holds it.
        discs = [] if pin.shaft else [n for n in range(first + 1, last) if n not in occupied]
        if span.name in joints:
            # A pile fills all layers between its plates; another pin those in which no plate meets the disc.
            empty, among_plates = [n for n in discs if n not in places], [n for n in discs if n in places]
            clear = (n for n in among_plates if heads.disc_clears(pin, places.index(n), discs_in.get(n, ()), gaps))
            discs = sorted([*empty, *clear])
        for n in discs:
            discs_in.setdefault(n, []).append(pin)
        length = (last - first + 1) * meetings.stock.thickness
        spans.append(replace(span, first=first, last=last, length=length, spacers=tuple(discs)))
    spans = [
        replace(span, motor=_motor_bill(meetings.stock, span.length, heads.is_open(layered)))
        if layered.pin.shaft
        else span
        for span, layered in zip(spans, layered_pins)
    ]
    spread = replace(stack, layers=layers, pins=tuple(spans))
    return replace(spread, collisions=tuple(_collisions(meetings, spread, heads.collisions(gaps))))


def _motor_bill(stock: LinkStock, length: float, is_open: bool) -> Bill:
    """The motor, with its shaft through plates of a total length, mm; cut to length if anything passes over it."""
    assert stock.shaft is not None
    packing = stock.motor_plates * stock.thickness
    glue = () if stock.shaft.is_pressed else glue_bill(1)
    return *shaft_bill(stock.shaft, length + packing, base=stock.thickness + packing, is_cut=not is_open), *glue


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
