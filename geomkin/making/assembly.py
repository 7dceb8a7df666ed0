"""Assembly of gears and cams: the base plate with its screws and slots, shafts, keys and collars, and the steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from math import ceil

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, inside, quantity, to_digits
from ..core.records import record
from ..core.units import InText, mm
from ..model.check import Check
from ..model.material import Material
from ..model.part import Bought, HoleFit, Part
from ..model.scene import layer_name
from ..plane.curve import AbstractCurve
from ..plane.measure import separation
from ..plane.primitives import Circle, rounded_hull, slot
from ..plane.vec import Complex
from .bores import PARALLEL_KEYS, SMALLEST, AbstractBored, clearance, key_of, widened
from .fasteners import PLAY as SNAP_PLAY
from .fasteners import Fastener, PinPlace, SnapPin, ThreadDiameter, alike, gathered, screw_text, size_of, snap_checks
from .motors import MotorFace, MountedMotorKey, face_of, fixed_under


@record(checked=True)
class BaseStock:
    """The base plate under a mechanism. It is as thick as the first part and covers everything that moves over it."""

    screw: ThreadDiameter = quantity(
        'diameter of the screws in its corners, or their thread, as "#6-32"; 0 for none; their holes are wider by the '
        "clearance",
        "mm",
        default=4.0,
        at_least=0,
        at_most=100,
    )
    edge: float = quantity(
        "width of the plate outside the screws in its corners", "mm", default=6.0, at_least=0.01, at_most=FARTHEST
    )
    clearance: float = clearance(0.2)


@record
class RackBaseStock(BaseStock):
    """The base plate under a pinion and its rack. Two pins guide the rack in a slot of the plate."""

    guide_pin: float = quantity(
        "diameter of the two pins on which the rack slides in the base's slot", "mm", default=4.0, at_least=0.01
    )


@record
class BaseOpening:
    """A hole for a shaft, pin or screw, or a slot in which pins slide.

    Parameters
    ----------
    item : str
        The shaft, pin or screw, for messages.
    key : str
        Key of its diameter in the recipe.
    diameter : float
        mm.
    points : tuple of complex
        Centre of the hole, or both ends of the slot's centre line, mm.
    letter : str
        Letter engraved next to the opening.
    head : float
        Diameter of a collar or head below the plate, mm; 0 for none.
    motor : str or MotorFace, optional
        Motor that drives the shaft from below; the plate then has holes for its boss and screws.
    """

    item: str
    key: str
    diameter: float
    points: tuple[complex, ...]
    letter: str = ""
    head: float = 0.0
    motor: MountedMotorKey | None = None

    @property
    def face(self) -> Complex:
        """Corners of the motor's face, mm; none without a motor."""
        return face_of(self.motor).corners(self.points[0]) if self.motor else np.zeros(0, dtype=complex)

    def curves(self, clearance: float) -> tuple[AbstractCurve, ...]:
        """The hole or slot, wider than the item by the clearance. Raises DesignError if it is too narrow to cut."""
        if self.diameter < SMALLEST:
            problem = f"found {mm(self.diameter):g}, but the base has a hole for {self.item}"
            remedy = f"give at least {mm(SMALLEST):up6}, or omit base"
            raise DesignError(self.key, problem, remedy, "conflict", SMALLEST)
        if self.motor:
            return face_of(self.motor).holes(clearance, self.points[0])
        radius = widened(self.diameter, clearance) / 2
        start, end = self.points[0], self.points[-1]
        return (Circle(start, radius) if len(self.points) == 1 else slot(start, end, radius),)

    def fits(self, clearance: float) -> tuple[HoleFit, ...]:
        """The fit of each of the `curves`."""
        if self.motor:
            return face_of(self.motor).fits(clearance)
        return (HoleFit(self.diameter, clearance, travel=abs(self.points[-1] - self.points[0])),)

    def distance(self, other: BaseOpening) -> float:
        """Distance of the two centres or centre lines, mm; 0 or less if two slots cross."""
        return float(separation(np.array(self.points), np.array(other.points)))


def standing_plate(
    box: tuple[complex, complex],
    openings: Sequence[BaseOpening],
    stock: BaseStock,
    thickness: float,
    material: Material | None,
) -> Part:
    """The base plate, a part of the body "ground", with openings, and a screw outside each corner of a box.

    box: lower left and upper right corner, mm, of all openings and of everything that moves over the plate; it is
    extended by the face of a motor. Raises DesignError if openings meet or lie over the face of a motor.
    """
    for opening in openings:
        if opening.motor:
            face_of(opening.motor).check_plate(thickness, _motor_key(opening))
    points = np.concatenate([np.array(box), *(opening.face for opening in openings)])
    # Heads of screws are at most twice as wide as the screws (ISO 7045, 4762, 4017).
    beyond = stock.screw * (1 + 1j)
    low = complex(points.real.min(), points.imag.min()) - beyond
    high = complex(points.real.max(), points.imag.max()) + beyond
    corners = (low, complex(high.real, low.imag), high, complex(low.real, high.imag))
    screws = [BaseOpening("a screw", "base.screw", stock.screw, (corner,)) for corner in corners if stock.screw]
    all_openings = (*openings, *screws)
    cut = [opening.curves(stock.clearance) for opening in all_openings]
    for first, second in combinations(all_openings, 2):
        _check_apart(first, second, stock.clearance)
    outline = rounded_hull(corners, widened(stock.screw, stock.clearance) / 2 + stock.edge)
    # A motor has several holes; the letter is at the first one, for its boss.
    letters = [
        name for opening, curves in zip(all_openings, cut) for name in (opening.letter, *("" for _ in curves[1:]))
    ]
    holes = tuple(curve for curves in cut for curve in curves)
    fits = tuple(fit for opening in all_openings for fit in opening.fits(stock.clearance))
    hole_names = tuple(letters) if any(letters) else ()
    marks = tuple(
        ring for opening in openings if opening.motor for ring in face_of(opening.motor).countersinks(opening.points[0])
    )
    plate = Part("base", outline, holes, thickness, marks=marks, body="ground", hole_names=hole_names, fits=fits)
    return replace(plate, material=material)


def _motor_key(opening: BaseOpening) -> str:
    return f"{opening.key.rpartition('.')[0]}.motor"


def _check_apart(first: BaseOpening, second: BaseOpening, clearance: float) -> None:
    for motor_opening, other in ((first, second), (second, first)):
        if motor_opening.motor:
            _check_off_motor(motor_opening, other, clearance)
    apart, wide = first.distance(second), (first.diameter + second.diameter) / 2 + clearance
    if apart > wide:
        return
    small, large = sorted((first, second), key=lambda opening: opening.diameter)
    if (free := apart - (small.diameter + large.diameter) / 2) > 0:
        key, value, most = "base.clearance", clearance, free
    else:
        key, value, most = large.key, large.diameter, 2 * (apart - clearance) - small.diameter
    raise DesignError(
        key,
        f"found {mm(value):g}: the holes for {first.item} and {second.item} in the base are {mm(apart):.6g} apart "
        f"and together {mm(2 * wide):.6g} wide, so they meet",
        f"give less than {mm(to_digits(most, 12)):down}" if most > 0 else "move them apart",
        value=inside(most, 1) if most > 0 else None,
    )


def _check_off_motor(motor_opening: BaseOpening, other: BaseOpening, clearance: float) -> None:
    """DesignError for an opening over the face of a motor, where its item would meet the motor or the motor's holes."""
    assert motor_opening.motor is not None
    face = face_of(motor_opening.motor)
    overlap = max(widened(other.diameter, clearance), other.head) / 2 - float(
        separation(motor_opening.face, np.array(other.points))
    )
    if overlap > 0:
        raise DesignError(
            _motor_key(motor_opening),
            f"found {motor_opening.motor}, whose face, {mm(face.face_width):g} wide, overlaps the opening for "
            f"{other.item} in the base by {mm(overlap):.4g}",
            "move the axes apart, or omit motor or base",
        )


# The items of one joint: name and number of each.
Bill = tuple[tuple[str, int], ...]
# Limits of the width reserved for a shaft's collar along the shaft, mm. With smaller values a collar of DIN 705
# projects beyond its shaft or below the feet of a base; larger values only lengthen shafts.
COLLARS = 8.0, 20.0
# Least diameter reserved for a collar, mm: the collar for a pin of 3 mm has 7 mm; a smaller value lets it touch its
# neighbours.
NARROWEST = 8.0


def shaft_bill(
    stock: AbstractBored, length: float, count: int = 1, base: float = 0.0, keys: int = 1, is_cut: bool = False
) -> Bill:
    """The shaft of a part, and its key if the part has a keyway; empty if the part has neither bore nor motor.

    A motor includes its shaft and is fixed by screws, which are countersunk if it is under a base.

    length: total thickness of the plates on the shaft, mm. count: number of such shafts, each with its own motor.
    base: thickness of the base over the motor, mm, 0 for none. keys: number of keys on each shaft. is_cut: whether a
    motor's shaft is cut to the length.
    """
    across, (width, _) = stock.across_flat, stock.keyway
    form = (
        f"shaft {mm(stock.bore):g}" if across is None else f"D-shaft {mm(stock.bore):g}, {mm(across):g} across its flat"
    )
    if stock.bore_form == "double-D":
        form = f"shaft {mm(stock.bore):g} with two flats {mm(across):g} apart"
    elif across is not None and stock.bore_form != "D":
        form = f"{stock.bore_form} shaft, {mm(across):.4g} between flats, {mm(stock.bore):g} over its corners"
    # The shaft of a motor is as it is.
    if stock.iso_fit.count("/") and stock.motor is None:
        form += f" {stock.iso_fit.rpartition('/')[2]}"
    key = ((_key(stock.bore, width, stock.thickness), count * keys),) if width else ()
    if stock.motor is not None:
        motor = face_of(stock.motor)
        shaft_length = f"cut to {_rounded(length):g} from its face" if is_cut else _at_least(length)
        item = ", ".join([f"motor {motor.product}", *([form] if stock.bore else []), *([shaft_length] if base else [])])
        return (item, count), *motor.bill(base or stock.thickness, base > 0, count), *key
    return ((f"{form}, {_at_least(length)}", count), *key) if stock.bore else ()


def pin_bill(diameter: float, length: float, count: int = 1, item: str = "pin") -> Bill:
    """Round pins or plain shafts through plates of a total thickness, mm; empty for diameter 0."""
    return ((f"{item} {mm(diameter):g}, {_at_least(length)}", count),) if diameter else ()


def screw_bill(base: BaseStock, length: float, count: int = 4) -> Bill:
    """Screws of a base, by default one in each corner, through a total thickness, mm."""
    return ((f"{screw_text(base.screw)}, {_at_least(length)}", count),) if base.screw else ()


def collar_width(diameter: float) -> float:
    """Length reserved along a shaft or pin for its set collar, mm: the diameter in whole mm, within limits.

    Collars by DIN 705 A are no wider for shafts of 3 to 50 mm.
    """
    return float(min(max(ceil(diameter), COLLARS[0]), COLLARS[1]))


def collar_across(diameter: float) -> float:
    """Diameter reserved for the set collar of a shaft or pin, mm. DIN 705 A is no wider for 3 to 50 mm."""
    return max(2 * diameter, NARROWEST)


def collar_bill(diameter: float, count: int = 1) -> Bill:
    """Set collars, which are clamped on a shaft or pin by their own screws."""
    return ((f"shaft collar DIN 705 A, {mm(diameter):g}", count),)


def tube_bill(diameter: float, height: float, count: int = 1) -> Bill:
    """Pieces of tube that keep plates on a shaft or screw apart; cut, printed or made of washers."""
    return ((f"tube {mm(diameter):g} inside, cut to {_rounded(height):g}", count),)


def glue_bill(joints: int) -> Bill:
    """Glue for a number of joints."""
    return (("epoxy glue for a joint", joints),)


def _at_least(length: float) -> str:
    # The length beyond the plates depends on the support.
    return f"at least {_rounded(length):up6} long"


def _rounded(length: float) -> InText:
    return mm(to_digits(length, 10))


def _key(shaft: float, width: float, room: float) -> str:
    """The key for a keyway in a part of a thickness `room`, mm: the shaft's standard key, or another of that width."""
    keys = [key for key in (key_of(shaft), *PARALLEL_KEYS) if key and key.width == width]
    return keys[0].bill(room) if keys else f"key {mm(width):g} wide, cut to {mm(room):g}"


# Clearance between rotating parts under a base and the surface below, mm.
FREE = 2.0
# Axial play of a wheel between two collars or discs, mm. With less it jams if the sheet is thicker than nominal; with
# more the wheels tilt.
PLAY = 0.5


@record
class Assembly:
    """Assembly of a mechanism.

    Parameters
    ----------
    bought : tuple of Bought
        Items to buy or to cut besides the parts.
    steps : tuple of str
        Instructions, one line for each layer from bottom to top.
    shaft_items : tuple of Bought, optional
        Shafts without motors, and their collars, which are in `bought` too; each for one joint only.
    snap_pins : tuple of PinPlace, optional
        Printed pins in place of shafts.
    """

    bought: tuple[Bought, ...]
    steps: tuple[str, ...]
    shaft_items: tuple[Bought, ...] = ()
    snap_pins: tuple[PinPlace, ...] = ()

    @property
    def snap_checks(self) -> tuple[Check, ...]:
        """Checks of the printed pins."""
        return snap_checks(self.snap_pins)


class AssemblyBuilder:
    """Collects the items and steps of an assembly.

    Parameters
    ----------
    plate : str
        Name of the plate in which the shafts run; "" for none.
    thickness : float
        Thickness of that plate, mm.
    base : BaseStock, optional
        Screws of the base.
    lettered : bool
        Whether letters are engraved at the holes.
    motor : str or MotorFace, optional
        Motor of the lowest wheel. It is under the base or, without a base, on its own plate under all others.
    snaps : bool
        Whether printed pins take the place of shafts and collars.
    """

    def __init__(
        self,
        plate: str = "",
        thickness: float = 0.0,
        base: BaseStock | None = None,
        lettered: bool = False,
        motor: MountedMotorKey | None = None,
        snaps: bool = False,
    ):
        self.snaps, self._snap_pins = snaps, list[tuple[int, PinPlace]]()
        self.plate, self.thickness, self.base, self.lettered = plate, thickness, base, lettered
        self._bills: list[tuple[str, Bill]] = []
        self._shaft_items: list[Bought] = []
        self._layers: dict[int, list[str]] = {}
        self._upper_collars: list[tuple[int, str]] = []
        self._last: list[str] = []
        self._height_below = 0.0
        self._motor = None if motor is None else face_of(motor)
        # Number of layers that the motor's own plate takes.
        self._motor_layers = int(motor is not None and base is None)
        if self._motor and self._motor_layers:
            self._layers[0] = [
                f"screw motor_plate from above onto motor {self._motor.product}, shaft up, "
                f"with {len(self._motor.screws)} screws"
            ]
        if plate:
            self.add_step(0, f"lay {plate}{' on the heads of its screws' if self._motor_layers else ''}")

    @property
    def lowest(self) -> int:
        """The layer of the lowest wheel: above the plate if there is one."""
        return int(bool(self.plate))

    def add_step(self, layer: int, step: str) -> None:
        """Add a step to a layer; layer 0 is the plate or, without one, the lowest wheel."""
        self._layers.setdefault(layer + self._motor_layers, []).append(step)

    def add_last_step(self, step: str) -> None:
        """Add a step after all layers."""
        self._last.append(step)

    def joint_name(self, letter: str, part: str) -> str:
        """Name of a joint in the bill: the letter at its holes or, if none is engraved, a part's name."""
        return letter if self.lettered else part

    def buy(self, joint: str, bill: Bill) -> None:
        """Add the items of a joint."""
        self._bills.append((joint, bill))

    def shaft(
        self, letter: str, part: str, stock: AbstractBored, grip: float, top: int, gap: float = 0.0, keys: int = 1
    ) -> None:
        """Add the shaft of a wheel with a collar at each end; a motor holds its shaft itself.

        The shaft goes in with the plate; its upper collar is the last step of the layer `top`. grip: total height of
        plates and gaps on the shaft, mm. gap: distance between plate and wheel, mm, kept by a tube. keys: number of
        keyed discs on the shaft.
        """
        joint, shaft_name = self.joint_name(letter, part), letter if self.lettered else f"the shaft of {part}"
        if stock.motor is not None:
            self.buy(joint, shaft_bill(stock, grip, base=0.0 if self._motor_layers else self.thickness, keys=keys))
            if not self._motor_layers:
                self.add_step(0, fixed_under(self.plate, letter, len(face_of(stock.motor).screws)))
            return
        if self.snaps:
            if not self.plate or stock.bore_form != "round" or any(stock.keyway) or stock.is_pressed or not stock.bore:
                problem = f"found snap, but {part} has no round bore that runs on a pin in a plate"
                remedy = 'give a round bore without a press fit and a base, or "bought"'
                raise DesignError("printing.pins", problem, remedy, "conflict")
            self.snap_pin(letter, stock, stock.bore, grip, top)
            return
        if not stock.bore:
            return
        width = collar_width(stock.bore)
        (shaft, *key), pair = shaft_bill(stock, grip + 2 * width, keys=keys), collar_bill(stock.bore, 2)
        self.buy(joint, (shaft, *key, *pair))
        self._shaft_items += (Bought(name, count, (joint,)) for name, count in (shaft, *pair))
        if self.plate:
            self.add_step(0, f"put {shaft_name} through from above; fit a collar on {shaft_name} below {self.plate}")
            self.keep_free_below(width)
        if gap:
            self.buy(joint, tube_bill(stock.bore, gap))
            self.add_step(1, f"put a tube of {mm(gap):g} on {shaft_name}")
        collars = f"fit a collar on {shaft_name}" if self.plate else f"fit a collar on each end of {shaft_name}"
        self._upper_collars.append((top, collars))

    def seated(self, part: str, letter: str, stock: AbstractBored) -> str:
        """The step that puts a wheel or cam on its shaft, or over the hole of its printed pin."""
        has_pin = self.snaps and stock.motor is None
        return f"lay {part} over {letter}" if has_pin else seated(part, letter if self.lettered else "", stock)

    def snap_pin(self, letter: str, stock: AbstractBored, diameter: float, grip: float, top: int) -> None:
        """Add a printed pin, pressed in from above after the layer `top`. grip: total height of its plates, mm."""
        pin = SnapPin(diameter, "snap", SNAP_PLAY, clearance=stock.clearance)
        self._snap_pins.append((top, PinPlace(letter, pin, grip, stock.material)))
        self.keep_free_below(pin.ends(grip)[1])

    def keep_free_below(self, height: float) -> None:
        """Reserve a height under the plate, mm."""
        self._height_below = max(self._height_below, height)

    def pins(self, letter: str, part: str, diameter: float, grip: float, count: int = 1, under: bool = False) -> None:
        """Add pins that are glued into a part, each with a collar on its other end.

        grip: total thickness of the plates on each pin, mm. under: whether the collars are under the base.
        """
        if diameter:
            joint = self.joint_name(letter, part)
            self.buy(joint, pin_bill(diameter, grip + collar_width(diameter), count))
            self.buy(joint, (*collar_bill(diameter, count), *glue_bill(count)))
            if under:
                self.keep_free_below(collar_width(diameter))

    def planet_shafts(self, joint: str, stock: AbstractBored, grip: float, count: int, collars: bool) -> None:
        """Add the shafts of planets with their keys, and a collar on each shaft that turns in the carrier."""
        self.buy(joint, shaft_bill(stock, grip + collars * collar_width(stock.bore), count))
        if collars:
            self.buy(joint, collar_bill(stock.bore, count))

    def screws(self, letter: str, diameter: float, grip: float, count: int) -> None:
        """Add screws through a thickness, mm, with nuts under the plate."""
        if size_of(diameter):
            fastener = Fastener(diameter, "screw", 0.0)
            bill = fastener.bill(grip)
            self.keep_free_below(fastener.ends(grip)[1])
        else:
            bill = ((f"screw {mm(diameter):g} with nut, at least {mm(grip + 2 * diameter):up6} long", 1),)
            self.keep_free_below(2 * diameter)
        self.buy(letter, tuple((name, number * count) for name, number in bill))

    def build(self, feet: int = 4) -> Assembly:
        """The assembly; the screws and feet of the plate come last."""
        if self._motor and not self._motor_layers:
            self._add_motor_feet(self._motor, self._height_below + FREE, feet)
        elif self.plate and self._height_below:
            free = self._height_below + FREE
            if self.base is not None and self.base.screw:
                self.buy(self.plate, screw_bill(self.base, self.thickness + free, feet))
                self.buy(self.plate, tube_bill(self.base.screw, free, feet))
                step = f"screw {self.plate} down at its corners, with a tube of {mm(free):g} under each"
                self._last.insert(0, f"{step}, so that nothing rubs below it")
            else:
                self._last.insert(0, f"keep {mm(free):g} free under {self.plate}")
        for layer, step in self._upper_collars:
            self.add_step(layer, step)
        places = tuple(place for _, place in self._snap_pins)
        names = {place.letter: name for name, group in alike(places).items() for place in group}
        for layer, place in self._snap_pins:
            self.add_step(
                layer, f"press {names[place.letter]} into {place.letter} from above until the barbs snap out below"
            )
        layers = (f"{layer_name(layer)}: {'; '.join(self._layers[layer])}" for layer in sorted(self._layers))
        return Assembly(gathered(self._bills), (*layers, *self._last), tuple(self._shaft_items), places)

    def _add_motor_feet(self, motor: MotorFace, free: float, feet: int) -> None:
        """Feet for a base over a motor, which is sold in several lengths. free: least height under the base, mm."""
        if self.base is None or not self.base.screw:
            height = f"the length of motor {motor.product}, at least {mm(free):up6},"
            self._last.insert(0, f"keep {height} free under {self.plate}")
            return
        screw = self.base.screw
        self.buy(self.plate, ((f"screw {mm(screw):g}, at least {mm(self.thickness):up6} longer than its tube", feet),))
        longer = f"{mm(FREE):g} longer than the motor, and at least {mm(free):up6}"
        self.buy(self.plate, ((f"tube {mm(screw):g} inside, cut {longer}", feet),))
        step = f"screw {self.plate} down at its corners, with a tube under each, {mm(FREE):g} longer than the motor"
        self._last.insert(0, f"{step} and at least {mm(free):up6} long")


def seated(part: str, letter: str, stock: AbstractBored) -> str:
    """The step that puts a wheel or cam on its shaft; letter: "" if none is engraved."""
    shaft = letter or ("its motor's shaft" if stock.motor else "its shaft")
    verb, (width, _) = ("press" if stock.is_pressed else "lay"), stock.keyway
    if not stock.bore:
        return f"lay {part}"
    if stock.across_flat is not None:
        return f"{verb} {part} on {shaft}, flat on flat"
    if width:
        return f"{verb} {part} on {shaft} with its key (the shaft needs a keyway {mm(width):g} wide)"
    if stock.is_pressed:
        return f"press {part} on {shaft}"
    return f"lay {part} on {shaft} (it turns on the shaft unless you glue it; the bill has no glue for it)"
