"""Stock of a gear and the mate that it generates: the bores of both, each with its own fit and form."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, inside, quantity, rounded_down, to_digits
from ...core.records import record
from ...making.bores import (
    AbstractBored,
    BoreForm,
    Fit,
    bore_form_entry,
    clearance,
    fit_entry,
    fits_of,
    flat_across,
    keyway_depth,
    keyway_width,
    shaft,
)
from ...model.part import Part
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle
from ..conjugate.conjugate import Conjugate
from ..conjugate.shaping_gears import LanternPinion
from ..contract import AbstractGear
from .gears import plate_of

# Keys of a bore for which the mate has its own key, with the prefix mate_.
BORE_KEYS = re.compile(r"\b(bore_form|bore|keyway_width|keyway_depth|flat)\b")


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
    rim: float = quantity("width of a ring outside its teeth", "mm", default=8.0, at_least=0.01, at_most=FARTHEST)

    def __post_init__(self) -> None:
        super().__post_init__()
        with _of_mate():
            _ = self.mate

    @property
    def mate(self) -> AbstractBored:
        """The stock of the mate as a single gear."""
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
            material=self.material,
        )

    def mate_hole(self, towards: complex, widest: float, key: str) -> tuple[AbstractCurve, ...]:
        """The mate's bore about its axis; the parameters are those of `hole`."""
        with _of_mate():
            return self.mate.hole(towards, widest, key)


@contextmanager
def _of_mate() -> Iterator[None]:
    """Translate the keys in a DesignError of a bore to those of the mate."""
    try:
        yield
    except DesignError as error:
        table, dot, name = error.field.rpartition(".")
        field, remedy = BORE_KEYS.sub(r"mate_\1", name), BORE_KEYS.sub(r"mate_\1", error.remedy)
        problem = error.problem.replace("bore_form", "mate_bore_form")
        raise DesignError(f"{table}{dot}{field}", problem, remedy, error.id) from None


@record
class PairStock(AbstractMated):
    """Sheet and bores of a gear and its mate; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of both sheets, and bore of the gear, mm.
    mate_bore, mate_bore_form, mate_flat, mate_keyway_width, mate_keyway_depth, mate_fit : optional
        Bore of the mate, mm.
    rim : float, optional
        Width outside the teeth of a ring, mm.
    """


@record
class LanternStock(AbstractMated):
    """Sheet and bores of a lantern pinion's discs and of its wheel, the mate; all lengths in mm. The pins are rods.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of all sheets, and bore of the discs, mm.
    mate_bore, mate_bore_form, mate_flat, mate_keyway_width, mate_keyway_depth, mate_fit : optional
        Bore of the wheel, mm.
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
    holes = stock.hole(1j, gear.hole_room, "stock")
    plate = plate_of(gear, "gear", holes, stock.thickness, stock.rim)
    return replace(plate, fits=() if gear.is_ring else stock.fits, material=stock.material), _mate(mate, stock)


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
        raise DesignError(
            "stock.clearance",
            f"found {stock.clearance:g} mm, with which the pins' holes meet",
            f"give less than {rounded_down(most)} mm, or thinner pins" if most > 0 else "give thinner pins",
            value=inside(most, 1) if most > 0 else None,
        )
    pins = tuple(Circle(c.centre, hole) for c in pinion.circles)
    first = pinion.circles[0].centre
    middle = stock.hole(first / abs(first), 2 * (pinion.pitch_radius - hole), "stock")
    outer = Circle(0j, pinion.pitch_radius + pinion.pin_diameter / 2 + stock.clearance / 2 + stock.edge)
    fits = (*stock.fits, *(len(pins) * fits_of(pinion.pin_diameter, stock.clearance)))
    holes = (*middle, *pins)
    disc = Part("disc", outer, holes, stock.thickness, count=2, body="pinion", fits=fits, material=stock.material)
    return disc, _mate(mate, stock)


def _mate(mate: Conjugate, stock: PairStock | LanternStock) -> Part:
    if mate.is_ring:
        return replace(plate_of(mate, "ring", (), stock.thickness, stock.rim), material=stock.material)
    hole = stock.mate_hole(1j, mate.hole_room, "stock")
    plate = plate_of(mate, "mate", hole, stock.thickness, stock.rim)
    return replace(plate, fits=stock.mate.fits, material=stock.material)
