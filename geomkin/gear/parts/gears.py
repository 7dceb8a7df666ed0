"""Plates of gears: wheels with their spokes, rings and racks, and what holds them at their distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from ...core.arguments import Count, Positive, checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity
from ...core.records import record
from ...making.fits import AbstractBored
from ...model.part import HoleFit, Part, Twist
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, Polyline, rounded_hull
from ..contract import AbstractGear
from ..helix import Helix


@record(checked=True)
class Web:
    """Openings between the hub and the rim, one between each two spokes; a spoke stands on +y."""

    hub: float = quantity("diameter of the hub", "mm", above=0, at_most=FARTHEST, example=16)
    rim: float = quantity("thickness of the rim under the teeth", "mm", above=0, at_most=FARTHEST, example=4)
    form: Literal["spokes", "holes"] = entry("openings that leave straight spokes, or round holes", default="spokes")
    count: int = quantity("number of openings", whole=True, default=5, at_least=2, at_most=100)
    spoke_width: float = quantity(
        "width of the spokes, or least width between holes", "mm", default=4.0, at_least=0.01, at_most=FARTHEST
    )


@record
class GearStock(AbstractBored):
    """What a gear is cut from, and how it sits on its shaft."""

    web: Web | None = entry("openings between hub and rim; left out, none", default=None)

    def rim_under(self, gear: AbstractGear) -> float:
        """What holds a gear's teeth: the thickness under them, mm."""
        if gear.solid_rim is None:
            raise DesignError("stock", "found that of a wheel for a ring", "give a RingStock")
        if not gear.hole_room:
            return gear.solid_rim
        return gear.solid_rim - self.hole_reach if self.web is None else self.web.rim

    def holes(self, gear: AbstractGear, key: str) -> tuple[AbstractCurve, ...]:
        """Bore and openings of a gear; none in a rack. key: of the stock in a recipe, for refusals."""
        if not gear.hole_room:
            return ()
        # Flat or keyway stand under the tooth on +y, so that the gear is put on its shaft with that tooth known.
        hole = self.hole(1j, gear.hole_room, key)
        cut = openings(self.web, self.hole_reach if hole else 0.0, gear.root_radius, f"{key}.web")
        return (*hole, *cut)

    def hole_fits(self, gear: AbstractGear) -> tuple[HoleFit, ...]:
        """Of the bore, which is the first of the holes; none in a rack."""
        return self.fits if gear.hole_room else ()


@record(checked=True)
class RingStock:
    """What a ring gear is cut from."""

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    rim: float = quantity("thickness of the ring outside its teeth", "mm", default=8.0, at_least=0.1, at_most=FARTHEST)

    def rim_under(self, gear: AbstractGear) -> float:
        """What holds a ring's teeth: the thickness outside them, mm."""
        return self.rim

    def holes(self, gear: AbstractGear, key: str) -> tuple[AbstractCurve, ...]:
        """None besides the teeth."""
        if not gear.is_ring:
            raise DesignError(key, "found that of a ring for a wheel", "give a GearStock")
        return ()

    def hole_fits(self, gear: AbstractGear) -> tuple[HoleFit, ...]:
        """None."""
        return ()


@checked
def gear_parts(
    gear: AbstractGear,
    stock: GearStock | RingStock,
    name: str = "gear",
    key: str = "stock",
    count: Count = 1,
    helix: Helix = Helix(),
) -> tuple[Part, ...]:
    """The plate of any gear about its axis, or of a rack, teeth up.

    stock: a RingStock for a ring, a GearStock for all else. key: of the stock in a recipe, for refusals; count: how
    many to make. helix: on which the teeth lie along the face, which is as wide as the stock is thick; bore, keyway and
    web go straight through. Raises DesignError where bore, keyway or web leave no plate.
    """
    plate = plate_of(gear, name, stock.holes(gear, key), stock.thickness, stock.rim_under(gear), count)
    return (replace(plate, fits=stock.hole_fits(gear), twist=_twist(gear, helix, stock.thickness)),)


def _twist(gear: AbstractGear, helix: Helix, face_width: float) -> Twist | None:
    """How the section of a gear turns, or that of a rack slides; None for straight teeth."""
    if helix.helix_angle_deg == 0:
        return None
    advance = helix.advance(face_width)
    if np.isinf(gear.pitch_radius):
        return Twist(0.0, advance, helix.herringbone)
    return Twist(advance / gear.pitch_radius, 0.0, helix.herringbone, "holes" if gear.is_ring else "outline")


def plate_of(
    gear: AbstractGear, name: str, holes: tuple[AbstractCurve, ...], thickness: float, rim: float, count: int = 1
) -> Part:
    """A gear with holes, or a round plate with a ring's teeth as its hole and `rim`, mm, outside them."""
    if gear.is_ring:
        return Part(name, Circle(0j, gear.root_radius + rim), (gear.outline,), thickness, count=count, body=name)
    return Part(name, gear.outline, holes, thickness, count=count, body=name)


@checked
def base_plate(
    name: str,
    axes: Sequence[complex],
    holes: Sequence[float],
    margin: Positive,
    thickness: Positive,
    keys: tuple[str, str] = ("stock.bore", "stock.bore"),
) -> Part:
    """A plate with a hole of a diameter for each of two axes, mm; it reaches `margin` beyond the widest hole.

    keys: of the two shafts in a recipe, for refusals.
    """
    for field, given in (("axes", axes), ("holes", holes)):
        if len(given) != 2:
            raise DesignError(field, f"found {len(given)}", "give two")
    apart = abs(axes[0] - axes[1])
    if apart <= (holes[0] + holes[1]) / 2:
        raise DesignError(
            keys[int(holes[1] > holes[0])],
            f"the holes of two shafts, {holes[0]:g} and {holes[1]:g} mm wide and {apart:.6g} mm apart, "
            "meet in the plate",
            f"give bores and clearances of less than {2 * apart:.6g} mm together",
        )
    circles = tuple(Circle(z, d / 2) for z, d in zip(axes, holes) if d)
    return Part(name, rounded_hull(axes, max(holes) / 2 + margin), circles, thickness, body="ground")


def openings(web: Web | None, bore: float, root_radius: float, key: str) -> tuple[AbstractCurve, ...]:
    """The openings of a wheel about the origin, whose hole and keyway stay within `bore`, mm, of the axis.

    root_radius: of the bottom of the teeth, mm. Raises DesignError, of sizes named `key`.hub and so on, where the
    openings run into each other, the hole or the teeth.
    """
    if web is None:
        return ()
    inner, outer = web.hub / 2, root_radius - web.rim
    if inner <= bore:
        raise DesignError(
            f"{key}.hub",
            f"found {web.hub:g} mm around a hole of {2 * bore:.4g} mm",
            f"give more than {2 * bore:.4g} mm",
        )
    if outer <= inner:
        most = root_radius - inner
        raise DesignError(
            f"{key}.rim",
            f"found {web.rim:g} mm, which leaves no room between hub and rim",
            f"give less than {most:.4g} mm" if most > 0 else "give a smaller hub",
        )
    opening = _window(web, inner, outer, key) if web.form == "spokes" else _hole(web, inner, outer, key)
    places = 1j * np.exp(2j * np.pi * (np.arange(web.count) + 0.5) / web.count)
    if isinstance(opening, Circle):
        return tuple(Circle(complex(opening.centre * place), opening.radius) for place in places)
    return tuple(Polyline(opening.vertices * place, opening.bulges) for place in places)


def _hole(web: Web, inner: float, outer: float, key: str) -> Circle:
    """The round hole on +x that fills the room between hub and rim."""
    middle, radius = (inner + outer) / 2, (outer - inner) / 2
    between = 2 * middle * float(np.sin(np.pi / web.count)) - 2 * radius
    if between < web.spoke_width:
        raise DesignError(
            f"{key}.count",
            f"found {web.count} holes of {2 * radius:.4g} mm with {between:.4g} mm between them",
            "give fewer holes, a thicker rim or hub, or a smaller spoke_width",
        )
    return Circle(complex(middle), radius)


def _window(web: Web, inner: float, outer: float, key: str) -> Polyline:
    """The opening on +x between two spokes, its corners rounded."""
    half, beside = np.pi / web.count, web.spoke_width / 2
    # Rounded as far as looks well on most wheels: half a spoke, but no more than leaves straight sides.
    corner = min(beside, (outer - inner) / 5)
    ray = np.exp(1j * half)
    # Along the spoke's axis, where the roundings' centres stand; the window lies to the right of it.
    places = [np.sqrt(max(r**2 - (beside + corner) ** 2, 0.0)) for r in (outer - corner, inner + corner)]
    centres = [(s - 1j * (beside + corner)) * ray for s in places]
    high, low = (float(np.angle(c)) for c in centres)
    if places[1] == 0 or low <= 0 or high <= 0:
        raise DesignError(
            f"{key}.spoke_width",
            f"found {web.spoke_width:g} mm: {web.count} spokes meet outside the hub",
            "give fewer or narrower spokes, or a larger hub",
        )
    upper = np.array([outer * np.exp(1j * high), *((s - 1j * beside) * ray for s in places), inner * np.exp(1j * low)])
    turns = np.array([np.pi / 2 + half - high, 0.0, np.pi / 2 + low - half])
    sweeps = np.concatenate([turns, [-2 * low], turns[::-1], [2 * high]])
    return Polyline(np.concatenate([upper, np.conj(upper)[::-1]]), np.tan(sweeps / 4))
