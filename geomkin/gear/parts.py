"""Plates of gears: wheels with spokes, rings, racks, mates of any form, and the bar that holds two shafts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields, replace
from itertools import combinations
from typing import Literal

import numpy as np

from ..core.arguments import PositiveFloat, PositiveInt, checked
from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, inside, quantity, to_digits
from ..core.records import record
from ..core.units import marked, mm
from ..making.attachments import Attachment, attached_holes, attachments_entry, hub_thickness
from ..making.bores import (
    AbstractBored,
    BoreForm,
    bore_form_entry,
    bore_tolerance,
    clearance,
    fit_entry,
    fits_of,
    flat_across,
    keyway_depth,
    keyway_width,
    shaft,
)
from ..making.materials import MaterialKey, material_entry
from ..model.part import Fit, HoleFit, HoleTolerance, Part, Twist
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle, Polyline, rounded_hull
from .conjugate.conjugate import Conjugate
from .conjugate.shaping_gears import LanternPinion
from .contract import AbstractGear, Helix


@record(checked=True)
class Web:
    """Openings of a wheel between hub and rim. One spoke is centred on +y.

    Parameters
    ----------
    hub : float
        Diameter of the hub, mm, above 0.
    rim : float
        Thickness of the rim under the teeth, mm, above 0.
    form : {"spokes", "holes"}, optional
        Openings that leave straight spokes, or round holes.
    count : int, optional
        Number of openings, 2 to 100.
    spoke_width : float, optional
        Width of the spokes, or least width between holes, mm.
    """

    hub: float = quantity("diameter of the hub", "mm", above=0, at_most=FARTHEST, example=16)
    rim: float = quantity("thickness of the rim under the teeth", "mm", above=0, at_most=FARTHEST, example=4)
    form: Literal["spokes", "holes"] = entry("openings that leave straight spokes, or round holes", default="spokes")
    count: int = quantity("number of openings", whole=True, default=5, at_least=2, at_most=100)
    spoke_width: float = quantity(
        "width of the spokes, or least width between holes", "mm", default=4.0, at_least=0.01, at_most=FARTHEST
    )


@record
class GearStock(AbstractBored):
    """Sheet, bore and openings of a gear; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of the sheet, and bore of the shaft, mm.
    web : Web, optional
        Openings between hub and rim; none if omitted.
    attachments : tuple of Attachment, optional
        What the gear drives, screwed to it about its axis.
    """

    web: Web | None = entry("openings between hub and rim; none if omitted", default=None)
    attachments: tuple[Attachment, ...] = attachments_entry("the gear")

    @property
    def hub_length(self) -> float:
        return hub_thickness(self.attachments)

    def rim_under(self, gear: AbstractGear) -> float:
        """Thickness of the material under the teeth of a gear, mm."""
        if gear.solid_rim is None:
            raise DesignError("stock", "found the stock of a wheel for a ring", "give a RingStock", "wrong-type")
        if not gear.hole_room:
            return gear.solid_rim
        return gear.solid_rim - self.hole_reach if self.web is None else self.web.rim

    def holes(self, gear: AbstractGear, key: str) -> tuple[AbstractCurve, ...]:
        """Bore and openings of a gear; empty for a rack. key: of the stock in the recipe, for messages."""
        if not gear.hole_room:
            return ()
        # The flat or keyway is under the tooth on +y, which marks that tooth during assembly.
        hole = self.hole(1j, gear.hole_room, key)
        cut = openings(self.web, self.hole_reach if hole else 0.0, gear.root_radius, f"{key}.web")
        if self.web and self.attachments:
            problem = "is given, and its openings may meet the holes of attachments"
            raise DesignError(f"{key}.web", problem, "omit it, or the attachments", "conflict")
        room = self.hole_reach if hole else 0.0, gear.root_radius
        return (*hole, *holes_about_axis(self.attachments, self.clearance, room, key), *cut)

    def hole_fits(self, gear: AbstractGear) -> tuple[HoleFit, ...]:
        """The fit of the bore, the first of the holes; empty for a rack."""
        return (*self.fits, *fits_about_axis(self.attachments, self.clearance)) if gear.hole_room else ()


def holes_about_axis(
    attachments: Sequence[Attachment], clearance: float, room: tuple[float, float], key: str
) -> tuple[Circle, ...]:
    """Holes of the attachments of a gear; DesignError if they leave their room, or meet.

    room: inner and outer radius, mm; the inner one is 0 if nothing is there. key: of the stock in the recipe.
    """
    holes, (least, most) = attached_holes(((item, 0j) for item in attachments), clearance), room
    for k, item in enumerate(attachments):
        item.check(0j, clearance, f"{key}.attachments[{k}]")
    for hole in holes:
        inner, outer = abs(hole.centre) - hole.radius, abs(hole.centre) + hole.radius
        if outer >= most or (least and inner <= least):
            reach = f"from {mm(max(inner, 0.0), outer, between=' to '):.4g} from the axis"
            remedy = f"give holes between {mm(least, most, between=' and '):.4g}"
            raise DesignError(f"{key}.attachments", f"found a hole {reach}", remedy)
    for one, two in combinations(holes, 2):
        if abs(one.centre - two.centre) <= one.radius + two.radius:
            raise DesignError(f"{key}.attachments", "two holes meet", "give them other places")
    return holes


def fits_about_axis(attachments: Sequence[Attachment], clearance: float) -> tuple[HoleFit, ...]:
    """The fit of each of these holes."""
    return tuple(fit for item in attachments for _, fit in item.openings(0j, clearance))


@record(checked=True)
class RingStock:
    """Sheet and rim of a ring gear; all lengths in mm.

    Parameters
    ----------
    thickness : float, optional
        Thickness of the sheet, mm.
    rim : float, optional
        Thickness of the ring outside its teeth, mm.
    clearance : float, optional
        How much wider the holes of attachments are than their screws, mm.
    material : Material, optional
        Material of the ring.
    attachments : tuple of Attachment, optional
        What is screwed to the ring, outside its teeth.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    rim: float = quantity("thickness of the ring outside its teeth", "mm", default=8.0, at_least=0.1, at_most=FARTHEST)
    clearance: float = clearance(0.0)
    material: MaterialKey | None = material_entry("the ring")
    attachments: tuple[Attachment, ...] = attachments_entry("the ring")

    @property
    def has_fits(self) -> bool:
        """Whether its clearance counts."""
        return bool(self.attachments)

    def rim_under(self, gear: AbstractGear) -> float:
        """Thickness of the material outside the teeth, mm."""
        return self.rim

    def holes(self, gear: AbstractGear, key: str) -> tuple[AbstractCurve, ...]:
        """The holes of attachments. key: of the stock in the recipe, for messages."""
        if not gear.is_ring:
            raise DesignError(key, "found the stock of a ring for a wheel", "give a GearStock", "wrong-type")
        room = gear.root_radius, gear.root_radius + self.rim
        return holes_about_axis(self.attachments, self.clearance, room, key)

    def hole_fits(self, gear: AbstractGear) -> tuple[HoleFit, ...]:
        """The fits of these holes, which come before the teeth."""
        return fits_about_axis(self.attachments, self.clearance)


@checked
def gear_parts(
    gear: AbstractGear,
    stock: GearStock | RingStock,
    name: str = "gear",
    key: str = "stock",
    count: PositiveInt = 1,
    helix: Helix = Helix(),
) -> tuple[Part, ...]:
    """The plate of a gear about its axis, or of a rack with its teeth up.

    Parameters
    ----------
    gear : AbstractGear
        A gear, a ring or a rack.
    stock : GearStock or RingStock
        A RingStock for a ring, otherwise a GearStock.
    name : str, optional
        Name of the part.
    key : str, optional
        Key of the stock in the recipe, for messages.
    count : int, optional
        Number of copies to make.
    helix : Helix, optional
        Helix of the teeth. The face is as wide as the sheet is thick; bore, keyway and web are straight.

    Returns
    -------
    tuple of Part
        One part.

    Raises
    ------
    DesignError
        If bore, keyway or web do not fit into the plate.

    Examples
    --------
    >>> (part,) = gk.gear.gear_parts(gk.SpurGear(24, 2), gk.gear.GearStock(bore=8))
    >>> part.name, part.thickness
    ('gear', 6.0)
    """
    plate = plate_of(gear, name, stock.holes(gear, key), stock.thickness, stock.rim_under(gear), count)
    twist = _twist(gear, helix, stock.thickness)
    if twist and gear.is_ring and stock.attachments:
        problem = "is given for a ring with a helix, whose holes are twisted with its teeth"
        raise DesignError(f"{key}.attachments", problem, "omit it, or give straight teeth", "conflict")
    return (replace(plate, fits=stock.hole_fits(gear), twist=twist, material=stock.material),)


def _twist(gear: AbstractGear, helix: Helix, face_width: float) -> Twist | None:
    """The twist of a gear's section, or the shift of a rack's; None for straight teeth."""
    if helix.helix_angle_deg == 0:
        return None
    advance = helix.advance(face_width)
    if np.isinf(gear.pitch_radius):
        return Twist(0.0, advance, helix.herringbone)
    return Twist(advance / gear.pitch_radius, 0.0, helix.herringbone, "holes" if gear.is_ring else "outline")


def plate_of(
    gear: AbstractGear, name: str, holes: tuple[AbstractCurve, ...], thickness: float, rim: float, count: int = 1
) -> Part:
    """A gear with holes; for a ring, a round plate with the teeth as its last hole and a rim of a width, mm."""
    if gear.is_ring:
        return Part(name, Circle(0j, gear.root_radius + rim), (*holes, gear.outline), thickness, count=count, body=name)
    return Part(name, gear.outline, holes, thickness, count=count, body=name)


@checked
def base_plate(
    name: str,
    axes: Sequence[complex],
    holes: Sequence[float],
    margin: PositiveFloat,
    thickness: PositiveFloat,
    keys: tuple[str, str] = ("stock.bore", "stock.bore"),
) -> Part:
    """A plate with one hole for each of two axes.

    Parameters
    ----------
    name : str
        Name of the part.
    axes : sequence of complex, length 2
        Points of the axes, mm.
    holes : sequence of float, length 2
        Diameters of the holes, mm; 0 for no hole.
    margin : float
        Width of the plate outside the widest hole, mm, above 0.
    thickness : float
        Thickness of the plate, mm, above 0.
    keys : tuple of str, optional
        Keys of the two shafts in the recipe, for messages.

    Returns
    -------
    Part
        The plate, of the body "ground".

    Raises
    ------
    DesignError
        If the two holes meet.
    """
    for field, given in (("axes", axes), ("holes", holes)):
        if len(given) != 2:
            raise DesignError(field, f"found {len(given)}", "give two", "wrong-type")
    apart = abs(axes[0] - axes[1])
    if apart <= (holes[0] + holes[1]) / 2:
        raise DesignError(
            keys[int(holes[1] > holes[0])],
            f"the holes of two shafts, {mm(*holes, between=' and '):g} wide and {mm(apart):.6g} apart, "
            "meet in the plate",
            f"give bores and clearances of less than {mm(2 * apart):down} together",
        )
    circles = tuple(Circle(z, d / 2) for z, d in zip(axes, holes) if d)
    return Part(name, rounded_hull(axes, max(holes) / 2 + margin), circles, thickness, body="ground")


def openings(web: Web | None, bore: float, root_radius: float, key: str) -> tuple[AbstractCurve, ...]:
    """The openings of a wheel about the origin. bore: radius that contains its hole and keyway, mm.

    Raises DesignError if the openings meet each other, the hole or the teeth; its field begins with `key`.
    """
    if web is None:
        return ()
    inner, outer = web.hub / 2, root_radius - web.rim
    if inner <= bore:
        problem = f"found {mm(web.hub):g} for a hole of {mm(2 * bore):.4g}"
        raise DesignError(f"{key}.hub", problem, f"give more than {mm(2 * bore):up}", value=inside(2 * bore, -1))
    if outer <= inner:
        most = root_radius - inner
        problem = f"found {mm(web.rim):g}, which leaves no room between hub and rim"
        remedy = f"give less than {mm(to_digits(most, 12)):down}" if most > 0 else "give a smaller hub"
        raise DesignError(f"{key}.rim", problem, remedy, value=inside(most, 1) if most > 0 else None)
    opening = _window(web, inner, outer, key) if web.form == "spokes" else _hole(web, inner, outer, key)
    places = 1j * np.exp(2j * np.pi * (np.arange(web.count) + 0.5) / web.count)
    if isinstance(opening, Circle):
        return tuple(Circle(complex(opening.centre * place), opening.radius) for place in places)
    return tuple(Polyline(opening.vertices * place, opening.bulges) for place in places)


def _hole(web: Web, inner: float, outer: float, key: str) -> Circle:
    """The round hole on +x between hub and rim."""
    middle, radius = (inner + outer) / 2, (outer - inner) / 2
    between = 2 * middle * float(np.sin(np.pi / web.count)) - 2 * radius
    if between < web.spoke_width:
        problem = f"found {web.count} holes of {mm(2 * radius):.4g} with {mm(between):.4g} between them"
        raise DesignError(f"{key}.count", problem, "give fewer holes, a thicker rim or hub, or a smaller spoke_width")
    return Circle(complex(middle), radius)


def _window(web: Web, inner: float, outer: float, key: str) -> Polyline:
    """The opening on +x between two spokes, with rounded corners."""
    half, half_spoke = np.pi / web.count, web.spoke_width / 2
    # The corner radius suits most wheels: half a spoke, but small enough to leave straight sides.
    corner = min(half_spoke, (outer - inner) / 5)
    ray = np.exp(1j * half)
    # Positions of the corners' centres along the spoke's axis; the opening is to the right of the spoke.
    along = [np.sqrt(max(r**2 - (half_spoke + corner) ** 2, 0.0)) for r in (outer - corner, inner + corner)]
    centres = [(s - 1j * (half_spoke + corner)) * ray for s in along]
    high, low = (float(np.angle(c)) for c in centres)
    if along[1] == 0 or low <= 0 or high <= 0:
        problem = f"found {mm(web.spoke_width):g}: {web.count} spokes meet outside the hub"
        raise DesignError(f"{key}.spoke_width", problem, "give fewer or narrower spokes, or a larger hub")
    sides = [(s - 1j * half_spoke) * ray for s in along]
    upper = np.array([outer * np.exp(1j * high), *sides, inner * np.exp(1j * low)])
    upper_sweeps = np.array([np.pi / 2 + half - high, 0.0, np.pi / 2 + low - half])
    sweeps = np.concatenate([upper_sweeps, [-2 * low], upper_sweeps[::-1], [2 * high]])
    return Polyline(np.concatenate([upper, np.conj(upper)[::-1]]), np.tan(sweeps / 4))


# Keys of a bore for which the mate has its own key, with the prefix mate_.
BORE_KEYS = re.compile(r"\b(bore_form|bore|keyway_width|keyway_depth|flat|attachments)\b")


@record
class AbstractMated(AbstractBored):
    """Base class of stock tables of a gear and its mate; all lengths in mm.

    Clearance, interference and thickness apply to both gears. A ring has no bore. A motor drives the gear.
    """

    bore: float = shaft("the gear's shaft", 8.0, fitted=True)
    mate_bore: float = shaft("the mate's shaft", 8.0, fitted=True)
    mate_bore_form: BoreForm = bore_form_entry("the mate's bore")
    mate_flat: float | None = flat_across()
    mate_keyway_width: float = keyway_width("the mate's bore")
    mate_keyway_depth: float = keyway_depth("the mate's bore")
    mate_fit: Fit = fit_entry("the mate's bore")
    mate_bore_tolerance: HoleTolerance = bore_tolerance("the mate's bore")
    mate_attachments: tuple[Attachment, ...] = attachments_entry("the mate")
    rim: float = quantity("width of a ring outside its teeth", "mm", default=8.0, at_least=0.1, at_most=FARTHEST)

    def __post_init__(self) -> None:
        super().__post_init__()
        with _of_mate():
            _ = self.mate

    @property
    def mate(self) -> GearStock:
        """The stock of the mate as a single gear."""
        return GearStock(
            thickness=self.thickness,
            bore=self.mate_bore,
            bore_form=self.mate_bore_form,
            flat=self.mate_flat,
            keyway_width=self.mate_keyway_width,
            keyway_depth=self.mate_keyway_depth,
            fit=self.mate_fit,
            bore_tolerance=self.mate_bore_tolerance,
            interference=self.interference,
            clearance=self.clearance,
            material=self.material,
            attachments=self.mate_attachments,
        )

    @property
    def ring(self) -> RingStock:
        """The stock of a mate that is a ring."""
        return RingStock(self.thickness, self.rim, self.clearance, self.material, self.mate_attachments)


@contextmanager
def _of_mate() -> Iterator[None]:
    """Translate the keys in a DesignError of a bore to those of the mate."""
    try:
        yield
    except DesignError as error:
        table, dot, name = error.field.rpartition(".")
        field, remedy = BORE_KEYS.sub(r"mate_\1", name), BORE_KEYS.sub(r"mate_\1", marked(error.remedy))
        problem = marked(error.problem).replace("bore_form", "mate_bore_form")
        raise DesignError(f"{table}{dot}{field}", problem, remedy, error.id) from None


@record
class PairStock(AbstractMated):
    """Sheet and bores of a gear and its mate; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of both sheets, and bore of the gear, mm.
    mate_bore, mate_bore_form, mate_flat, mate_keyway_width, mate_keyway_depth, mate_fit, mate_bore_tolerance : optional
        Bore of the mate, mm.
    mate_attachments, attachments : tuple of Attachment, optional
        What is screwed to the mate, and to the gear.
    rim : float, optional
        Width outside the teeth of a ring, mm.
    """

    attachments: tuple[Attachment, ...] = attachments_entry("the gear")

    @property
    def gear(self) -> GearStock:
        """The stock of the gear alone."""
        bored = {field.name: getattr(self, field.name) for field in fields(AbstractBored)}
        return GearStock(**bored, attachments=self.attachments)


@record
class LanternStock(AbstractMated):
    """Sheet and bores of a lantern pinion's discs and of its wheel, the mate; all lengths in mm. The pins are rods.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of all sheets, and bore of the discs, mm.
    mate_bore, mate_bore_form, mate_flat, mate_keyway_width, mate_keyway_depth, mate_fit, mate_bore_tolerance : optional
        Bore of the wheel, mm.
    mate_attachments : tuple of Attachment, optional
        What is screwed to the wheel.
    rim : float, optional
        Width outside the teeth of a ring, mm.
    edge : float, optional
        Width of a disc outside its pins, mm.
    """

    bore: float = shaft("the pinion's shaft", 8.0, fitted=True)
    clearance: float = clearance(0.1)
    edge: float = quantity("width of a disc outside its pins", "mm", default=4.0, at_least=0.01, at_most=FARTHEST)


@checked
def pair_parts(gear: AbstractGear, mate: Conjugate, stock: PairStock) -> tuple[Part, ...]:
    """The plates of a gear and of the mate that it generates.

    Parameters
    ----------
    gear : AbstractGear
        The gear.
    mate : Conjugate
        The result of `conjugate`.
    stock : PairStock
        Sheet and bores.

    Returns
    -------
    tuple of Part
        The gear and the mate, each about its own axis. The flat or keyway of a bore is towards +y.

    Raises
    ------
    DesignError
        If a bore does not fit.
    """
    return (*gear_parts(gear, stock.ring if gear.is_ring else stock.gear), _mate(mate, stock))


@checked
def lantern_parts(pinion: LanternPinion, mate: Conjugate, stock: LanternStock) -> tuple[Part, ...]:
    """The plates of a lantern pinion and of its wheel.

    Parameters
    ----------
    pinion : LanternPinion
        The pinion.
    mate : Conjugate
        Its wheel, the result of `conjugate`.
    stock : LanternStock
        Sheet and bores.

    Returns
    -------
    tuple of Part
        The disc, to be made twice, with holes for the pins, and the wheel. The flat or keyway of the disc's bore is
        towards a pin, that of the wheel's towards +y.

    Raises
    ------
    DesignError
        If the holes of the pins meet, or a bore does not fit.
    """
    hole = pinion.pin_diameter / 2 + stock.clearance / 2
    apart = abs(pinion.circles[1].centre - pinion.circles[0].centre) - 2 * hole
    if apart <= 0:
        most = to_digits(stock.clearance + apart, 12)
        problem = f"found {mm(stock.clearance):g}, with which the pins' holes meet"
        remedy = f"give less than {mm(most):down}, or thinner pins" if most > 0 else "give thinner pins"
        raise DesignError("stock.clearance", problem, remedy, value=inside(most, 1) if most > 0 else None)
    pins = tuple(Circle(c.centre, hole) for c in pinion.circles)
    first = pinion.circles[0].centre
    middle = stock.hole(first / abs(first), 2 * (pinion.pitch_radius - hole), "stock")
    outer = Circle(0j, pinion.pitch_radius + pinion.pin_diameter / 2 + stock.clearance / 2 + stock.edge)
    fits = (*stock.fits, *(len(pins) * fits_of(pinion.pin_diameter, stock.clearance)))
    holes = (*middle, *pins)
    disc = Part("disc", outer, holes, stock.thickness, count=2, body="pinion", fits=fits, material=stock.material)
    return disc, _mate(mate, stock)


def _mate(mate: Conjugate, stock: PairStock | LanternStock) -> Part:
    with _of_mate():
        own: GearStock | RingStock = stock.ring if mate.is_ring else stock.mate
        return gear_parts(mate, own, "ring" if mate.is_ring else "mate")[0]
