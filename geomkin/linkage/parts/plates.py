"""The plates of a linkage with their holes and slots, and the guide pins of sliding plates."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from itertools import combinations
from typing import Any

import numpy as np

from ...core.errors import DesignError, shown
from ...core.records import record
from ...core.units import mm
from ...making.attachments import attached_holes
from ...making.motors import CORNER, face_of
from ...model.part import HoleFit, Part
from ...plane.curve import AbstractCurve
from ...plane.measure import separation
from ...plane.primitives import Circle, Polyline, convex_hull, rounded_hull, slot
from ...plane.vec import Complex, Mask, cross, spaced_directions
from ..checks import assembly_error
from ..dynamics.wrenches import known_place
from ..joints.joint import AbstractJoint
from ..joints.slide import Slider, are_equal
from ..linkage import Linkage
from ..motion import Motion
from .collisions import PointPaths, relative_paths
from .gears import MeshGear, trains
from .stock import LinkAttachment, LinkStock

# Smallest distance of the two guide pins in widths of the bar. With a smaller one the play of the pins in their slot
# lets the plate tilt and jam.
APART = 2.0
# Distance of the pin that fixes a gear from its pivot, in widths of the bar: their rings do not touch.
FIXED_AT = 1.1
# Directions of the corners by which an outline goes round a wide hole; each is rounded with half of the bar's width.
CIRCLE = spaced_directions(16)


Opening = Sequence[complex]
Slot = tuple[complex, complex]


def guide_places(
    width: float,
    travel: Slot,
    guide_direction: complex,
    point: complex,
    direction: complex,
    taken: Iterable[Opening],
    taken_on_guide: Iterable[Opening],
) -> tuple[tuple[complex, complex], tuple[Slot, Slot]] | None:
    """Positions of two guide pins on a sliding plate, and the ends of the slot of each on its guide.

    width: of the bars, mm, the least distance from all other openings. travel: first and last position of `point` of
    the plate on the guide. ahead, direction: of the slide, in the frames of guide and plate. taken, taken_on_guide:
    their openings, one point for a hole, two for a slot's ends. The pins are as near to the point as possible; slots
    that would leave less than a bar's width between them become one, which is returned twice. None if there is no room.
    """
    used, used_on_guide = [np.array(z) for z in taken], [np.array(z) for z in taken_on_guide]
    start, end = travel
    length = abs(end - start)
    # Range of the search: beyond all openings there is room.
    search_range = length + 2 * APART * width + max([0.0, *(float(np.abs(z - point).max()) for z in used)])
    search_range += max([0.0, *(float(np.abs(z - start).max()) for z in used_on_guide)])
    # A quarter of the width is fine enough; with more than 200 positions, pairs take seconds.
    step = max(width / 4, search_range / 100)
    grid = step * np.arange(-int(search_range / step), int(search_range / step) + 1)
    grid = grid[_clear((point + grid * direction)[:, None], used, width)]
    one, two = (grid[k] for k in np.triu_indices(len(grid), 1))
    allowed = two - one >= APART * width
    one, two = one[allowed], two[allowed]
    shared = two - one - length < width
    slots = (
        np.stack(
            [start + one * guide_direction, np.where(shared, end + two * guide_direction, end + one * guide_direction)],
            axis=1,
        ),
        np.stack(
            [
                np.where(shared, start + one * guide_direction, start + two * guide_direction),
                end + two * guide_direction,
            ],
            axis=1,
        ),
    )
    free = np.flatnonzero(_clear(slots[0], used_on_guide, width) & _clear(slots[1], used_on_guide, width))
    if not len(free):
        return None
    one, two = one[free], two[free]
    best = np.lexsort((one, np.abs(one + two), two - one, np.maximum(np.abs(one), np.abs(two))))[0]
    (a, b), (c, d) = (slot[free[best]].tolist() for slot in slots)
    return (complex(point + one[best] * direction), complex(point + two[best] * direction)), ((a, b), (c, d))


def _clear(places: Complex, taken: Sequence[Complex], width: float) -> Mask:
    """Whether openings (n, 1 or 2) keep their distance from all others."""
    clear = np.ones(len(places), dtype=bool)
    # Rounding must not decide if the distance is exactly the width.
    width = width * (1 - 1e-9)
    for opening in taken:
        clear &= separation(places, np.broadcast_to(opening, (len(places), len(opening)))) >= width
    return clear


@record(eq=False)
class Seat:
    """The holes of a motor in a plate, in the frame of the plate's body.

    pin: the joint of its shaft. holes: cut there instead of a pin's; fits: of each. corners: keep other openings away,
    complex mm, with `radius`, mm, around them. rim: points that the plate's outline must enclose, complex mm. marks:
    engraved rings.
    """

    pin: str
    holes: tuple[AbstractCurve, ...]
    fits: tuple[HoleFit, ...]
    corners: Complex
    radius: float
    rim: Complex = field(default_factory=lambda: np.zeros(0, dtype=complex))
    marks: tuple[Circle, ...] = ()


def seats(linkage: Linkage, axes: Mapping[str, Mapping[str, complex]], stock: LinkStock) -> dict[str, Seat]:
    """Seats of the stock's motor by the bodies that its shaft passes through; empty without a motor.

    axes: positions of the pins, mm, by pin and body. The crank has a bore for the shaft, its flat towards the crank's
    next point; the ground has the motor's holes. DesignError if no crank on the ground drives, or another body is on
    its joint. Derived here.
    """
    shaft, pivot = stock.shaft, linkage.driver_pivot
    if shaft is None or stock.motor is None:
        return {}
    if pivot is None:
        problem = f"found {stock.motor}, but {linkage.driver}, which drives, turns on no pin of the {linkage.ground}"
        raise DesignError("stock.motor", problem, "drive a crank on the ground, or omit the motor", "conflict")
    crank, ground = linkage.driver, linkage.ground
    on_crank = linkage.bodies[crank]
    # Coincident points have one joint, at the position of the first.
    fixed = {name: abs(on[crank] - complex(on_crank[pivot])) for name, on in axes.items() if {crank, ground} <= set(on)}
    name = min(fixed, key=fixed.__getitem__)
    seats_by_body = {}
    for body, place in axes[name].items():
        if body == ground:
            face = face_of(stock.motor)
            # Nuts under the ground must clear the motor; rods are cut flush.
            beside = max(stock.fastener_used.across, stock.hole_diameter) - stock.hole_diameter
            rim = face.corners(place, min(CORNER, stock.bar_width / 2))
            holes, fits = face.holes(stock.clearance, place), face.fits(stock.clearance)
            rings = face.countersinks(place)
            seats_by_body[body] = Seat(name, holes, fits, face.corners(place), beside / 2, rim, rings)
        elif body == crank:
            away = next((complex(z) - place for z in on_crank.values() if complex(z) != place), 1 + 0j)
            bores = tuple(_moved(hole, place) for hole in shaft.hole(away / abs(away), stock.bar_width, "stock"))
            seats_by_body[body] = Seat(name, bores, shaft.fits, np.array([place]), (shaft.bore + shaft.play) / 2)
        else:
            problem = f"found {stock.motor}, on whose shaft the {body} would turn as well"
            raise DesignError("stock.motor", problem, "give it a separate pin, or omit motor", "conflict")
    return seats_by_body


def _moved(hole: Circle | Polyline, place: complex) -> AbstractCurve:
    return Circle(place, hole.radius) if isinstance(hole, Circle) else Polyline(hole.vertices + place, hole.bulges)


@record(eq=False)
class LinkPlate:
    """A plate in the frame of a body.

    openings: by pin or point, one point, mm, for a hole, two for a slot's ends. seat: a motor's holes in it. rim:
    points of a counterweight that the outline encloses, complex mm. attached: what is screwed to it, with its middle.
    attached_rim: points that the outline encloses round the holes of these. disc: that it is, if it is of a flywheel.
    wheel: the gear that it is.
    """

    body: str
    openings: dict[str, tuple[complex, ...]] = field(default_factory=dict)
    seat: Seat | None = None
    rim: Complex = field(default_factory=lambda: np.zeros(0, dtype=complex))
    attached: tuple[tuple[LinkAttachment, complex], ...] = ()
    attached_rim: Complex = field(default_factory=lambda: np.zeros(0, dtype=complex))
    disc: Circle | None = None
    wheel: MeshGear | None = None

    @property
    def centres(self) -> Complex:
        """Points that the outline encloses at a constant distance, complex mm."""
        places = [place for places in self.openings.values() for place in places]
        return np.array([*places, *(self.seat.rim if self.seat else ()), *self.attached_rim, *self.rim])

    @property
    def section_points(self) -> Complex:
        """Points between which the plate is loaded, complex mm: the same, with the middle of a counterweight."""
        holes = self.centres[: len(self.centres) - len(self.rim)]
        return np.unique(np.append(holes, self.rim.mean()) if self.rim.size and not self.disc else holes)

    def hull(self, width: float) -> Complex:
        """Convex hull, counterclockwise, from which the plate extends by half the width of a bar, mm."""
        centres = self.centres if self.wheel is None else self.wheel.corners(width / 2)
        return np.array(convex_hull(centres))

    def outline(self, half: float) -> AbstractCurve:
        """The outline: of a gear or disc, or at half of a bar's width, mm, round all centres."""
        if self.wheel:
            return self.wheel.outline
        holes = [place for places in self.openings.values() for place in places]
        disc = self.disc
        if disc and all(abs(place - disc.centre) + half <= disc.radius for place in holes):
            return disc
        return rounded_hull(self.centres, half)

    @property
    def taken(self) -> list[list[complex]]:
        """Points that other openings must stay away from, mm."""
        return [self._corners(name).tolist() for name in self.openings]

    def _corners(self, name: str) -> Complex:
        return self.seat.corners if self.seat and name == self.seat.pin else np.array(self.openings[name])

    def edges(self, stock: LinkStock) -> list[tuple[str, Complex, float]]:
        """Each opening: its name, the points whose convex hull it surrounds, complex mm, and at which distance, mm.

        For a motor's face its edge counts.
        """
        radii = dict.fromkeys(self.openings, stock.hole_diameter / 2)
        if self.seat and self.seat.pin in radii:
            radii[self.seat.pin] = self.seat.radius
        loops = [(name, self._corners(name), radius) for name, radius in radii.items()]
        for attachment, middle in self.attached:
            holes = attached_holes([(attachment, middle)], stock.clearance)
            loops += [(attachment.name, np.array([hole.centre]), hole.radius) for hole in holes]
        return loops

    def crossings(self, stock: LinkStock) -> Iterator[tuple[str, str, float, float]]:
        """Pairs of openings that overlap: their names, the distance of their centres, and the required one, mm."""
        for (one, corners, radius), (two, others, other_radius) in combinations(self.edges(stock), 2):
            apart, needed = max(0.0, float(separation(corners, others))), radius + other_radius
            # Two guide pins may share one slot. Holes of one attachment were compared before.
            is_shared = len(corners) == 2 and self.openings.get(one) == self.openings.get(two)
            if apart <= needed and not is_shared and one != two:
                yield one, two, apart, needed

    def part(self, name: str, stock: LinkStock, linkage: Linkage, letters: Mapping[str, str]) -> Part:
        """The plate as a Part; DesignError if openings overlap, named after a traced point if that is the cause.

        letters: engraved at the holes of pins, by the pins' names.
        """
        for one, two, apart, needed in self.crossings(stock):
            traced = [p for p in (two, one) if p in linkage.bodies[self.body] and p not in linkage.joint_points]
            kinds = [f"{'slot' if len(self.openings.get(p, '')) == 2 else 'hole'} of {p}" for p in (one, two)]
            if self.seat and self.seat.rim.size and self.seat.pin in (one, two):
                raise DesignError(
                    "stock.motor",
                    f"the {kinds[self.seat.pin == one]} in the {name} is {mm(apart):.4g} from the face of the motor, "
                    f"and its pin needs {mm(needed):.4g}",
                    'move them apart, give a smaller pin_diameter or fastener = "rod", or omit motor',
                )
            raise DesignError(
                traced[0] if traced else self.body,
                f"the {kinds[0]} and the {kinds[1]} in the {name} are {mm(apart):.4g} apart, "
                f"and they meet below {mm(needed):g}",
                "change the sizes that bring them together, or give a smaller pin_diameter",
            )
        radius = stock.hole_diameter / 2
        # Two guide pins may share one slot.
        shared: dict[tuple[complex, ...], str] = {}
        for pin, ends in self.openings.items():
            shared[ends] = shared.get(ends, "") + letters.get(pin, "")
        holes: list[AbstractCurve] = []
        hole_letters: list[str] = []
        fits: list[HoleFit] = []
        for ends, letter in shared.items():
            if self.seat and ends == self.openings.get(self.seat.pin):
                # Of a motor's holes the one for its shaft has the letter.
                holes += self.seat.holes
                hole_letters += [letter, *("" for _ in self.seat.holes[1:])]
                fits += self.seat.fits
            else:
                holes.append(Circle(ends[0], radius) if len(ends) == 1 else slot(ends[0], ends[1], radius))
                hole_letters.append(letter)
                travel = abs(ends[-1] - ends[0])
                fits.append(HoleFit(stock.pin_diameter, stock.pin_clearance, travel=travel, iso_fit=stock.pin_fit))
        holes += attached_holes(self.attached, stock.clearance)
        fits += (fit for item, middle in self.attached for _, fit in item.openings(middle, stock.clearance))
        hole_letters += [""] * (len(holes) - len(hole_letters))
        hole_names = tuple(hole_letters) if any(hole_letters) else ()
        return Part(
            name,
            self.outline(stock.bar_width / 2),
            tuple(holes),
            stock.thickness,
            marks=self.seat.marks if self.seat else (),
            body=self.body,
            hole_names=hole_names,
            fits=tuple(fits),
            material=stock.material,
        )


@record(eq=False)
class Pin:
    """A pin that moves with the point `place`, mm, of a body. holes: plates it turns in; slots: plates it runs in.

    joint: the pin's own name, or that of the sliding joint that it guides together with another. shaft: diameter, mm,
    if it is a motor's shaft, otherwise 0.
    """

    name: str
    joint: str
    body: str
    place: complex
    holes: tuple[str, ...]
    slots: tuple[str, ...]
    shaft: float = 0.0

    @property
    def plates(self) -> tuple[str, ...]:
        """All plates that it joins."""
        return self.holes + self.slots


@record(eq=False)
class LinkAssembly:
    """Plates by name, in the order of the linkage's bodies, and the pins that join them.

    gears: trains that share a layer. pack: plates that lie on one another, without others between them. open_pin: a pin
    that goes up to the uppermost layer, "" for none.
    """

    plates: Mapping[str, LinkPlate]
    pins: tuple[Pin, ...]
    gears: tuple[tuple[str, ...], ...] = ()
    pack: tuple[str, ...] = ()
    open_pin: str = ""


def assemble(motion: Motion, stock: LinkStock) -> LinkAssembly:
    """The plates and pins of a linkage that moves as in `motion`.

    Each body is a plate with a hole for each of its points. A block, which is a sliding body with one pin on the slide
    line and nothing else, is not a plate but that pin, in a slot of the body on which it slides. Any other sliding body
    is kept from turning by two guide pins in slots of its guide, and so is a body that slides on a hub: a body on a
    fixed shaft that only the slide turns. Slots are as long as the travel over the motion's frames. A body with a gear
    is that gear if its holes have room in it; otherwise two pins fix the gear on it. DesignError if no
    frame is closed, guide pins have no room, the stock's motor has no crank to turn, or the motion is of arrays of
    linkages.
    """
    if motion.linkage.is_batch:
        raise DesignError(
            "motion", "found arrays of linkages", "give one linkage, since the plates of each differ", "wrong-type"
        )
    if not motion.assembled.any():
        raise assembly_error(motion)
    linkage = motion.linkage
    running = {slide.name: pair for slide in linkage.slides if (pair := slide.runs_in(linkage))}
    blocks = {running[slider.name][0] for slider in linkage.sliders if slider.name in running}
    axes = _axes(linkage)
    motor_seats = seats(linkage, axes, stock)
    plates = {body: LinkPlate(body, {}, motor_seats.get(body)) for body in linkage.bodies if body not in blocks}
    for body, plate in plates.items():
        plates[body] = replace(plate, **_attached(linkage, stock, body))
    _check_bodies_of_attachments(stock, plates)
    instead = {(item.body, item.at) for item in stock.attachments if item.at not in linkage.joint_points}
    for name, places in axes.items():
        for body, place in places.items():
            if body in plates and (body, name) not in instead:
                plates[body].openings[name] = (place,)
    guides: dict[str, list[str]] = {name: [] for name in axes}
    for slide in linkage.slides:
        if slide.name in running:
            body, place, guide = running[slide.name]
            name = next(n for n, places in axes.items() if body in places and are_equal(places[body], place))
            path = relative_paths(motion, guide, body, place)
            plates[guide].openings[name] = _travel(path, slide.line_on(guide))
            guides[name].append(guide)
    pins = []
    for name, places in axes.items():
        holes = tuple(body for body in places if body in plates)
        if len(holes) + len(guides[name]) > 1:
            body = next(iter(holes or places))
            on_shaft = any(seat.pin == name for seat in motor_seats.values())
            shaft = stock.shaft.bore if stock.shaft and on_shaft else 0.0
            pins.append(Pin(name, name, body, places[body], holes, tuple(guides[name]), shaft))
    for slider in linkage.sliders:
        if slider.name not in running:
            pins += _guide_pins(motion, slider, plates, stock)
    gears = [[_geared(b, w, plates, pins, stock) for b, w in train.items()] for train in trains(linkage, stock)]
    return LinkAssembly(plates, tuple(pins), tuple(map(tuple, gears)))


def _geared(body: str, wheel: MeshGear, plates: dict[str, LinkPlate], pins: list[Pin], stock: LinkStock) -> str:
    """Add the gear of a body to its plate, or as another plate with a pin; the name of the plate with the gear."""
    plate, hole = plates[body], stock.hole_diameter / 2
    away = plate.centres - wheel.pivot
    if np.abs(away).max() + hole <= wheel.room:
        plates[body] = replace(plate, wheel=wheel)
        return body
    # The second pin is where the nearest hole other than the pivot's is farthest; of equal places, opposite to a hole.
    farthest = complex(away[np.argmax(np.abs(away))]) or 1 + 0j
    places = wheel.pivot - FIXED_AT * stock.bar_width * farthest / abs(farthest) * CIRCLE
    clear = np.full(len(places), np.inf)
    for _, corners, radius in plate.edges(stock):
        if not (len(corners) == 1 and are_equal(corners[0], wheel.pivot)):
            clear = np.minimum(clear, separation(places[:, None], corners[None].repeat(len(places), 0)) - radius)
    place = complex(places[np.argmax(clear)])
    if abs(place - wheel.pivot) + hole > wheel.room or clear.max() <= hole:
        problem = f"the gear of {body} with {wheel.gear.teeth} teeth has no room for the pin that fixes it"
        raise DesignError("meshes", problem, "give it more teeth, narrower bars, or put the pivots farther apart")
    name = unused(f"{body}_gear", plates)
    fixing = unused(f"{name}_pin", opened(plates))
    own = (k for k, pin in enumerate(pins) if body in pin.holes)
    at = next(k for k in own if are_equal(plate.openings[pins[k].name][0], wheel.pivot))
    pivot, plate.openings[fixing] = pins[at].name, (place,)
    seat = plate.seat if plate.seat and plate.seat.pin == pivot else None
    plates[name] = LinkPlate(body, {pivot: (wheel.pivot,), fixing: (place,)}, seat, wheel=wheel)
    pins[at] = replace(pins[at], holes=(*pins[at].holes, name))
    pins.append(Pin(fixing, fixing, body, place, (body, name), ()))
    return name


def _attached(linkage: Linkage, stock: LinkStock, body: str) -> dict[str, Any]:
    """Fields of a plate for what is screwed to it. A hole wider than a pin's has as much material round it."""
    attached, rim = [], list[complex]()
    for k, item in enumerate(stock.attachments):
        if item.body == body:
            try:
                middle = complex(np.asarray(known_place(linkage, body, item.at, "")))
            except DesignError as error:
                raise error.named(f"stock.attachments[{k}].at") from None
            attached.append((item, middle))
    for hole in attached_holes(attached, stock.clearance):
        wider = max(0.0, hole.radius - stock.hole_diameter / 2)
        rim += [hole.centre + wider * z for z in (CIRCLE if wider else CIRCLE[:1])]
    return {"attached": tuple(attached), "attached_rim": np.array(rim, dtype=complex)}


def _check_bodies_of_attachments(stock: LinkStock, plates: Mapping[str, LinkPlate]) -> None:
    for k, item in enumerate(stock.attachments):
        if item.body not in plates:
            problem = f"found {shown(item.body)}, which is no plate"
            remedy = f"give one of {', '.join(plates)}"
            raise DesignError(f"stock.attachments[{k}].body", problem, remedy, "unknown-key")


def _axes(linkage: Linkage) -> dict[str, dict[str, complex]]:
    """Positions of pins or points by body; coincident points of a body are one."""
    axes: dict[str, dict[str, complex]] = {}
    names = dict.fromkeys([*linkage.pins, *(point for points in linkage.bodies.values() for point in points)])
    for name in names:
        positions = {body: complex(points[name]) for body, points in linkage.bodies.items() if name in points}
        same = [
            other
            for other, places in axes.items()
            if any(body in places and are_equal(places[body], place) for body, place in positions.items())
        ]
        # The first keeps its name and its position in the order.
        for other in same[:0:-1]:
            positions = axes.pop(other) | positions
        axes[same[0] if same else name] = (axes[same[0]] if same else {}) | positions
    return axes


def pins_on_axes(linkage: Linkage) -> dict[str, list[AbstractJoint]]:
    """By the name of an axis, the joints whose pins lie on it: joints of coincident points share a screw."""

    def lies_on(joint: AbstractJoint, places: Mapping[str, complex]) -> bool:
        ends = ((body, point) for point, bodies in joint.points.items() for body in bodies[:1])
        return any(b in places and are_equal(places[b], complex(linkage.bodies[b][point])) for b, point in ends)

    axes = _axes(linkage)
    return {axis: [joint for joint in linkage.joints if lies_on(joint, places)] for axis, places in axes.items()}


def _travel(path: PointPaths, direction: complex) -> tuple[complex, complex]:
    """Ends of a straight path along a direction."""
    front, back = path.extent(direction), -path.extent(-direction)
    start = complex(path.points[path.frames[0], 0])
    level = 1j * float(cross(direction, start))
    return (back + level) * direction, (front + level) * direction


def opened(plates: Mapping[str, LinkPlate]) -> set[str]:
    """Names of all openings of the plates."""
    return {name for plate in plates.values() for name in plate.openings}


def unused(name: str, taken: Container[str]) -> str:
    """A name, extended by underscores if it is taken."""
    while name in taken:
        name += "_"
    return name


def _guide_pins(motion: Motion, slider: Slider, plates: Mapping[str, LinkPlate], stock: LinkStock) -> list[Pin]:
    """The two guide pins of a sliding plate; their holes and slots are added to the plates."""
    plate, guide = plates[slider.body], plates[slider.along]
    path = relative_paths(motion, slider.along, slider.body, slider.point)
    guide_direction, direction = slider.line_on(slider.along), slider.line_on(slider.body)
    guide_pins = guide_places(
        stock.bar_width,
        _travel(path, guide_direction),
        guide_direction,
        complex(slider.point),
        direction,
        plate.taken,
        guide.taken,
    )
    if guide_pins is None:
        problem = f"the {slider.along} has no room on the slide line for the guide pins of the {slider.body}"
        raise DesignError("bar_width", problem, "give narrower bars, or move the pins that lie on the line")
    pins = []
    for number, place, ends in zip((1, 2), *guide_pins):
        name = unused(f"{slider.name}_guide_{number}", opened(plates))
        plate.openings[name], guide.openings[name] = (place,), ends
        pins.append(Pin(name, slider.name, slider.body, place, (slider.body,), (slider.along,)))
    return pins
