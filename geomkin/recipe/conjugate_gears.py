"""Recipes of gears with teeth of any form and the mates they shape."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from ..check import Check
from ..errors import DesignError
from ..gear.conjugate import Conjugate, conjugate
from ..gear.lantern import LanternPinion
from ..gear.point_tooth import PointToothGear
from ..gear.straight_sided import StraightSidedGear
from ..gear.untouched import BEYOND
from ..part import Part
from ..plane.curve import AbstractCurve
from ..shop.conjugates import LanternStock, PairStock, lantern_parts, pair_parts
from ..sizes import FARTHEST, check_sizes, entry, quantity
from ..table import Column, Table, xy_columns
from .kind import Kind
from .settings import Files
from .tooth_points import check_tooth_points

# Rows of the table: half a percent of a flank apart.
ROWS = 201


@dataclass(frozen=True)
class Mate:
    """The gear that is to run with the one given."""

    teeth: int = quantity("number of the mate's teeth", whole=True, at_least=2, at_most=10_000, example=60)
    addendum: float = quantity(
        "height of the mate's teeth beyond its pitch circle", "mm", above=0, at_most=FARTHEST, example=2
    )
    internal: bool = entry("the mate is a ring round the gear", default=False)
    clearance: float = quantity(
        "room between the gear's tips and the mate's roots", "mm", default=0.5, at_least=0, at_most=FARTHEST
    )
    backlash: float = quantity(
        "play between the teeth along the pitch circle, taken off the mate's teeth",
        "mm",
        default=0.0,
        at_least=0,
        at_most=FARTHEST,
    )

    def __post_init__(self) -> None:
        check_sizes(self)


# What `conjugate` and the cutters call them, and the keys that give them here.
KEYS = {"mate_teeth": "mate.teeth"} | {name: f"mate.{name}" for name in ("addendum", "clearance", "backlash")}


def _mate(gear: Any, teeth: int, wanted: Mate) -> Conjugate:
    if wanted.internal and wanted.teeth <= teeth:
        raise DesignError("mate.teeth", f"found {wanted.teeth} for a ring", f"give more than the gear's {teeth}")
    try:
        cutter = gear.cutter(wanted.clearance, wanted.backlash)
        return conjugate(cutter, teeth, gear.pitch_radius, wanted.teeth, wanted.addendum, wanted.internal)
    except DesignError as error:
        most = _most_backlash(gear, teeth, wanted)
        if most < wanted.backlash:
            problem = f"found {wanted.backlash:g} mm, which leaves no teeth to the mate"
            # A little less, so that the number still works when rounded.
            raise DesignError("mate.backlash", problem, f"give at most {most * (1 - 1e-5):.6g}") from None
        raise DesignError(KEYS.get(error.field, error.field), error.problem, error.remedy) from None


def _most_backlash(gear: Any, teeth: int, wanted: Mate) -> float:
    """Backlash, mm, that takes all of the mate's tips, or for which its cutter's teeth meet; inf if none is wanted."""
    if not wanted.backlash:
        return float("inf")
    mate = _mate(gear, teeth, dataclasses.replace(wanted, backlash=0.0))
    # Each side of a tooth is turned as a whole.
    return min(gear.most_backlash, mate.tip_thickness * mate.pitch_radius / mate.tip_radius)


def _kind(name: str, gear: type, about: str) -> Kind:
    """A kind of gear by its sizes; all of them shape their mates, are judged and cut alike."""
    fields: list[tuple[str, Any, Any]] = [
        ("kind", Literal[name], dataclasses.field()),  # type: ignore[valid-type]
        ("gear", gear, dataclasses.field()),
        ("mate", Mate, dataclasses.field()),
        ("stock", PairStock, entry("what the gears are cut from", default=PairStock())),
        ("files", Files, entry("what is written", default=Files())),
    ]
    shaped = cached_property(lambda recipe: _mate(recipe.gear.gear, recipe.gear.teeth, recipe.mate))
    namespace = {"__doc__": about, "shaped": shaped}
    recipe = dataclasses.make_dataclass(f"{gear.__name__}Recipe", fields, frozen=True, namespace=namespace)
    return Kind(recipe, _pair_table, _pair_checks, _pair_parts, _notes)


@dataclass(frozen=True)
class LanternRecipe:
    """A lantern pinion, round pins between two discs, and the wheel whose teeth the pins shape."""

    kind: Literal["lantern-gears"]
    pinion: LanternPinion
    # Pins stay in contact for a pitch only on long teeth.
    mate: Mate = entry("the wheel", example=Mate(48, 7.5))
    stock: LanternStock = entry("what discs and wheel are cut from", default=LanternStock())
    files: Files = entry("what is written", default=Files())

    @cached_property
    def shaped(self) -> Conjugate:
        """The wheel's teeth."""
        return _mate(self.pinion, self.pinion.pins, self.mate)

    @property
    def own_quarters(self) -> int:
        """Quarters of a pin's right-hand side that touch: the outer one, which some rings need, is not drawn out."""
        return 1 if self.mate.clearance else 2


def _pair_table(recipe: Any) -> Table:
    share = np.linspace(0, 1, ROWS)
    where = Column("flank_share", "", "place on the right-hand flank, 0 at the bottom land, 1 at the tip", share)
    return _table(where, recipe.shaped, share, recipe.mate.backlash)


def _lantern_table(recipe: LanternRecipe) -> Table:
    """The pin's right-hand side, as far as its cutter is the pin itself: the quarter drawn out touches nothing."""
    angle = np.linspace(-90, 90 * (recipe.own_quarters - 1), ROWS)
    where = Column("pin_angle", "deg", "place on the pin, -90 its innermost", angle)
    return _table(where, recipe.shaped, 1 + angle / 90, recipe.mate.backlash)


def _table(where: Column, mate: Conjugate, t: np.ndarray, backlash: float) -> Table:
    """Contact at places t of piece 0 of the mate's cutter, the turned right-hand flank of the gear.

    Both angles count from where the gear's tooth stands on +y in the very middle of the mate's space. The gear's is
    the gear's own, the same as without backlash; the mate's is half the play off the ratio, on the side on which the
    right-hand flanks touch, and so over the whole contact.
    """
    ahead = backlash * mate.teeth / (2 * mate.gear_teeth * mate.pitch_radius)
    contact = mate.contact(t)
    tooth = mate.tooth.point(t) * np.exp(1j * ahead)
    # Outside each other two gears turn against each other.
    ratio = mate.gear_teeth / mate.teeth * (1 if mate.is_ring else -1)
    return Table(
        (
            where,
            *xy_columns("tooth", "mm", "that place on the gear's tooth centred on +y", tooth),
            Column(
                "gear_angle",
                "deg",
                "gear's turn when it touches, 0 with the tooth on +y",
                np.degrees(contact.angle - ahead),
            ),
            Column(
                "mate_angle",
                "deg",
                "mate's turn then, 0 with the play shared by both sides of the tooth on +y",
                np.degrees(contact.angle) * ratio,
            ),
            *xy_columns("contact", "mm", "path of contact, gear's axis at 0, pitch point on +y", contact.place),
            *xy_columns("mate_tooth", "mm", "the same place in the mate's own frame", contact.mate),
            Column("sliding", "mm/rad", "of the gear along the mate's flank, per turn of the gear", contact.sliding),
            Column("pressure_angle", "deg", "of the common normal", np.degrees(contact.pressure_angle)),
        )
    )


def _common_checks(mate: Conjugate, module: float, pieces: int = 1, longer: str = "") -> list[Check]:
    """pieces: how many of its cutter's, from the first on, are the driving side of the gear's tooth."""
    ratio, thickness = mate.contact_ratio(0.0, pieces), mate.tip_thickness / module
    thinner = "give a smaller mate.addendum or mate.backlash"
    return [
        Check("contact ratio", ratio, "at least", 1, "", f"give longer teeth, or more of them{longer}"),
        Check("mate's tip thickness", thickness, "at least", 0.2, "modules", thinner),
    ]


def _pair_checks(recipe: Any) -> list[Check]:
    lost = sum(u.outer_radius - u.inner_radius for u in recipe.shaped.untouched if u.start < 1 and u.why != BEYOND)
    advice = "the mate is undercut: give it more teeth, or the gear's flanks less height or more lean"
    return [
        Check("flank that cannot touch", lost / recipe.gear.module, "at most", 0, "modules", advice),
        *_common_checks(recipe.shaped, recipe.gear.module),
    ]


def _pair_parts(recipe: Any) -> list[Part]:
    _check_points(recipe, [recipe.gear.outline])
    return pair_parts(recipe.gear.gear, recipe.shaped, recipe.stock)


def _check_points(recipe: Any, gears: list[AbstractCurve]) -> None:
    """Whether the teeth of gears and their mate can be drawn in time."""
    mate = [recipe.shaped.outline]
    check_tooth_points(recipe.files, gears if recipe.shaped.is_ring else gears + mate, mate * recipe.shaped.is_ring)


def _lantern_checks(recipe: LanternRecipe) -> list[Check]:
    longer = ", or mate.clearance = 0" if recipe.mate.internal and recipe.mate.clearance else ""
    return _common_checks(recipe.shaped, recipe.pinion.module, recipe.own_quarters, longer)


def _lantern_parts(recipe: LanternRecipe) -> list[Part]:
    _check_points(recipe, [])
    return lantern_parts(recipe.pinion, recipe.shaped, recipe.stock)


def _notes(recipe: Any) -> dict[str, Any]:
    """Sizes that follow, and the places of the tooth that never touch, by their distance from the gear's axis."""
    mate = recipe.shaped
    return {
        "centre_distance_mm": float(f"{mate.distance:.10g}"),
        "never_touching": [
            {
                "inner_radius_mm": float(f"{u.inner_radius:.7g}"),
                "outer_radius_mm": float(f"{u.outer_radius:.7g}"),
                "why": u.why,
            }
            for u in mate.untouched
            # The other side of the tooth is alike.
            if u.start < 1
        ],
    }


KINDS = {
    name: _kind(name, gear, f"A gear with {teeth} and the mate that they shape, outside it or as a ring around it.")
    for name, gear, teeth in (
        ("straight-sided-gears", StraightSidedGear, "straight-sided teeth"),
        ("point-tooth-gears", PointToothGear, "teeth through given points"),
    )
} | {"lantern-gears": Kind(LanternRecipe, _lantern_table, _lantern_checks, _lantern_parts, _notes)}
