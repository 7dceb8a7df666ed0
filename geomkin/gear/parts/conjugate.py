"""Stock of a gear and the mate that it shapes: the bores of both, each with its own fit and form."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, quantity
from ...core.records import record
from ...making.bores import clearance, fits_of, shaft
from ...making.fits import AbstractBored, BoreForm, Fit, fit, flat_across, form, keyway_depth, keyway_width
from ...model.part import Part
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle
from ..conjugate.conjugate import Conjugate
from ..conjugate.shaping_gears import LanternPinion
from ..contract import AbstractGear
from .gears import plate_of

# Keys of a bore that the mate has, too, under names of its own.
OWN = re.compile(r"\b(bore_form|bore|keyway_width|keyway_depth|flat)\b")


@record
class AbstractMated(AbstractBored):
    """What stock tables of a gear and its mate have in common; all lengths in mm.

    Clearance, interference and thickness are those of both; a ring has no bore. A motor turns the gear.
    """

    bore: float = shaft("the gear's shaft", 8.0, fitted=True)
    mate_bore: float = shaft("the mate's shaft", 8.0, fitted=True)
    mate_bore_form: BoreForm = form("the mate's bore")
    mate_flat: float | None = flat_across()
    mate_keyway_width: float = keyway_width("the mate's bore")
    mate_keyway_depth: float = keyway_depth("the mate's bore")
    mate_fit: Fit = fit("the mate's bore")
    rim: float = quantity("width of a ring outside its teeth", "mm", default=8.0, at_least=0.01, at_most=FARTHEST)

    def __post_init__(self) -> None:
        super().__post_init__()
        with _of_mate():
            _ = self.mate

    @property
    def mate(self) -> AbstractBored:
        """The same of the mate, as that of a gear by itself."""
        return AbstractBored(
            thickness=self.thickness,
            bore=self.mate_bore,
            bore_form=self.mate_bore_form,
            flat=self.mate_flat,
            keyway_width=self.mate_keyway_width,
            keyway_depth=self.mate_keyway_depth,
            fit=self.mate_fit,
            interference=self.interference,
            clearance=self.clearance,
        )

    def mate_hole(self, towards: complex, widest: float, key: str) -> tuple[AbstractCurve, ...]:
        """The mate's bore about its axis, as `hole` is the gear's."""
        with _of_mate():
            return self.mate.hole(towards, widest, key)


@contextmanager
def _of_mate() -> Iterator[None]:
    """Refusals of a bore, by the names that its keys have for the mate."""
    try:
        yield
    except DesignError as error:
        table, dot, name = error.field.rpartition(".")
        field, remedy = OWN.sub(r"mate_\1", name), OWN.sub(r"mate_\1", error.remedy)
        problem = error.problem.replace("bore_form", "mate_bore_form")
        raise DesignError(f"{table}{dot}{field}", problem, remedy, error.id) from None


@record
class PairStock(AbstractMated):
    """What a gear and its mate are cut from, and how they sit on their shafts."""


@record
class LanternStock(AbstractMated):
    """What a lantern pinion's discs and its wheel are cut from, and how they sit on their shafts; the pins are rods.

    The wheel is the pinion's mate.
    """

    bore: float = shaft("the pinion's shaft", 8.0, fitted=True)
    clearance: float = clearance(0.1)
    edge: float = quantity("width of a disc outside its pins", "mm", default=4.0, at_least=0.01, at_most=FARTHEST)


@checked
def pair_parts(gear: AbstractGear, mate: Conjugate, stock: PairStock) -> tuple[Part, ...]:
    """The gear and the mate that it has shaped, each about its own axis; flat or keyway of a bore lie towards +y."""
    holes = stock.hole(1j, gear.hole_room, "stock")
    plate = plate_of(gear, "gear", holes, stock.thickness, stock.rim)
    return replace(plate, fits=() if gear.is_ring else stock.fits), _mate(mate, stock)


@checked
def lantern_parts(pinion: LanternPinion, mate: Conjugate, stock: LanternStock) -> tuple[Part, ...]:
    """The pinion's two discs with holes for its pins, and the wheel.

    Flat or keyway of the discs' bores lie towards a pin, that of the wheel's towards +y.
    """
    hole = pinion.pin_diameter / 2 + stock.clearance / 2
    apart = abs(pinion.circles[1].centre - pinion.circles[0].centre) - 2 * hole
    if apart <= 0:
        raise DesignError(
            "stock.clearance",
            f"found {stock.clearance:g} mm, with which the pins' holes run into each other",
            f"give less than {stock.clearance + apart:.4g} mm, or thinner pins",
        )
    pins = tuple(Circle(c.centre, hole) for c in pinion.circles)
    first = pinion.circles[0].centre
    middle = stock.hole(first / abs(first), 2 * (pinion.pitch_radius - hole), "stock")
    outer = Circle(0j, pinion.pitch_radius + pinion.pin_diameter / 2 + stock.clearance / 2 + stock.edge)
    fits = (*stock.fits, *(len(pins) * fits_of(pinion.pin_diameter, stock.clearance)))
    disc = Part("disc", outer, (*middle, *pins), stock.thickness, count=2, body="pinion", fits=fits)
    return disc, _mate(mate, stock)


def _mate(mate: Conjugate, stock: PairStock | LanternStock) -> Part:
    if mate.is_ring:
        return plate_of(mate, "ring", (), stock.thickness, stock.rim)
    hole = stock.mate_hole(1j, mate.hole_room, "stock")
    return replace(plate_of(mate, "mate", hole, stock.thickness, stock.rim), fits=stock.mate.fits)
