"""The base of a cam: its shaft, and the pivot of an arm or the slot that guides a stem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, quantity
from ..core.records import record
from ..core.units import mm
from ..making.assembly import (
    Assembly,
    AssemblyBuilder,
    BaseOpening,
    BaseStock,
    collar_across,
    collar_bill,
    collar_width,
    pin_bill,
    standing_plate,
)
from ..making.bores import AbstractBored, bore, fits_of, shaft
from ..making.materials import STEEL_DENSITY
from ..making.motors import MountedMotorKey
from ..model.material import Mass
from ..model.part import HoleFit, Part
from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..plane.primitives import Arc, Circle, Polyline, Segment
from ..plane.vec import Complex, box_of
from .cam import Cam
from .followers.follower import Bars, FollowerPlate
from .program.laws import largest, samples
from .undercut import Undercut, undercut

# Letters engraved at holes that belong together, by the key of their diameter in the stock; the cam's shaft is A.
LETTERS = {"bore": "A", "pivot_bore": "B", "roller_bore": "C"}
# Follower positions between lowest and highest lift at which its extent is computed. Between two of them an arm
# deviates by thousandths of its length; fewer positions miss more of that, more take longer.
POSITIONS = 65
# Chord tolerance of outlines for that extent, as a share of the cam's size: as accurate as the positions.
CHORDS = 1e-3


def cam_base(
    cam: Cam,
    cut: Undercut,
    plates: Sequence[FollowerPlate],
    shafts: Mapping[str, float],
    stock: CamStock,
    base: BaseStock,
    collar: float = 0.0,
) -> Part:
    """The base under a cam and its follower, in the ground's frame, with the cam's axis at the origin.

    plates: from `guided_plates`; their holes `pivot_bore` lie over the pivot, or over the slot in which the pins slide.
    shafts: diameters of `bore` and `pivot_bore`, mm. stock: sheet, and the motor whose holes the base has. collar:
    diameter of what is on the cam shaft in the layer of the bar, mm.
    Raises DesignError if there is no room. Derived here.
    """
    lifts = np.linspace(*_lift_limits(cam), POSITIONS)
    pose = cam.follower.pose(lifts, cam.base_radius)
    origin, direction = np.asarray(pose.origin)[:, None], np.asarray(pose.direction)[:, None]
    pins = np.array([hole.centre for plate in plates for hole in plate.holes if hole.key == "pivot_bore"])
    pin_paths = origin + direction * pins
    openings = _openings(cam, pin_paths, shafts, stock.motor)
    chords = CHORDS * cam.prime_radius
    bars = [origin + direction * flatten(p.outline, chords) for p in plates if p.name != "roller"]
    if cam.follower.knife_edge is not None and not any(plate.window for plate in plates):
        for bar in bars:
            _check_shaft(bar, shafts["bore"], collar)
    radius = np.abs(cut.outline.point(samples(cut.outline.breaks))).max() + chords
    cam_box = np.array([-radius - 1j * radius, radius + 1j * radius])
    points = np.concatenate([cam_box, *(z.ravel() for z in bars), *_roller_boxes(cam)])
    # The bars contain the boss of a pivot and the pins of a stem.
    return standing_plate(box_of(points), openings, base, stock.thickness, stock.material)


def _openings(
    cam: Cam, pin_paths: Complex, shafts: Mapping[str, float], motor: MountedMotorKey | None
) -> list[BaseOpening]:
    """Openings of the base: for the cam's shaft, and for the pivot of an arm or the pins of a stem.

    pin_paths: positions (frames, pins) of the pins of the follower, mm.
    """
    pin, letter = shafts["pivot_bore"], LETTERS["pivot_bore"]
    bore_of_pin, collar = ("stock.pivot_bore", pin), collar_across(pin)
    openings = [BaseOpening("the cam shaft", "stock.bore", shafts["bore"], (0j,), LETTERS["bore"], motor=motor)]
    if cam.follower.oscillates:
        pivot = complex(pin_paths[0, 0])
        return [*openings, BaseOpening("the arm's pivot", *bore_of_pin, (pivot,), letter, head=collar)]
    if pin_paths.shape[1] < 2:
        raise DesignError("base", "the follower has no stem that a base could guide", "omit base", "conflict")
    ends = (complex(pin_paths[0, 0]), complex(pin_paths[-1, -1]))
    return [*openings, BaseOpening("the guide pins", *bore_of_pin, ends, letter, head=collar)]


def _lift_limits(cam: Cam) -> tuple[float, float]:
    """Lowest and highest lift, mm or rad. Undercut never cuts the circle that the lowest lift alone would need."""
    program = cam.program
    highest = largest(program.breaks, lambda t: program.motion(t).lift)[0]
    lowest = -largest(program.breaks, lambda t: -program.motion(t).lift)[0]
    return lowest, highest


def _roller_boxes(cam: Cam) -> Iterator[Complex]:
    """Corners of the boxes round the roller at the sampled cam angles."""
    radius = cam.follower.roller_radius
    if radius:
        contact = cam.contact(samples(cam.program.breaks).ravel())
        centre = contact.point + radius * contact.normal
        yield from (centre + radius * corner for corner in (1 + 1j, -1 - 1j))


def _check_shaft(bar: Complex, bore: float, collar: float) -> None:
    """Refuse a bar that the cam's shaft, or the collar on it, would meet; outline (positions, points)."""
    shaft = max(bore, collar)
    edge = np.roll(bar, -1, axis=1) - bar
    share = np.clip(np.real(-bar * np.conj(edge)) / np.maximum(np.abs(edge) ** 2, 1e-300), 0, 1)
    room = float(np.abs(bar + share * edge).min())
    inside = (np.abs(np.angle(np.roll(bar, -1, axis=1) / bar).sum(axis=1)) > np.pi).any()
    if inside or room <= shaft / 2:
        raise DesignError(
            "stock.bar_width",
            f"the follower's bar meets the {'collar on the ' if collar > bore else ''}cam shaft of {mm(shaft):g}",
            f"give a bore of less than {mm(2 * room):down}, narrower bars or a larger base_radius"
            if room and not inside and not collar
            else "give narrower bars or a larger base_radius",
        )


TIMING_STEP = "the timing line is under the follower at cam angle 0; the arrow shows the direction of rotation"
# Timing mark, as shares of the ring between the hole and the base circle: both ends of the line, and the arrow's
# radius.
LINE, ARROW = (0.2, 0.9), 0.55
# Sweep of the arrow, rad, and length of its head as a share of the ring: easy to see, and clear of both edges.
SWEEP, HEAD = np.pi / 4, 0.15


@record
class CamStock(AbstractBored):
    """Sheet, bores and bars of a cam and its follower; all lengths in mm.

    Parameters
    ----------
    thickness : float, optional
        Thickness of the sheet, mm.
    bore : float, optional
        Diameter of the cam shaft, mm; 0 for no hole.
    bore_form, flat, keyway_width, keyway_depth, fit, interference : optional
        Form and fit of the cam's bore, as of `AbstractBored`. All other holes run on their pins.
    clearance : float, optional
        How much wider a hole is than its pin or shaft, mm.
    motor : str or MotorFace, optional
        Motor that drives the cam.
    material : Material, optional
        Material of cam and follower.
    roller_bore, pivot_bore : float, optional
        Diameters of the roller's pin, and of an arm's pivot or the pins in a stem, mm; 0 for no hole.
    timing_mark : bool, optional
        Whether to engrave a line towards the contact point at cam angle 0, and an arrow in the direction of rotation.
    bar_width : float, optional
        Width of a flat follower's bars and of arms, mm.
    overhang : float, optional
        How far a flat face extends beyond the range that the cam touches, mm.
    stem_length : float, optional
        Distance from a translating face, or with a base from a translating roller, to the hole in its stem, mm.

    Raises
    ------
    DesignError
        If a size is out of range or the bore's form and sizes contradict each other.

    Notes
    -----
    Keyways by DIN 6885-1, depth in the hub along the middle; the defaults are chosen here.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=5.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the cam shaft", 8.0, fitted=True)
    roller_bore: float = shaft("the roller's pin", 4.0)
    timing_mark: bool = entry(
        "engrave a line towards the contact point at cam angle 0, and an arrow in the direction of rotation",
        default=False,
    )
    bar_width: float = quantity(
        "width of a flat follower's bars and of arms", "mm", default=12.0, at_least=0.01, at_most=FARTHEST
    )
    overhang: float = quantity(
        "how far a flat face extends beyond the range that the cam touches", "mm",
        default=2.0, at_least=0, at_most=FARTHEST,
    )  # fmt: skip
    stem_length: float = quantity(
        "distance from a translating flat face, or with a base from a translating roller, to the hole in its stem",
        "mm",
        default=40.0,
        above=0,
        at_most=FARTHEST,
    )
    pivot_bore: float = shaft("an arm's pivot, or of the pins in a stem", 6.0)

    @property
    def bars(self) -> Bars:
        """The sizes that followers are cut with."""
        return Bars(self.bar_width, self.overhang, self.stem_length, self.pivot_bore, self.roller_bore)


@checked
def cam_parts(
    cam: Cam, stock: CamStock = CamStock(), cut: Undercut | None = None, base: BaseStock | None = None
) -> list[Part]:
    """The parts of a cam and its follower that are to be cut.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    stock : CamStock, optional
        Sheet, bores and bars.
    cut : Undercut, optional
        The result of `undercut`, if it is known already.
    base : BaseStock, optional
        Adds a base plate under cam and follower.

    Returns
    -------
    list of Part
        `cam` about its axis; then the plates of the follower, each in its own frame, mm: `roller`, and `arm` or
        `follower` for an arm or a flat face. A translating roller has no further plate; supply its guide. With a base
        it has a `follower` whose two pins slide in the base's slot, and holes that belong together have the same
        letter. The last part is the base, with the holes of the stock's motor; without a base it is the `motor_plate`.
        If the follower undercuts the cam, the cam plate is the trimmed one.

    Raises
    ------
    DesignError
        If holes or bars do not fit; its field is a size of the stock.

    Notes
    -----
    Derived here.

    Examples
    --------
    >>> program = gk.Program((gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360)))
    >>> cam = gk.Cam(gk.TranslatingRoller(10), program, base_radius=40)
    >>> [part.name for part in gk.cam.cam_parts(cam, gk.cam.CamStock(thickness=6, bore=10))]
    ['cam', 'roller']
    """
    cut = cut or undercut(cam)
    plate = cam_plate(cam, stock, cut)
    plates = follower_plates(cam, stock, base)
    if base is None:
        return [plate, *(follower_part(other, stock) for other in plates), *stock.motor_parts]
    parts = [replace(plate, hole_names=("A",)), *(follower_part(other, stock, LETTERS) for other in plates)]
    shafts = {"bore": stock.bore, "pivot_bore": stock.pivot_bore}
    return [*parts, cam_base(cam, cut, plates, shafts, stock, base)]


def follower_part(plate: FollowerPlate, stock: CamStock, letters: Mapping[str, str] | None = None) -> Part:
    """A plate of the follower with its holes; letters: by the keys of their diameters, none without a base."""
    circles: list[Circle] = []
    names: list[str] = []
    fits: list[HoleFit] = []
    for hole in plate.holes:
        circle = bore(hole.diameter, stock.clearance, hole.widest, f"stock.{hole.key}", hole.centre)
        circles += circle
        fits += fits_of(hole.diameter, stock.clearance)
        names += [letters.get(hole.key, "") for _ in circle] if letters else []
    return Part(
        plate.name,
        plate.outline,
        (*circles, *([plate.window] if plate.window else [])),
        stock.thickness,
        body=plate.name,
        hole_names=tuple(names),
        fits=tuple(fits),
        material=stock.material,
    )


def cam_plate(cam: Cam, stock: CamStock, cut: Undercut) -> Part:
    """The plate of a cam with its bore and its timing mark."""
    narrowest = 2 * float(np.abs(cut.outline.point(samples(cut.outline.breaks))).min())
    start = complex(cam.profile.point(0.0))
    towards = start / abs(start)
    holes = stock.hole(towards, narrowest, "stock")
    if not stock.timing_mark:
        marks: tuple[AbstractCurve, ...] = ()
    else:
        marks = _timing_marks(towards, stock.hole_reach, narrowest / 2, cam.sense)
    return Part(
        "cam", cut.outline, holes, stock.thickness, marks=marks, body="cam", fits=stock.fits, material=stock.material
    )


def _timing_marks(towards: complex, inner: float, outer: float, sense: int) -> tuple[AbstractCurve, ...]:
    """Timing line in the unit direction `towards` and arrow in the direction of rotation, between two radii, mm."""
    ring = outer - inner
    start, end = (towards * (inner + share * ring) for share in LINE)
    arrow = Arc(0j, towards * (inner + ARROW * ring), sense * SWEEP)
    tip = complex(arrow.point(1.0))
    back = -1j * sense * tip / abs(tip) * HEAD * ring
    barbs = np.array([tip + back * np.exp(0.5j), tip, tip + back * np.exp(-0.5j)])
    return Segment(start, end), arrow, Polyline(barbs, is_closed=False)


def follower_plates(cam: Cam, stock: CamStock, base: BaseStock | None) -> tuple[FollowerPlate, ...]:
    """The plates of the follower; over a base those that it guides."""
    plates = cam.follower.plates if base is None else cam.follower.guided_plates
    return plates(stock.bars, cam.program, cam.base_radius, cam.sense)


def pin_masses(
    plates: Sequence[FollowerPlate], stock: CamStock, base: BaseStock | None, layers: int = 2
) -> dict[str, Mass]:
    """Masses of the steel pins that are glued into the follower's plates, with their collars, by the plate.

    layers: number of sheets that a pin passes over a base.
    """
    masses: dict[str, Mass] = {}
    for plate in plates:
        for hole in plate.holes if plate.name != "roller" else ():
            diameter, collar = hole.diameter, 0.0
            if hole.key == "roller_bore" or base is not None:
                collar = collar_width(diameter)
            sheets = (1 if base is None else layers) if hole.key == "pivot_bore" else 2
            length = sheets * stock.thickness
            rings = (collar_across(diameter) ** 2 - diameter**2) * collar
            volume = np.pi / 4 * (diameter**2 * (length + collar) + rings) if diameter else 0.0
            mass = Mass(STEEL_DENSITY * 1e-9 * volume, hole.centre)
            masses[plate.name] = masses[plate.name] + mass if plate.name in masses else mass
    return masses


def cam_assembly(cam: Cam, stock: CamStock, base: BaseStock | None, snaps: bool = False) -> Assembly:
    """Items to buy for a cam and its follower, and the steps of assembly. snaps: whether pins are printed."""
    follower, thick = cam.follower, stock.thickness
    plates = follower_plates(cam, stock, base)
    bars = [plate for plate in plates if plate.name != "roller"]
    # A roller runs in the plane of the cam, and its bar lies under both; a face lies in the plane of the cam.
    has_bar_below = bool(bars) and follower.knife_edge is not None
    if snaps and (base is None or has_bar_below or not follower.oscillates):
        problem = "found snap, but only a flat face on an arm, over a base, turns on printed pins"
        remedy = 'give follower.kind = "oscillating-flat" and a base, or "bought"'
        raise DesignError("printing.pins", problem, remedy, "conflict")
    builder = AssemblyBuilder("" if base is None else "base", thick, base, base is not None, stock.motor, snaps)
    layer = builder.lowest + has_bar_below
    gap = thick if base is not None and has_bar_below else 0.0
    builder.shaft("A", "cam", stock, (0.0 if base is None else thick) + gap + thick, layer, gap)
    for plate in bars:
        for step in _bar_steps(builder, plate, plates, stock, base):
            builder.add_step(builder.lowest, step)
    if any(plate.name == "roller" for plate in plates):
        _add_roller(builder, plates, stock, layer)
    # A tube keeps the cam above the follower; on a motor the motor's shaft holds the cam.
    height = f", {mm(gap):g} above base" if gap and stock.motor else ""
    builder.add_step(layer, builder.seated("cam", "A", stock) + f"{height}, with the drawn side up")
    if stock.timing_mark:
        builder.add_step(layer, TIMING_STEP)
    held = plates[0].name if plates else "the follower"
    builder.add_last_step(f"supply a spring or weight that holds {held} on cam")
    if base is None:
        builder.add_last_step(unheld(cam, bool(bars), stock))
    return builder.build()


def _bar_steps(
    builder: AssemblyBuilder,
    plate: FollowerPlate,
    plates: tuple[FollowerPlate, ...],
    stock: CamStock,
    base: BaseStock | None,
) -> Iterator[str]:
    """Steps for the follower or arm: its pins are glued in, flush on the side on which cam or base pass."""
    pivot_holes = [hole for hole in plate.holes if hole.key == "pivot_bore" and hole.diameter]
    count, swings = len(pivot_holes), plate.name == "arm"
    letter = LETTERS["pivot_bore"]
    if builder.snaps:
        builder.snap_pin(letter, stock, stock.pivot_bore, 2 * stock.thickness, builder.lowest)
        yield f"lay {plate.name}"
        return
    if pivot_holes and base is not None:
        pins = f"{count} pins {letter}" if count > 1 else f"pin {letter}"
        builder.pins(letter, plate.name, stock.pivot_bore, 2 * stock.thickness, count, under=True)
        yield f"glue {pins} into {plate.name}, flush at the top"
    elif pivot_holes:
        builder.buy(plate.name, pin_bill(stock.pivot_bore, stock.thickness, count))
    has_roller_pin = any(hole.key == "roller_bore" and hole.diameter for hole in plate.holes)
    if has_roller_pin and any(other.name == "roller" for other in plates):
        pin_name = LETTERS["roller_bore"] if builder.lettered else "of roller"
        yield f"glue the pin {pin_name} into {plate.name}, flush at the bottom"
    if base is None:
        yield f"lay {plate.name}" + (", with its pin through it into your support" if pivot_holes else "")
    elif swings:
        yield f"lay arm, with its pin {letter} through base; fit a collar on {letter} below base, with play to turn"
    else:
        collars = f"fit {count} collars on {letter} below base, with play to slide"
        yield f"lay {plate.name}, with its pins through the slot {letter} of base; {collars}"


def _add_roller(builder: AssemblyBuilder, plates: tuple[FollowerPlate, ...], stock: CamStock, layer: int) -> None:
    bars = sum(any(hole.key == "roller_bore" for hole in plate.holes) for plate in plates)
    if not stock.roller_bore:
        builder.add_step(layer, "lay roller")
        return
    letter = LETTERS["roller_bore"]
    pin_name = letter if builder.lettered else "its pin"
    if bars > 1:
        builder.pins(letter, "roller", stock.roller_bore, bars * stock.thickness)
    else:
        # A stem that is not supplied holds the pin.
        length = stock.thickness + collar_width(stock.roller_bore)
        builder.buy("roller", (*pin_bill(stock.roller_bore, length), *collar_bill(stock.roller_bore)))
    builder.add_step(layer, f"lay roller on {pin_name} so that it turns freely; fit a collar on {pin_name}, with play")


def unheld(cam: Cam, has_bar: bool, stock: CamStock) -> str:
    """The step for parts that nothing holds without a base."""
    follower = cam.follower
    if follower.oscillates:
        distance = abs(complex(np.ravel(follower.pose(np.zeros(1), cam.base_radius).origin)[0]))
        return f"supply a support that holds the pivot {mm(distance):.6g} from the shaft of cam"
    stem = "follower" if has_bar else "a stem with the pin of the roller" if follower.roller_radius else "a stem"
    shaft = "" if stock.motor else ", and a support for the shaft of cam"
    return f"supply a guide for {stem}{shaft}"
