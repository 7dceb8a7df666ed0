"""A belt or chain drive: wheels, the loop that fits them, speeds, tensions under a load, and worked formulas."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import Literal

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, ComplexPoint, entry, quantity
from ..core.records import record
from ..core.units import LengthUnit, mm
from ..model.check import WorkedFormula, WorkedFormulas
from ..model.table import Column, Table
from ..plane.vec import Complex, Pose, Real
from .loop import BeltLoop, LoopWheel
from .profiles import MOST_TEETH, AbstractProfile, BeltProfile, check_teeth

# Rows of the table: a turn of the driver in degrees.
ROWS = 361
# Largest number of wheels.
MOST_WHEELS = 12


@record(checked=True)
class Pulley:
    """A toothed pulley or sprocket, or a smooth idler.

    Parameters
    ----------
    teeth : int, optional
        Number of teeth; omitted for a smooth idler.
    diameter : float, optional
        Diameter of a smooth idler, mm.
    at : complex, optional
        Position of its axis, mm.
    side : {"inside", "outside"}, optional
        Side of the belt or chain on which it is.
    bore : float, optional
        Diameter of its shaft, mm.
    """

    teeth: int | None = quantity(
        "number of teeth; omitted for a smooth idler",
        whole=True, default=None, at_least=1, at_most=MOST_TEETH, example=24,
    )  # fmt: skip
    diameter: float | None = quantity("diameter of a smooth idler", "mm", default=None, above=0, at_most=FARTHEST)
    at: ComplexPoint = entry(
        "position of its axis; the last one is moved on its line from the first so that the loop fits", default=0j
    )
    side: Literal["inside", "outside"] = entry(
        "side of the belt or chain on which it is; outside a belt only idlers run", default="inside"
    )
    bore: float | None = quantity(
        "diameter of its shaft, if different from that of the stock", "mm", default=None, above=0, at_most=FARTHEST
    )

    def __post_init__(self) -> None:
        if (self.teeth is None) == (self.diameter is None):
            number = "neither" if self.teeth is None else "both"
            remedy = "give teeth, or diameter of a smooth idler"
            raise DesignError("teeth", f"found {number} teeth and diameter", remedy, "conflict")


@record
class DriveWheel:
    """A wheel of a drive: name, teeth or None for an idler, radii of the pitch line and of the solid wheel, mm."""

    name: str
    teeth: int | None
    radius: float
    solid_radius: float
    is_outside: bool
    bore: float | None


@record(eq=False)
class LoopDrive:
    """A belt or chain round wheels, the driver first.

    profile: sizes. wheels, loop: the wheels, and the loop round them in their places. count: teeth or rollers of the
    loop. moved: distance by which the last wheel was moved from its given place, mm.
    """

    profile: AbstractProfile
    wheels: tuple[DriveWheel, ...]
    loop: BeltLoop
    count: int
    moved: float

    @property
    def axes(self) -> tuple[complex, ...]:
        """Axes of the wheels, mm."""
        return tuple(complex(wheel.centre) for wheel in self.loop.wheels)

    @cached_property
    def toothed(self) -> dict[str, int]:
        """Index of each toothed wheel by its name."""
        return {wheel.name: k for k, wheel in enumerate(self.wheels) if wheel.teeth}

    def speed(self, name: str) -> Fraction:
        """Rotations of a toothed wheel for one of the driver, exact."""
        wheel, first = self.wheels[self.toothed[name]], self.wheels[0]
        assert wheel.teeth and first.teeth
        return Fraction((-1 if wheel.is_outside else 1) * first.teeth, wheel.teeth)

    @property
    def period(self) -> int:
        """Pitches of the loop after which all toothed wheels are where they began."""
        return lcm(*(wheel.teeth for wheel in self.wheels if wheel.teeth))

    @property
    def has_idlers(self) -> bool:
        """Whether there are smooth idlers, which are not at rest after whole pitches."""
        return len(self.toothed) < len(self.wheels)

    def turns(self, turn: Real) -> Iterator[Real]:
        """Rotation of each wheel, rad, at rotations of the driver."""
        first = self.loop.wheels[0]
        for wheel in self.loop.wheels:
            yield wheel.side * turn * first.pitches / wheel.pitches

    def poses(self, turn: Real) -> Iterator[Pose]:
        """Pose of each wheel, whose first gap is on +y, at rotations of the driver, rad, (frames,)."""
        for k, (axis, own) in enumerate(zip(self.axes, self.turns(turn))):
            phase = self.loop.phase(k) if self.wheels[k].teeth else 0.0
            yield Pose(np.full(turn.shape, axis), np.exp(1j * (own + phase)))

    def columns(self, turn: Real) -> Iterator[Column]:
        """Rotations of the wheels, deg, and travel of the loop, mm, at rotations of the driver, rad."""
        for wheel, own in zip(self.wheels, self.turns(turn)):
            yield Column(f"{wheel.name}_turn", "deg", f"rotation of {wheel.name}", np.degrees(own))
        travel = turn * self.loop.wheels[0].pitches * self.profile.pitch / (2 * np.pi)
        yield Column("travel", "mm", "travel along the pitch line", travel)

    @property
    def table(self) -> Table:
        """Rotations during a turn of the driver."""
        return Table(tuple(self.columns(np.linspace(0, 2 * np.pi, ROWS))))

    @property
    def in_mesh(self) -> dict[str, int]:
        """Teeth of each toothed wheel that are in mesh, rounded down."""
        wraps = self.loop.wraps
        shares = ((name, k, wraps[k] / (2 * np.pi)) for name, k in self.toothed.items())
        return {name: int((self.wheels[k].teeth or 0) * share * (1 + 1e-12)) for name, k, share in shares}


def loop_drive(
    profile: AbstractProfile,
    given: Sequence[Pulley],
    count: int | None,
    step: int,
    flange: float,
    keys: tuple[str, str],
) -> LoopDrive:
    """The drive of given wheels, whose last one is moved so that a loop of whole teeth fits.

    count: teeth or rollers of the loop; None for the number that moves it least. step: that of the numbers, 2 for
    chains. flange: height of flanges above the wheels, mm. keys: of the wheels and of the count in the recipe.
    """
    wheels_key, count_key = keys
    if not 2 <= len(given) <= MOST_WHEELS:
        raise DesignError(wheels_key, f"found {len(given)}", f"give 2 to {MOST_WHEELS}", "out-of-range")
    if given[0].teeth is None or given[0].side == "outside":
        problem = "the first one drives, and it is not a toothed one inside the loop"
        raise DesignError(f"{wheels_key}[0]", problem, "list the driver first", "conflict")
    wheels, parts = [], []
    for k, item in enumerate(given):
        if item.teeth is not None:
            check_teeth(f"{wheels_key}[{k}].teeth", profile, item.teeth)
            if item.side == "outside" and isinstance(profile, BeltProfile):
                remedy = "give diameter of a smooth idler instead of teeth; double-sided belts are not offered"
                problem = "found teeth outside the belt, whose back is smooth"
                raise DesignError(f"{wheels_key}[{k}].side", problem, remedy, "conflict")
        wheel = _wheel(profile, item, k, wheels_key.removesuffix("s"))
        extent = profile.front if wheel.is_outside else profile.back
        pitches = item.teeth or 2 * np.pi * wheel.radius / profile.pitch
        room = max(wheel.radius + extent, wheel.solid_radius + flange)
        wheels.append(wheel)
        parts.append(LoopWheel(item.at, wheel.radius, float(pitches), wheel.is_outside, room))
    try:
        loop = BeltLoop(tuple(parts), profile.pitch)
        fitted = _fitted(loop, count, step, count_key)
    except DesignError as error:
        key = error.field.replace("wheels", wheels_key).replace(".centre", ".at")
        raise DesignError(key, error.problem, error.remedy, error.id, error.value) from None
    moved = float(abs(fitted.wheels[-1].centre - loop.wheels[-1].centre))
    return LoopDrive(profile, tuple(wheels), fitted, round(fitted.length), moved)


def _wheel(profile: AbstractProfile, item: Pulley, k: int, name: str) -> DriveWheel:
    is_outside = item.side == "outside"
    if item.teeth is not None:
        radius, solid = profile.pitch_radius(item.teeth), profile.tip_radius(item.teeth)
    else:
        assert item.diameter is not None
        solid = item.diameter / 2
        radius = solid + (profile.back if is_outside else profile.front)
    own = "driver" if k == 0 else f"{name if item.teeth else 'idler'}_{k + 1}"
    return DriveWheel(own, item.teeth, radius, solid, is_outside, item.bore)


def _fitted(loop: BeltLoop, count: int | None, step: int, key: str) -> BeltLoop:
    """The loop of a number of teeth, or of the number near its own length that fits."""
    nearest = step * round(loop.length / step)
    counts = (nearest, nearest + step, nearest - step) if count is None else (count,)
    refused: DesignError | None = None
    for number in counts:
        try:
            return loop.fitted(max(number, 1))
        except DesignError as error:
            refused = refused or error
    assert refused is not None
    if refused.field != "pitches" or not isinstance(refused.value, float) or not np.isfinite(refused.value):
        raise refused
    is_short = counts[0] < refused.value
    limit = step * int(np.ceil(refused.value / step) if is_short else np.floor(refused.value / step))
    last = f"wheels[{len(loop.wheels) - 1}].centre"
    try:
        place = loop.fitted(max(limit, 1)).wheels[-1].centre
    except DesignError:
        problem = "with this wheel on its line from the first one, no loop of a whole number of pitches fits"
        raise DesignError(last, problem, "move it or another wheel", "conflict") from None
    if count is None:
        problem = "this wheel meets another one, or leaves the loop no room"
        x, y = place.real + 0.0, place.imag + 0.0
        remedy = f"give x {mm(x):.6g} and y {mm(y):.6g}, where a loop of {limit} pitches fits"
        raise DesignError(last, problem, remedy, "conflict")
    words, size = ("at least", "shorter") if is_short else ("at most", "longer")
    problem = f"found {count}, {size} than any loop round these wheels with the last one on its line"
    raise DesignError(key, problem, f"give {words} {limit}, or move the wheels", "out-of-range", limit)


@record(eq=False)
class LoopTensions:
    """Tensions of a drive under torques.

    drive: the drive. torques: against the rotation of each wheel, N mm, 0 for the driver and idlers. slack: tension of
    the strand after the driver, N. efficiency: share of the driver's power that reaches the other wheels.
    """

    drive: LoopDrive
    torques: tuple[float, ...]
    slack: float
    efficiency: float = 1.0

    @property
    def pull(self) -> float:
        """Force along the loop that the driver transmits, N."""
        return float(self._pulls.sum())

    @property
    def _pulls(self) -> Real:
        """Force along the loop that each wheel takes, N: its torque over the radius of its mean speed."""
        turns = [wheel.pitches * self.drive.profile.pitch / (2 * np.pi) for wheel in self.drive.loop.wheels]
        return np.array(self.torques) / turns

    @property
    def driver_torque(self) -> float:
        """Torque on the driver, N mm: that of equal power, over the efficiency."""
        turn = self.drive.loop.wheels[0].pitches * self.drive.profile.pitch
        return self.pull * turn / (2 * np.pi) / self.efficiency

    @property
    def tensions(self) -> Real:
        """Tension of the strand that follows each wheel, N, (wheels,); the last one is the tight strand."""
        return self.slack + np.cumsum(self._pulls)

    @property
    def shaft_loads(self) -> Complex:
        """Force of the loop on each shaft, N, (wheels,)."""
        after = self.tensions * self.drive.loop.directions
        return after - np.roll(after, 1)


def loop_formulas(drive: LoopDrive, unit: LengthUnit) -> tuple[WorkedFormula, ...]:
    """Pitch diameters, ratios, strands, and the length of the loop round all wheels."""
    source = "Shigley, Mechanical Engineering Design, chapter 17"
    loop, count, worked = drive.loop, len(drive.wheels), WorkedFormulas(source)
    p = worked.give("p", "pitch", unit.of(drive.profile.pitch), unit.name)
    worked.give("N", "pitches of the loop", drive.count)
    for k, (wheel, wrap, axis) in enumerate(zip(drive.wheels, loop.wraps, drive.axes), 1):
        following = drive.wheels[k % count]
        name, distance = f"distance of the axes of {wheel.name} and {following.name}", abs(drive.axes[k % count] - axis)
        if wheel.teeth:
            worked.give(f"z_{k}", f"teeth of {wheel.name}", wheel.teeth)
        else:
            worked.give(f"d_{k}", f"pitch diameter of {wheel.name}", unit.of(2 * wheel.radius), unit.name)
        worked.give(f"D_{k}", name, unit.of(distance), unit.name)
        worked.give(f"w_{k}", f"angle that the loop wraps {wheel.name}", np.degrees(wrap), "deg")
    form = "{p} {z} / {pi}" if isinstance(drive.profile, BeltProfile) else "{p} / sin(180 deg / {z})"
    for k, wheel in enumerate(drive.wheels, 1):
        if wheel.teeth:
            template, value = form.replace("{z}", f"{{z_{k}}}"), float(unit.of(2 * wheel.radius))
            worked.add(f"pitch diameter of {wheel.name}", f"d_{k}", template, value, unit.name)
    lengths, terms = 0.0, []
    for k, (wheel, span) in enumerate(zip(drive.wheels, loop.spans), 1):
        after = k % count + 1
        following = drive.wheels[after - 1]
        sign = "-" if wheel.is_outside == following.is_outside else "+"
        if wheel.teeth and k > 1:
            ratio = wheel.teeth / (drive.wheels[0].teeth or 1)
            worked.add(f"turns of the driver for one of {wheel.name}", f"i_{k}", f"{{z_{k}}} / {{z_1}}", ratio)
        template = f"sqrt({{D_{k}}}^2 - (({{d_{k}}} {sign} {{d_{after}}}) / 2)^2)"
        name = f"strand from {wheel.name} to {following.name}"
        terms.append(f"{{t_{k}}}")
        lengths += worked.add(name, f"t_{k}", template, float(unit.of(span)), unit.name)
    for k, (wheel, wrap) in enumerate(zip(drive.wheels, loop.wraps), 1):
        arc = wrap / (2 * np.pi) * (p * wheel.teeth if wheel.teeth else 2 * np.pi * float(unit.of(wheel.radius)))
        template = f"{{p}} {{z_{k}}} {{w_{k}}} / 360" if wheel.teeth else f"{{d_{k}}} {{pi}} {{w_{k}}} / 360"
        terms.append(f"{{b_{k}}}")
        lengths += worked.add(f"length round {wheel.name}", f"b_{k}", template, arc, unit.name)
    worked.add("length of strands and arcs", "L", " + ".join(terms), lengths, unit.name)
    worked.add("length of the loop", "L_N", "{N} {p}", drive.count * p, unit.name)
    return tuple(worked.formulas)
