"""The base of a cam: its shaft, and the pivot of an arm or the slot that guides a stem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, quantity, rounded_down
from ..core.records import record
from ..making.assembly import Assembling, Assembly, collar_across, pin_bill, seated
from ..making.bases import BaseOpening, BaseStock, standing_plate
from ..making.bores import bore, fits_of, shaft
from ..making.fits import AbstractBored
from ..making.motors import MotorName
from ..model.part import Bought, HoleFit, Part
from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..plane.primitives import Arc, Circle, Polyline, Segment
from ..plane.vec import Complex
from .cam import Cam
from .extrema import largest, samples
from .followers.follower import Bars, Plate
from .undercut import Undercut, undercut

# Letters at the holes that belong together, by what the stock calls their diameters; the cam's own shaft is A.
LETTERS = {"bore": "A", "pivot_bore": "B", "roller_bore": "C"}
# Places of the follower between its lowest and its highest at which room for it is looked for. Fewer miss more of an
# arm's swing between two of them, which counts by thousandths of its length; more take longer.
PLACES = 65
# Chords of outlines, as a share of the cam's size, for finding that room: as near as the swing.
CHORDS = 1e-3


def cam_base(
    cam: Cam,
    cut: Undercut,
    plates: Sequence[Plate],
    shafts: Mapping[str, float],
    thickness: float,
    base: BaseStock,
    motor: MotorName | None = None,
) -> Part:
    """The base under a cam and its follower, in the ground's frame, the cam's axis at the origin.

    plates: as `guided_plates` gives them; holes `pivot_bore` in them are over that of the pivot, or over the slot in
    which the pins slide. shafts: diameters, mm, of `bore` and `pivot_bore`. motor: what turns the cam; the base has its
    holes there. Raises DesignError where there is no room.
    Derived here.
    """
    lifts = np.linspace(*_lifts(cam), PLACES)
    pose = cam.follower.place(lifts, cam.base_radius)
    origin, direction = np.asarray(pose.origin)[:, None], np.asarray(pose.direction)[:, None]
    pins = np.array([hole.centre for plate in plates for hole in plate.holes if hole.key == "pivot_bore"])
    ways = origin + direction * pins
    shaft = BaseOpening("the cam shaft", "stock.bore", shafts["bore"], (0j,), LETTERS["bore"], motor=motor)
    openings = [shaft]
    pin = shafts["pivot_bore"]
    held, collar = ("stock.pivot_bore", pin), collar_across(pin)
    if cam.follower.oscillates:
        pivot = complex(ways[0, 0])
        openings.append(BaseOpening("the arm's pivot", *held, (pivot,), LETTERS["pivot_bore"], head=collar))
    elif len(pins) < 2:
        raise DesignError("base", "the follower has no stem that it could guide", "leave it out")
    else:
        ends = (complex(ways[0, 0]), complex(ways[-1, -1]))
        openings.append(BaseOpening("the guide pins", *held, ends, LETTERS["pivot_bore"], head=collar))
    chords = CHORDS * cam.prime_radius
    bars = [origin + direction * flatten(p.outline, chords) for p in plates if p.name != "roller"]
    if cam.follower.knife_edge is not None:
        for bar in bars:
            _check_shaft(bar, shafts["bore"])
    reach = np.abs(cut.outline.point(samples(cut.outline.breaks))).max() + chords
    own = np.array([-reach - 1j * reach, reach + 1j * reach])
    places = np.concatenate([own, *(z.ravel() for z in bars), *_rollers(cam)])
    low, high = complex(places.real.min(), places.imag.min()), complex(places.real.max(), places.imag.max())
    # A pivot's boss lies within the bars, and so do the pins of a stem.
    return standing_plate((low, high), openings, base, thickness)


def _lifts(cam: Cam) -> tuple[float, float]:
    """Lowest and highest, mm or rad. Undercut leaves the round cam that the lowest lift alone would need."""
    program = cam.program
    highest = largest(program.breaks, lambda t: program.motion(t).lift)[0]
    lowest = -largest(program.breaks, lambda t: -program.motion(t).lift)[0]
    return lowest, highest


def _rollers(cam: Cam) -> Iterator[Complex]:
    """Corners of the boxes about the roller at each place of it."""
    radius = cam.follower.rounding
    if radius:
        contact = cam.contact(samples(cam.program.breaks).ravel())
        centre = contact.point + radius * contact.normal
        yield from (centre + radius * corner for corner in (1 + 1j, -1 - 1j))


def _check_shaft(bar: Complex, shaft: float) -> None:
    """Refuse a bar between cam and base, at places (n, points), that the cam's shaft would meet."""
    along = np.roll(bar, -1, axis=1) - bar
    share = np.clip(np.real(-bar * np.conj(along)) / np.maximum(np.abs(along) ** 2, 1e-300), 0, 1)
    room = float(np.abs(bar + share * along).min())
    inside = (np.abs(np.angle(np.roll(bar, -1, axis=1) / bar).sum(axis=1)) > np.pi).any()
    if inside or room <= shaft / 2:
        raise DesignError(
            "stock.bar_width",
            f"the bar of the follower, between cam and base, meets the cam shaft of {shaft:g} mm",
            f"give a bore of less than {rounded_down(2 * room)} mm, narrower bars or a larger base_radius"
            if room and not inside
            else "give narrower bars or a larger base_radius",
        )


# Of the timing mark, as shares of the ring between the hole and the base circle: the line's ends, and where the arrow
# runs across it.
LINE, ARROW = (0.2, 0.9), 0.55
# Sweep of the arrow, rad, and length of its head as a share of the ring: seen at a glance, and clear of both edges.
SWEEP, HEAD = np.pi / 4, 0.15


@record
class CamStock(AbstractBored):
    """What a cam and its follower are cut from, and what they turn on; all lengths in mm.

    Fit and form are those of the cam's bore; other holes run on their pins. Source: keyways as DIN 6885-1 gives them,
    depth in the hub along the middle; the defaults are chosen here.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=5.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the cam shaft", 8.0, fitted=True)
    roller_bore: float = shaft("the roller's pin", 4.0)
    timing_mark: bool = entry(
        "engrave a line towards where the follower touches at cam angle 0, and the way the cam turns", default=False
    )
    bar_width: float = quantity(
        "width of a flat follower's bars and of arms", "mm", default=12.0, at_least=0.01, at_most=FARTHEST
    )
    overhang: float = quantity(
        "how far a flat face runs beyond where the cam touches it", "mm", default=2.0, at_least=0, at_most=FARTHEST
    )
    stem_length: float = quantity(
        "distance from a translating flat face, or over a base from a translating roller, to the hole in its stem",
        "mm",
        default=40.0,
        above=0,
        at_most=FARTHEST,
    )
    pivot_bore: float = shaft("an arm's pivot, or of the pin in a stem", 6.0)

    @property
    def bars(self) -> Bars:
        """What followers need to know of it."""
        return Bars(self.bar_width, self.overhang, self.stem_length, self.pivot_bore, self.roller_bore)


@checked
def cam_parts(
    cam: Cam, stock: CamStock = CamStock(), cut: Undercut | None = None, base: BaseStock | None = None
) -> list[Part]:
    """The parts to cut: `cam`, the plate about its axis, then those of its follower, each in its own frame, mm.

    They are `roller` and, of an arm or a flat face, `arm` or `follower`; a roller that moves straight needs a guide to
    fit and gets no plate. With a base, such a roller has a `follower` too, whose two pins slide in the base's slot, and
    holes that belong together have the same letter. Last comes the base, which then has the holes of the stock's motor,
    or the `motor_plate`. Where the follower undercuts, the cam plate is what it leaves; `undercut` tells what lift that
    costs. cut: what it found, where that is known already. Raises DesignError, its field a size of the stock, where
    holes or bars do not fit.

        gk.write(gk.cam.cam_parts(cam, gk.cam.CamStock(thickness=6, bore=10)), "cam.dxf")

    Source: derived here.
    """
    cut = cut or undercut(cam)
    plate, follower = _cam_plate(cam, stock, cut), cam.follower
    bars = stock.bars, cam.program, cam.base_radius, cam.sense
    if base is None:
        return [plate, *(_cut(other, stock) for other in follower.plates(*bars)), *stock.motor_parts]
    plates = follower.guided_plates(*bars)
    parts = [replace(plate, hole_names=("A",)), *(_cut(other, stock, LETTERS) for other in plates)]
    shafts = {"bore": stock.bore, "pivot_bore": stock.pivot_bore}
    return [*parts, cam_base(cam, cut, plates, shafts, stock.thickness, base, stock.motor)]


def _cut(plate: Plate, stock: CamStock, letters: Mapping[str, str] | None = None) -> Part:
    circles: list[Circle] = []
    names: list[str] = []
    fits: list[HoleFit] = []
    for hole in plate.holes:
        one = bore(hole.diameter, stock.clearance, hole.widest, f"stock.{hole.key}", hole.centre)
        circles += one
        fits += fits_of(hole.diameter, stock.clearance)
        names += [letters.get(hole.key, "") for _ in one] if letters else []
    return Part(
        plate.name,
        plate.outline,
        tuple(circles),
        stock.thickness,
        body=plate.name,
        hole_names=tuple(names),
        fits=tuple(fits),
    )


def _cam_plate(cam: Cam, stock: CamStock, cut: Undercut) -> Part:
    narrowest = 2 * float(np.abs(cut.outline.point(samples(cut.outline.breaks))).min())
    start = complex(cam.profile.point(0.0))
    towards = start / abs(start)
    holes = stock.hole(towards, narrowest, "stock")
    if not stock.timing_mark:
        return Part("cam", cut.outline, holes, stock.thickness, body="cam", fits=stock.fits)
    marks = _timing_marks(towards, stock.hole_reach, narrowest / 2, cam.sense)
    return Part("cam", cut.outline, holes, stock.thickness, marks=marks, body="cam", fits=stock.fits)


def _timing_marks(towards: complex, inner: float, outer: float, sense: int) -> tuple[AbstractCurve, ...]:
    """How the cam is put on its shaft, and which way it turns: a radial line in the unit direction `towards`, and from
    it an arrow.

    Both lie between two circles about the axis, mm. sense: +1 counterclockwise, -1 clockwise.
    """
    ring = outer - inner
    start, end = (towards * (inner + share * ring) for share in LINE)
    arrow = Arc(0j, towards * (inner + ARROW * ring), sense * SWEEP)
    tip = complex(arrow.point(1.0))
    back = -1j * sense * tip / abs(tip) * HEAD * ring
    barbs = np.array([tip + back * np.exp(0.5j), tip, tip + back * np.exp(-0.5j)])
    return Segment(start, end), arrow, Polyline(barbs, is_closed=False)


@checked
def cam_bought(cam: Cam, stock: CamStock = CamStock(), base: BaseStock | None = None) -> tuple[Bought, ...]:
    """The cam's shaft and key, the pins of its follower, the collars that hold them, and the base's screws and feet.

    For joints by the letters at their holes over a base, and by the names of parts without one. A shaft or pin is as
    long as all plates, gaps and collars on it. Bearings are not told. Derived here.
    """
    return cam_assembly(cam, stock, base).bought


def cam_assembly(cam: Cam, stock: CamStock, base: BaseStock | None) -> Assembly:
    """What is bought for a cam and its follower, and how all of it goes together."""
    follower, thick = cam.follower, stock.thickness
    guided = follower.plates if base is None else follower.guided_plates
    plates = guided(stock.bars, cam.program, cam.base_radius, cam.sense)
    carrying = [plate for plate in plates if plate.name != "roller"]
    # A roller runs in the plane of the cam, and what carries it lies under both; a face lies beside the cam.
    beside = bool(carrying) and follower.knife_edge is not None
    told = Assembling("" if base is None else "base", thick, base, base is not None, stock.motor)
    layer = told.lowest + beside
    gap = thick if base is not None and beside else 0.0
    told.shaft("A", "cam", stock, (0.0 if base is None else thick) + gap + thick, layer, gap)
    for plate in carrying:
        for words in _carried(told, plate, plates, stock, base):
            told.tell(told.lowest, words)
    if any(plate.name == "roller" for plate in plates):
        _roller(told, plates, stock, layer)
    # A tube keeps a shaft's cam over the follower; a motor's is held by the shaft.
    over = f", {gap:g} mm above base" if gap and stock.motor else ""
    told.tell(layer, seated("cam", "A" if told.lettered else "", stock) + f"{over}, as it is drawn and not turned over")
    if stock.timing_mark:
        told.tell(layer, "its line is under the follower at cam angle 0, and its arrow the way it turns")
    told.end(f"a spring or a weight of yours holds {plates[0].name if plates else 'the follower'} to cam")
    if base is None:
        told.end(_left(cam, bool(carrying), stock))
    return told.told()


def _carried(
    told: Assembling, plate: Plate, plates: tuple[Plate, ...], stock: CamStock, base: BaseStock | None
) -> Iterator[str]:
    """The follower or arm: its own pins glued in, flush where cam or base pass."""
    held = [hole for hole in plate.holes if hole.key == "pivot_bore" and hole.diameter]
    count, swings = len(held), plate.name == "arm"
    letter = LETTERS["pivot_bore"]
    if held and base is not None:
        pins = f"{count} pins {letter}" if count > 1 else f"pin {letter}"
        told.pins(letter, plate.name, stock.pivot_bore, 2 * stock.thickness, count, under=True)
        yield f"glue {pins} into {plate.name}, flush above"
    elif held:
        told.buy(plate.name, pin_bill(stock.pivot_bore, stock.thickness, count))
    carried = any(hole.key == "roller_bore" and hole.diameter for hole in plate.holes)
    if carried and any(other.name == "roller" for other in plates):
        named = LETTERS["roller_bore"] if told.lettered else "of roller"
        yield f"glue the pin {named} into {plate.name}, flush below"
    if base is None:
        yield f"lay {plate.name}" + (", its pin through it into what is to hold it" if held else "")
    elif swings:
        yield f"lay arm, its pin {letter} through base; a collar on {letter} from below, with room to turn"
    else:
        collars = f"{count} collars on {letter} from below, with room to slide"
        yield f"lay {plate.name}, its pins through the slot {letter} of base; {collars}"


def _roller(told: Assembling, plates: tuple[Plate, ...], stock: CamStock, layer: int) -> None:
    """The roller on its pin, over what carries it."""
    on = sum(any(hole.key == "roller_bore" for hole in plate.holes) for plate in plates)
    if not stock.roller_bore:
        told.tell(layer, "lay roller")
        return
    letter = LETTERS["roller_bore"]
    named = letter if told.lettered else "its pin"
    told.pins(letter, "roller", stock.roller_bore, on * stock.thickness)
    told.tell(layer, f"lay roller on {named}, where it turns freely; a collar on {named}, with room to turn")


def _left(cam: Cam, carried: bool, stock: CamStock) -> str:
    """What no plate holds where there is no base."""
    follower = cam.follower
    if follower.oscillates:
        away = abs(complex(np.ravel(follower.place(np.zeros(1), cam.base_radius).origin)[0]))
        return f"hold the pivot {away:.6g} mm from the shaft of cam: no plate here does"
    stem = "follower" if carried else "a stem with the pin of the roller" if follower.rounding else "a stem"
    shaft = "" if stock.motor else ", and hold the shaft of cam"
    return f"guide {stem}{shaft}: no plate here does"
