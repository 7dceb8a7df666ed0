"""Where two guide pins keep a sliding plate from turning."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from itertools import combinations

import numpy as np

from ...core.errors import DesignError
from ...core.records import record
from ...making.motors import CORNER, MOTORS
from ...model.part import HoleFit, Part
from ...plane.curve import AbstractCurve
from ...plane.measure import separation
from ...plane.primitives import Circle, Polyline, convex_hull, rounded_hull, slot
from ...plane.vec import Complex, Mask, cross, direction_deg
from ..linkage import Linkage, Slider
from ..measures import assembly_error
from ..motion import Motion
from .collisions import Sweep, path_in
from .stock import LinkStock

# Least distance of the two guide pins in widths of the bar. Nearer, the play of the pins in their slot lets the
# plate cock and jam; farther makes plate and slot longer for nothing.
APART = 2.0


AssemblyFailure = Sequence[complex]
Slot = tuple[complex, complex]


def guide_places(
    width: float,
    travel: Slot,
    ahead: complex,
    point: complex,
    direction: complex,
    taken: Iterable[AssemblyFailure],
    taken_on_guide: Iterable[AssemblyFailure],
) -> tuple[tuple[complex, complex], tuple[Slot, Slot]] | None:
    """Places of two guide pins on a sliding plate, and the ends of the slot of each on its guide.

    width: of the bars, mm, the least distance kept from all other openings. travel: from where to where `point`
    of the plate slides on the guide. ahead, direction: of the slide, in the frames of guide and plate. taken,
    taken_on_guide: their openings, one place for a hole, two for a slot's ends. The pins come as near to the
    point as they can; slots that would leave less than a bar's width between them are one, and come twice. None
    where there is no room.
    """
    used, used_on_guide = [np.array(z) for z in taken], [np.array(z) for z in taken_on_guide]
    start, end = travel
    length = abs(end - start)
    # How far to look: beyond all openings there is room.
    far = length + 2 * APART * width + max([0.0, *(float(np.abs(z - point).max()) for z in used)])
    far += max([0.0, *(float(np.abs(z - start).max()) for z in used_on_guide)])
    # A quarter of the width finds a place near enough to the best; with more than 200 places, pairs take seconds.
    step = max(width / 4, far / 100)
    grid = step * np.arange(-int(far / step), int(far / step) + 1)
    grid = grid[_clear((point + grid * direction)[:, None], used, width)]
    one, two = (grid[k] for k in np.triu_indices(len(grid), 1))
    wide = two - one >= APART * width
    one, two = one[wide], two[wide]
    shared = two - one - length < width
    slots = (
        np.stack([start + one * ahead, np.where(shared, end + two * ahead, end + one * ahead)], axis=1),
        np.stack([np.where(shared, start + one * ahead, start + two * ahead), end + two * ahead], axis=1),
    )
    free = np.flatnonzero(_clear(slots[0], used_on_guide, width) & _clear(slots[1], used_on_guide, width))
    if not len(free):
        return None
    one, two = one[free], two[free]
    best = np.lexsort((one, np.abs(one + two), two - one, np.maximum(np.abs(one), np.abs(two))))[0]
    (a, b), (c, d) = (slot[free[best]].tolist() for slot in slots)
    return (complex(point + one[best] * direction), complex(point + two[best] * direction)), ((a, b), (c, d))


def _clear(places: Complex, taken: Sequence[Complex], width: float) -> Mask:
    """Whether openings (n, 1 or 2) keep their distance from all that are taken."""
    clear = np.ones(len(places), dtype=bool)
    # Rounding must not choose between places exactly at the distance.
    width = width * (1 - 1e-9)
    for opening in taken:
        clear &= separation(places, np.broadcast_to(opening, (len(places), len(opening)))) >= width
    return clear


@record(eq=False)
class Seat:
    """What a motor has of a plate, in the frame of the plate's body.

    pin: the joint of its shaft. holes: cut there instead of a pin's; fits: of each. corners: what keeps other openings
    off, complex mm, with `radius`, mm, round them. rim: where the plate's edge goes round, complex mm.
    """

    pin: str
    holes: tuple[AbstractCurve, ...]
    fits: tuple[HoleFit, ...]
    corners: Complex
    radius: float
    rim: Complex = field(default_factory=lambda: np.zeros(0, dtype=complex))


def seats(linkage: Linkage, axes: Mapping[str, Mapping[str, complex]], stock: LinkStock) -> dict[str, Seat]:
    """Seats of the stock's motor by the bodies that its shaft goes through; none without a motor.

    axes: places of the pins, mm, by pin and body. The crank has a bore for the shaft, its flat towards the crank's next
    point; the ground has the motor's holes. Raises DesignError where no crank on the ground drives, and where another
    body is on its joint. Derived here.
    """
    shaft, pivot = stock.shaft, linkage.driver_pivot
    if shaft is None or stock.motor is None:
        return {}
    if pivot is None:
        raise DesignError(
            "stock.motor",
            f"found {stock.motor}, but {linkage.driver}, which drives, turns on no pin of the {linkage.ground}",
            "let a crank on the ground drive, or leave it out",
        )
    crank, ground = linkage.driver, linkage.ground
    on_crank = linkage.bodies[crank]
    # Points that fall together have one joint, at the place of the first.
    fixed = {name: abs(on[crank] - complex(on_crank[pivot])) for name, on in axes.items() if {crank, ground} <= set(on)}
    name = min(fixed, key=fixed.__getitem__)
    found = {}
    for body, place in axes[name].items():
        if body == ground:
            face = MOTORS[stock.motor]
            # Nuts under the ground must clear the motor; rods are cut flush.
            beside = max(stock.fastener_used.across, stock.hole_diameter) - stock.hole_diameter
            rim = face.corners(place, min(CORNER, stock.bar_width / 2))
            holes, fits = face.holes(stock.clearance, place), face.fits(stock.clearance)
            found[body] = Seat(name, holes, fits, face.corners(place), beside / 2, rim)
        elif body == crank:
            away = next((complex(z) - place for z in on_crank.values() if complex(z) != place), 1 + 0j)
            bores = tuple(_moved(hole, place) for hole in shaft.hole(away / abs(away), stock.bar_width, "stock"))
            found[body] = Seat(name, bores, shaft.fits, np.array([place]), (shaft.bore + shaft.play) / 2)
        else:
            raise DesignError(
                "stock.motor",
                f"found {stock.motor}, on whose shaft the {body} would turn, too",
                "give it a pin of its own, or leave out motor",
            )
    return found


def _moved(hole: Circle | Polyline, place: complex) -> AbstractCurve:
    return Circle(place, hole.radius) if isinstance(hole, Circle) else Polyline(hole.vertices + place, hole.bulges)


# Places that differ by no more than this share of their coordinates are one. Smaller takes rounding for a second hole
# beside the first; larger makes one hole of two that were meant to be apart.
EQUAL = 8 * np.finfo(float).eps


@record(eq=False)
class Plate:
    """A plate in the frame of a body.

    openings: by pin or point, one place, mm, for a hole, two for a slot's ends. seat: what a motor has of it.
    """

    body: str
    openings: dict[str, tuple[complex, ...]] = field(default_factory=dict)
    seat: Seat | None = None

    @property
    def centres(self) -> Complex:
        """What the plate is stretched round, complex mm."""
        places = [place for places in self.openings.values() for place in places]
        return np.array([*places, *(self.seat.rim if self.seat else ())])

    @property
    def hull(self) -> Complex:
        """Those between which its edges are stretched, counterclockwise."""
        return np.array(convex_hull(self.centres))

    @property
    def taken(self) -> list[list[complex]]:
        """Corners of what other openings keep off, mm."""
        return [self._corners(name).tolist() for name in self.openings]

    def _corners(self, name: str) -> Complex:
        return self.seat.corners if self.seat and name == self.seat.pin else np.array(self.openings[name])

    def crossings(self, stock: LinkStock) -> Iterator[tuple[str, str, float, float]]:
        """Pairs of openings that would run into each other, how far apart their middles are, and should be, mm.

        Of a motor's face it is its edge that counts.
        """
        for (one, a), (two, b) in combinations(self.openings.items(), 2):
            apart = max(0.0, float(separation(self._corners(one), self._corners(two))))
            needed = stock.hole_diameter
            if self.seat and self.seat.pin in (one, two):
                needed = stock.hole_diameter / 2 + self.seat.radius
            # Two guide pins may share one slot.
            if apart <= needed and not (a == b and len(a) == 2):
                yield one, two, apart, needed

    def part(self, name: str, stock: LinkStock, linkage: Linkage, letters: Mapping[str, str]) -> Part:
        """What is cut; DesignError, under a traced point's name if one is the cause, where openings meet.

        letters: engraved at the holes of pins, by the pins' names.
        """
        for one, two, apart, needed in self.crossings(stock):
            traced = [p for p in (two, one) if p in linkage.bodies[self.body] and p not in linkage.pins]
            kinds = [f"{'hole' if len(self.openings[p]) == 1 else 'slot'} of {p}" for p in (one, two)]
            if self.seat and self.seat.rim.size and self.seat.pin in (one, two):
                raise DesignError(
                    "stock.motor",
                    f"the {kinds[self.seat.pin == one]} in the {name} is {apart:.4g} mm from the face of the motor, "
                    f"and what goes through it needs {needed:.4g} mm",
                    'move them apart, give a smaller pin_diameter or fastener = "rod", or leave out motor',
                )
            raise DesignError(
                traced[0] if traced else self.body,
                f"the {kinds[0]} and the {kinds[1]} in the {name} are {apart:.4g} mm apart, "
                f"and they are {needed:g} mm wide",
                "change the sizes that bring them together, or give a smaller pin_diameter",
            )
        radius = stock.hole_diameter / 2
        # Two guide pins may share one slot.
        shared: dict[tuple[complex, ...], str] = {}
        for pin, ends in self.openings.items():
            shared[ends] = shared.get(ends, "") + letters.get(pin, "")
        holes: list[AbstractCurve] = []
        named: list[str] = []
        fits: list[HoleFit] = []
        for ends, letter in shared.items():
            if self.seat and ends == self.openings.get(self.seat.pin):
                # Of a motor's holes the one round its shaft has the letter.
                holes += self.seat.holes
                named += [letter, *("" for _ in self.seat.holes[1:])]
                fits += self.seat.fits
            else:
                holes.append(Circle(ends[0], radius) if len(ends) == 1 else slot(ends[0], ends[1], radius))
                named.append(letter)
                fits.append(HoleFit(stock.pin_diameter, stock.clearance, travel=abs(ends[-1] - ends[0])))
        outline, told = rounded_hull(self.centres, stock.bar_width / 2), tuple(named) if any(named) else ()
        return Part(name, outline, tuple(holes), stock.thickness, body=self.body, hole_names=told, fits=tuple(fits))


@record(eq=False)
class Pin:
    """A pin that moves as the point `place`, mm, of a body. holes: plates it turns in; slots: plates it runs in.

    joint: the pin's own name, or that of the sliding joint that it guides together with another. shaft: diameter, mm,
    of the motor's shaft that it is, 0 for a pin.
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
class Assembly:
    """Plates by name, in the order of the linkage's bodies, and the pins that join them."""

    plates: Mapping[str, Plate]
    pins: tuple[Pin, ...]


def assemble(motion: Motion, stock: LinkStock) -> Assembly:
    """The plates and pins of a linkage that moves as in `motion`.

    Each body is a plate with a hole for each of its points. A block, which is a sliding body with one pin on the
    slide line and nothing else, is no plate: it is that pin, in a slot of the body that it slides on. Any other
    sliding body is kept from turning by two guide pins in slots of its guide, and so is what slides on a hub: a
    body on a fixed shaft that nothing but the slide turns. Slots are as long as the travel over the motion's
    frames. Raises DesignError where no frame closes, where guide pins find no room, where the stock's motor has no
    crank to turn, and for many linkages at once.
    """
    if motion.linkage.is_batch:
        raise DesignError("motion", "found many linkages at once", "give one, for the plates of each differ")
    if not motion.assembled.any():
        raise assembly_error(motion)
    linkage = motion.linkage
    blocks = {slider.name: block for slider in linkage.sliders if (block := _block(linkage, slider))}
    axes = _axes(linkage)
    held = seats(linkage, axes, stock)
    plates = {body: Plate(body, {}, held.get(body)) for body in linkage.bodies if body not in blocks.values()}
    for name, places in axes.items():
        for body, place in places.items():
            if body in plates:
                plates[body].openings[name] = (place,)
    riding: dict[str, list[str]] = {name: [] for name in axes}
    for slider in linkage.sliders:
        if slider.name in blocks:
            block = blocks[slider.name]
            name = next(name for name, places in axes.items() if block in places)
            guide = slider.along if block == slider.body else slider.body
            path = path_in(motion, guide, block, axes[name][block])
            plates[guide].openings[name] = _travel(path, _line(slider, guide))
            riding[name].append(guide)
    pins = []
    for name, places in axes.items():
        holes = tuple(body for body in places if body in plates)
        if len(holes) + len(riding[name]) > 1:
            body = next(iter(holes or places))
            on_shaft = any(seat.pin == name for seat in held.values())
            shaft = stock.shaft.bore if stock.shaft and on_shaft else 0.0
            pins.append(Pin(name, name, body, places[body], holes, tuple(riding[name]), shaft))
    for slider in linkage.sliders:
        if slider.name not in blocks:
            pins += _guide_pins(motion, slider, plates, stock)
    return Assembly(plates, tuple(pins))


def _block(linkage: Linkage, slider: Slider) -> str | None:
    """The one of the two bodies that is no more than a pin; the one with fewer points where both could be."""
    sides = [body for body in (slider.body, slider.along) if _is_block(linkage, slider, body)]
    return min(sides, key=lambda body: len(linkage.bodies[body]), default=None)


def _is_block(linkage: Linkage, slider: Slider, body: str) -> bool:
    points, other = linkage.bodies[body], slider.along if body == slider.body else slider.body
    # What is driven by its angle, or is half of an actuator, needs a plate to be held by.
    driven = body == linkage.driver or slider is linkage.driven_slider
    if body == linkage.ground or (driven and other != linkage.ground):
        return False
    joined = {one for point in points for one in linkage.pins.get(point, ())} - {body}
    if not joined or sum(body in (s.body, s.along) for s in linkage.sliders) > 1:
        return False
    # A body on a fixed shaft that only its slide moves is a hub: it must be a plate to turn that shaft.
    if joined == {linkage.ground} and not any(point in linkage.pins for point in linkage.bodies[other]):
        return False
    first = complex(next(iter(points.values())))
    if not all(_equal(first, complex(place)) for place in points.values()):
        return False
    start = complex(slider.point if body == slider.body else slider.through)
    return bool(abs(cross(_line(slider, body), first - start)) <= EQUAL * (abs(first) + abs(start)))


def _equal(one: complex, two: complex) -> bool:
    return bool(abs(one - two) <= EQUAL * max(abs(one), abs(two)))


def _line(slider: Slider, body: str) -> complex:
    """Direction of a slide line in the frame of either of its bodies."""
    return complex(slider.direction if body == slider.along else direction_deg(-slider.angle_deg))


def _axes(linkage: Linkage) -> dict[str, dict[str, complex]]:
    """Places where pins or points are, each by body; points that fall together in a body are one."""
    axes: dict[str, dict[str, complex]] = {}
    names = dict.fromkeys([*linkage.pins, *(point for points in linkage.bodies.values() for point in points)])
    for name in names:
        own = {body: complex(points[name]) for body, points in linkage.bodies.items() if name in points}
        same = [
            other
            for other, places in axes.items()
            if any(body in places and _equal(places[body], place) for body, place in own.items())
        ]
        # The first keeps its name and its place in the order.
        for other in same[:0:-1]:
            own = axes.pop(other) | own
        axes[same[0] if same else name] = (axes[same[0]] if same else {}) | own
    return axes


def _travel(path: Sweep, direction: complex) -> tuple[complex, complex]:
    """Ends of a straight path along a direction."""
    ahead, behind = path.reach(direction), -path.reach(-direction)
    start = complex(path.points[path.frames[0], 0])
    level = 1j * float(cross(direction, start))
    return (behind + level) * direction, (ahead + level) * direction


def opened(plates: Mapping[str, Plate]) -> set[str]:
    """Names of all that goes through plates."""
    return {name for plate in plates.values() for name in plate.openings}


def unused(name: str, taken: Container[str]) -> str:
    """A name, made longer where a recipe has it already."""
    while name in taken:
        name += "_"
    return name


def _guide_pins(motion: Motion, slider: Slider, plates: Mapping[str, Plate], stock: LinkStock) -> list[Pin]:
    """The two guide pins of a sliding plate; their holes and slots are added to the plates."""
    plate, guide = plates[slider.body], plates[slider.along]
    path = path_in(motion, slider.along, slider.body, slider.point)
    ahead, direction = _line(slider, slider.along), _line(slider, slider.body)
    found = guide_places(
        stock.bar_width,
        _travel(path, ahead),
        ahead,
        complex(slider.point),
        direction,
        plate.taken,
        guide.taken,
    )
    if found is None:
        raise DesignError(
            "bar_width",
            f"the {slider.along} has no room on the slide line for the guide pins of the {slider.body}",
            "give narrower bars, or move the pins that lie on the line",
        )
    pins = []
    for number, place, ends in zip((1, 2), *found):
        name = unused(f"{slider.name}_guide_{number}", opened(plates))
        plate.openings[name], guide.openings[name] = (place,), ends
        pins.append(Pin(name, slider.name, slider.body, place, (slider.body,), (slider.along,)))
    return pins
