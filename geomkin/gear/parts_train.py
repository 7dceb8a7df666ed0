"""Gears of a train, joined by pins on their arbors, the plate that holds the arbors, and the assembly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from itertools import combinations

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import inside, quantity
from ..core.records import record
from ..core.units import mm
from ..making.assembly import (
    Assembly,
    AssemblyBuilder,
    BaseOpening,
    BaseStock,
    collar_across,
    collar_width,
    glue_bill,
    pin_bill,
    seated,
    standing_plate,
    tube_bill,
)
from ..making.bores import SMALLEST, AbstractBored, clearance, fits_of, shaft
from ..model.check import Check
from ..model.part import HoleFit, Part
from ..plane.primitives import Circle
from .contract import AbstractInvoluteGear
from .parts import GearStock, gear_parts
from .parts_assembly import MESH, turns_with_shaft
from .train import GearTrain

# Number of pins that join two gears on an arbor.
PINS = 2
# Least distance between a gear and an arbor or collar that it passes, mm; derived here: the play of the bores on both
# arbors, and their tilt.
LEAST_ARBOR_GAP = 0.5
# Wall of the tubes that hold gears above lower layers, mm: brass tubes are sold with 0.5 to 1.
TUBE_WALL = 1.0


@record(checked=True)
class ArborStock(AbstractBored):
    """Sheet and bore of the gears of a train, and the pins that join two gears on an arbor; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of the sheet, and bore of the arbors, mm.
    pin : float, optional
        Diameter of the two pins that join a driven gear and the driver above it, mm; 0 for gears that are glued.
    """

    bore: float = shaft("the arbors", 5.0, fitted=True)
    clearance: float = clearance(0.1)
    pin: float = quantity(
        "diameter of the two pins that join a driven gear and the driver above it, 0 if they are glued", "mm",
        default=2.0, at_least=0, at_most=100,
    )  # fmt: skip

    @property
    def gear_stock(self) -> GearStock:
        """Sheet and bore of each gear."""
        return GearStock(**{field.name: getattr(self, field.name) for field in fields(AbstractBored)})


@record
class TrainGear:
    """A gear of a train on its arbor: index of its stage and its axis, name, and stock with its key in the recipe."""

    stage: int
    axis: int
    name: str
    gear: AbstractInvoluteGear
    stock: GearStock
    key: str


@record(checked=True)
class TrainStocks:
    """Stocks of the gears of a train and its frame plate.

    Parameters
    ----------
    stock : ArborStock, optional
        Sheet, bore and pins of all gears.
    first, last : GearStock, optional
        Sheet and bore of the first and of the last gear, if different.
    base : BaseStock, optional
        The frame plate.

    Raises
    ------
    DesignError
        If a thickness differs, or a motor drives another gear than the first.
    """

    stock: ArborStock = ArborStock()
    first: GearStock | None = None
    last: GearStock | None = None
    base: BaseStock = BaseStock()

    def __post_init__(self) -> None:
        for key, stock in (("first_stock", self.first), ("last_stock", self.last)):
            if stock is not None and stock.thickness != self.stock.thickness:
                problem = f"found {mm(stock.thickness):g}, but the other gears have {mm(self.stock.thickness):g}"
                thickness = self.stock.thickness
                raise DesignError(f"{key}.thickness", problem, f"give {mm(thickness):.15g}", "conflict", thickness)
        for key, other in (("stock", self.stock), ("last_stock", self.last)):
            if other is not None and other.motor is not None:
                problem = "found a motor for gears that are driven"
                raise DesignError(f"{key}.motor", problem, "give first_stock.motor instead", "conflict")

    @property
    def thickness(self) -> float:
        """Thickness of each layer, mm."""
        return self.stock.thickness

    def gears(self, train: GearTrain) -> tuple[TrainGear, ...]:
        """All gears of a train from bottom to top. Raises DesignError if gears of one arbor do not go together."""
        last = len(train.stages) - 1
        gears: list[TrainGear] = []
        for k, pair in enumerate(train.pairs):
            driver = ("first_stock", self.first) if k == 0 else ("stock", None)
            driven = ("last_stock", self.last) if k == last else ("stock", None)
            for axis, name, gear, (key, stock) in (
                (k, f"driver_{k + 1}", pair.first, driver),
                (k + 1, f"driven_{k + 1}", pair.second, driven),
            ):
                stock, key = (self.stock.gear_stock, "stock") if stock is None else (stock, key)
                gears.append(TrainGear(k, axis, name, gear, stock, key))
        for one, other in combinations(gears, 2):
            if train.arbors[one.axis] == train.arbors[other.axis]:
                _check_shared(one, other)
        return tuple(gears)


def _check_shared(one: TrainGear, other: TrainGear) -> None:
    """Refuse two gears on one arbor with different bores, or that lock each other."""
    if one.stock.bore != other.stock.bore:
        problem = f"found {mm(other.stock.bore):g}, but {one.name} on the same arbor has {mm(one.stock.bore):g}"
        raise DesignError(f"{other.key}.bore", problem, f"give {mm(one.stock.bore):.15g}", "conflict", one.stock.bore)
    if one.axis != other.axis and _is_fixed(one.stock) and _is_fixed(other.stock):
        problem = f"{one.name} and {other.name} are fixed to one arbor but turn at different speeds, so the train locks"
        remedy = f'let one of them run on the arbor: bore_form = "round" and fit = "running" in {other.key}'
        raise DesignError(f"{other.key}.fit", problem, remedy, "conflict")


def _is_fixed(stock: AbstractBored) -> bool:
    return stock.motor is not None or turns_with_shaft(stock)


@checked
def train_parts(train: GearTrain, stocks: TrainStocks = TrainStocks()) -> tuple[Part, ...]:
    """The gears of a train, with bores and holes for pins, and the plate that holds their arbors.

    Parameters
    ----------
    train : GearTrain
        The train.
    stocks : TrainStocks, optional
        Sheets, bores and pins.

    Returns
    -------
    tuple of Part
        The driver and the driven gear of each stage from bottom to top, then the base, with the arbors A, B ...

    Raises
    ------
    DesignError
        If a bore or a pin does not fit into a gear, or holes of the base meet.

    Examples
    --------
    >>> parts = gk.gear.train_parts(gk.gear_train(12, 2, least_teeth=8, reverted=True))
    >>> [part.name for part in parts]
    ['driver_1', 'driven_1', 'driver_2', 'driven_2', 'base']
    """
    gears = stocks.gears(train)
    parts = []
    for item in gears:
        (part,) = gear_parts(item.gear, item.stock, item.name, item.key)
        if stocks.stock.pin and 0 < item.axis < len(train.stages):
            holes, fits = _pin_holes(stocks, train, item)
            part = replace(part, holes=(*part.holes, *holes), fits=(*part.fits, *fits))
        parts.append(replace(part, hole_names=(train.arbors[item.axis],) if part.holes else ()))
    return (*parts, _base(train, stocks, gears))


def _pin_holes(
    stocks: TrainStocks, train: GearTrain, item: TrainGear
) -> tuple[tuple[Circle, ...], tuple[HoleFit, ...]]:
    """Holes of the pins through both gears of an axis, on the x axis of the gears, and their fits."""
    stock = stocks.stock
    outer = min(train.pairs[item.axis - 1].second.root_radius, train.pairs[item.axis].first.root_radius)
    room = outer - stock.hole_reach
    if stock.pin + stock.clearance >= room:
        most = room - stock.clearance
        remedy = f"give less than {mm(most):down}, or 0 for glue" if most > SMALLEST else "give 0, for glue"
        problem = f"found {mm(stock.pin):g}, but there are {mm(max(room, 0)):.4g} between bore and teeth of {item.name}"
        raise DesignError("stock.pin", problem, remedy, value=inside(most, 1) if most > SMALLEST else 0.0)
    radius, middle = (stock.pin + stock.clearance) / 2, stock.hole_reach + room / 2
    holes = tuple(Circle(complex(side * middle), radius) for side in (1, -1))
    return holes, PINS * fits_of(stock.pin, stock.clearance)


def _base(train: GearTrain, stocks: TrainStocks, gears: tuple[TrainGear, ...]) -> Part:
    axes, openings = train.axes, []
    for arbor, axis in train.arbor_axes.items():
        item = next(item for item in gears if train.arbors[item.axis] == arbor)
        key, bore, motor = f"{item.key}.bore", item.stock.bore, item.stock.motor
        openings.append(BaseOpening("an arbor", key, bore, (axis,), arbor, head=collar_across(bore), motor=motor))
    corners = [complex(axes[item.axis]) + side * item.gear.tip_radius * (1 + 1j) for item in gears for side in (1, -1)]
    low = complex(min(z.real for z in corners), min(z.imag for z in corners))
    high = complex(max(z.real for z in corners), max(z.imag for z in corners))
    return standing_plate((low, high), openings, stocks.base, stocks.thickness, stocks.stock.material)


@record
class _Cylinder:
    """A gear, arbor, tube or collar as it turns: axis, radius and range of heights above the base, mm."""

    name: str
    axis: complex
    radius: float
    low: float
    high: float


@checked
def arbor_check(train: GearTrain, stocks: TrainStocks = TrainStocks()) -> Check:
    """Check that no gear touches the arbor or collar of another one that passes its layer.

    Parameters
    ----------
    train : GearTrain
        The train.
    stocks : TrainStocks, optional
        Sheets and bores.

    Returns
    -------
    Check
        The least distance between a gear, arbor or collar and any of another axis at its height, except of gears in
        mesh, mm.

    Examples
    --------
    >>> gk.gear.arbor_check(gk.GearTrain(((12, 48), (12, 48)), 2)).passed
    True
    """
    gears, arbors = _cylinders(train, stocks)
    solids = [(k, item) for k, item in enumerate(gears)] + [(-1, item) for item in arbors]
    gap, words = np.inf, ""
    for (k, one), (j, other) in combinations(solids, 2):
        mesh = k >= 0 and j >= 0 and k // 2 == j // 2
        apart = abs(one.axis - other.axis)
        if mesh or min(one.high, other.high) <= max(one.low, other.low) or apart <= 1e-9 * train.module:
            continue
        if (free := apart - one.radius - other.radius) < gap:
            gap, words = free, f" ({one.name} and {other.name})"
    advice = "give thinner arbors, other directions_deg, or more teeth in the later stages"
    return Check(
        "arbor_gap", f"gears beside arbors and collars{words}", float(gap), "at least", LEAST_ARBOR_GAP, "mm", advice
    )


def _cylinders(train: GearTrain, stocks: TrainStocks) -> tuple[list[_Cylinder], list[_Cylinder]]:
    """The gears, and the arbors with their tubes and upper collars."""
    items, axes, layer = stocks.gears(train), train.axes, stocks.thickness
    gears = []
    for item in items:
        low, radius = item.stage * layer, item.gear.tip_radius
        gears.append(_Cylinder(item.name, complex(axes[item.axis]), radius, low, low + layer))
    arbors = []
    for arbor, axis in train.arbor_axes.items():
        on_arbor = [item for item in items if train.arbors[item.axis] == arbor]
        top, stock = (max(item.stage for item in on_arbor) + 1) * layer, on_arbor[0].stock
        foot = min(item.stage for item in on_arbor) * layer
        arbors.append(_Cylinder(f"tube on {arbor}", axis, stock.bore / 2 + TUBE_WALL, 0.0, foot))
        arbors.append(_Cylinder(f"arbor {arbor}", axis, stock.bore / 2, foot, top))
        if stock.motor is None:
            high = top + collar_width(stock.bore)
            arbors.append(_Cylinder(f"collar on {arbor}", axis, collar_across(stock.bore) / 2, top, high))
    return gears, arbors


@checked
def train_assembly(train: GearTrain, stocks: TrainStocks = TrainStocks()) -> Assembly:
    """Arbors, collars, pins and screws of a train, and the steps of assembly.

    Parameters
    ----------
    train : GearTrain
        The train.
    stocks : TrainStocks, optional
        Sheets, bores and pins.

    Returns
    -------
    Assembly
    """
    items, thickness = stocks.gears(train), stocks.thickness
    builder = AssemblyBuilder("base", thickness, stocks.base, True, items[0].stock.motor)
    for arbor in train.arbor_axes:
        on_arbor = [item for item in items if train.arbors[item.axis] == arbor]
        stages = [item.stage for item in on_arbor]
        top, keys = max(stages) + 1, sum(1 for item in on_arbor if item.stock.keyway[0])
        stock = next((item.stock for item in on_arbor if _is_fixed(item.stock)), on_arbor[0].stock)
        builder.shaft(arbor, on_arbor[0].name, stock, thickness * (top + 1), top, min(stages) * thickness, keys)
        for low, high in zip(stages, stages[1:]):
            if high > low + 1:
                gap = (high - low - 1) * thickness
                builder.buy(arbor, tube_bill(stock.bore, gap))
                builder.add_step(high + 1, f"put a tube of {mm(gap):g} on {arbor}")
    for item in items:
        if not any(other.axis == item.axis and other.stage < item.stage for other in items):
            for step in _steps(train, stocks, item):
                builder.add_step(item.stage + 1, step)
            if 0 < item.axis < len(train.stages):
                pins = pin_bill(stocks.stock.pin, 2 * thickness, PINS)
                builder.buy(item.name, pins or glue_bill(1))
    return builder.build()


def _steps(train: GearTrain, stocks: TrainStocks, item: TrainGear) -> Iterator[str]:
    """Steps that put the gears of an axis on their arbor; item: the lower of them."""
    on, mesh = train.arbors[item.axis], ""
    if item.axis:
        mesh = f", in mesh with driver_{item.stage + 1}, {MESH}"
    if 0 < item.axis < len(train.stages):
        means = f"with {PINS} pins through both" if stocks.stock.pin else "with glue, bores in line"
        joined = f"join {item.name} and driver_{item.stage + 2} on top of it {means}"
        yield f"{joined}, so that their letters stand the same way"
        yield f"{seated('both', on, item.stock)}{mesh}"
    else:
        yield f"{seated(item.name, on, item.stock)}{mesh}"
