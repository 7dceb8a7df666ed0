"""Tables that recipes of several kinds share."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np

from ..core.arguments import ArgumentType, between
from ..core.errors import DesignError
from ..core.field_visitor import WrittenForm
from ..core.fields import FARTHEST, WIDEST, ComplexPoint, entry, quantity, rounded_up
from ..core.records import record
from ..core.units import bare_mm, mm
from ..export.cut import LayerStyles
from ..export.formats import DEFAULT_FORMATS, WRITERS
from ..export.layout import NARROWEST_TAB
from ..export.text import Title
from ..model.check import Check, Suggestion
from ..model.material import Mass
from ..plane.vec import Real


class OneOfFormats(ArgumentType, WrittenForm):
    """Marks a text as the name of a format. WRITERS is read at each validation, since formats may be added to it."""

    def __init__(self) -> None:
        super().__init__(lambda value: isinstance(value, str) and value in WRITERS, "the name of a format")

    @property
    def choices(self) -> list[str]:
        return list(WRITERS)


Format = Annotated[str, OneOfFormats()]

# Width or height of a sheet, mm. A smaller one has no room within its margins; a larger one does not exist.
Side = Annotated[float, between(10, WIDEST, "mm")]

# Largest numbers of rows and of cells of a table, which take some seconds and half a GB. More take minutes and several
# GB, and no program opens them; fewer would refuse a full turn in steps of a hundredth of a degree.
MOST_ROWS = 50_000
MOST_CELLS = 2_000_000
# Smallest step, deg, in which plates are tested for collisions. Smaller ones find the same collisions.
FINEST_DEG = 0.25

# A rotation in degrees that differs by at most this from quarter turns in radians, as 6.28 does from a full turn, is
# probably meant in radians. A larger value would catch intended rotations. More than four turns are not compared.
IN_RADIANS, MOST_QUARTERS = 4e-3, 16


def check_rows(key: str, span: float, step: float, unit: str, columns: int = 1) -> None:
    """Raise DesignError, before anything is computed, if a table over a span in steps has too many rows.

    key: of the step; the message names the smallest step that works. columns: largest number of columns of the table.
    """
    most = min(MOST_ROWS, MOST_CELLS // columns)
    # The margin lets the recommended step pass in spite of rounding.
    if span / step > most * (1 + 1e-9):
        cells = f" of {columns} columns" if columns > 1 else ""
        raise DesignError(
            key,
            f"found {mm(step, unit=unit):g} for a range of {mm(span, unit=unit):g}, "
            f"which takes {span / step:,.0f} rows{cells}",
            f"give at least {mm(span / most, unit=unit):up4}",
            "too-much-work",
            rounded_up(span / most, 4),
        )


def kerf(default: float | None) -> Any:
    """The field for the kerf."""
    meaning = "width of the cut; DXF and SVG move outlines out and holes in by half of it"
    return quantity(meaning, "mm", default=default, at_least=0, at_most=20)


@record(checked=True)
class Files:
    """The formats to write, and their options."""

    write: tuple[Format, ...] = entry("files to write", default=DEFAULT_FORMATS)
    tolerance: float = quantity(
        "largest distance between a curve and its chords", "mm", default=0.005, at_least=1e-6, at_most=10
    )
    curves: Literal["chords", "arcs"] = entry(
        "outlines in DXF and SVG as chords, which every program reads, or as arcs, a tenth of the points",
        default="chords",
    )
    kerf: float = kerf(0.0)
    style: Literal["drawing", "laser"] = entry(
        "SVG for viewing, or with the red and blue hairlines that programs of laser cutters expect", default="drawing"
    )
    labels: bool = entry(
        "engrave each part with its name, and the holes of links with the letters of their pins", default=True
    )
    sheet: tuple[Side, Side] | None = entry(
        "[width, height] in mm of the sheets that parts are cut from, or of the bed of a printer",
        default=None,
        units=("mm", "mm"),
    )
    dxf_version: Literal["R2000", "R12"] = entry(
        "version of the DXF files to cut: R12 has polylines and no unit, for programs that cannot read R2000",
        default="R2000",
    )
    cutter: float = quantity(
        "diameter of a milling cutter; drawings to cut then have dogbones or T-bones in the corners of bores with "
        "flats or keyways; 0 for none",
        "mm",
        default=0.0,
        at_least=0,
        at_most=100,
    )
    tab_width: float = quantity(
        "width of the tabs that hold parts in their sheet; these pieces of the outlines are on layer TAB; 0 for none",
        "mm",
        default=0.0,
        at_least=0,
        at_most=100,
    )
    layers: LayerStyles | None = entry("names and colours of the layers of drawings to cut", default=None)
    title: Title = entry("further entries in the title block of dimensioned drawings", default=Title())
    assembly_at: float | None = quantity(
        "position of the driver in pictures of the assembly: deg, or mm if it slides",
        default=None, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if 0 < self.tab_width < NARROWEST_TAB:
            remedy = f"give 0 or at least {mm(NARROWEST_TAB):up4}"
            raise DesignError("tab_width", f"found {mm(self.tab_width):g}", remedy, "out-of-range", NARROWEST_TAB)

    @property
    def wants_all(self) -> bool:
        """Whether the formats are the default ones, of which a kind may lack some."""
        return self.write == Files.write

    @property
    def wants_parts(self) -> bool:
        """Whether any of the formats needs the parts."""
        return any(WRITERS[ending].needs == "parts" for ending in self.write)


@record(checked=True)
class OptimiseTable:
    """The task of `geomkin optimise`: keys to vary, the result or results to minimise, and constraints."""

    vary: tuple[str, ...] = entry(
        "ranges of keys that hold numbers, each KEY = LOW:HIGH", example=("linkage.crank = 20:40",)
    )
    minimise: str | tuple[str, ...] = entry(
        "the result to minimise, a formula of ids of columns and checks; a row of 2 to 4 gives the Pareto front",
        example="-min(transmission_angle)",
    )
    subject_to: tuple[str, ...] = entry(
        "constraints: two formulas with >= or <= between them, such as min(transmission_angle) >= 40", default=()
    )


# Smallest speeds of a driver that turns, rpm, and of one that slides, mm/s: slower ones take years.
SLOWEST_RPM, SLOWEST = 0.001, 1e-6


def efficiency_entry(of: str) -> Any:
    """Field for a stated efficiency of a drive."""
    words = (
        f"share of the power of {of} that reaches the driven ones, from its maker; power that flows back loses as much"
    )
    return quantity(words, default=1.0, at_least=0.01, at_most=1)


def _speed_rpm() -> Any:
    return quantity("speed of the driver; negative if clockwise", "rpm", default=60.0, at_least=-1e6, at_most=1e6)


def _step_deg() -> Any:
    meaning = "rotation of the driver between rows of the motion table"
    return quantity(meaning, "deg", default=1.0, at_least=0.001, at_most=90)


def _acceleration(unit: str) -> Any:
    meaning = "acceleration of the driver; each row of the table has this acceleration and this speed, and no time"
    return quantity(meaning, unit, default=0.0, at_least=-FARTHEST, at_most=FARTHEST)


def _check_speed(key: str, speed: float, least: float) -> None:
    if abs(speed) < least:
        power = int(not key.endswith("_rpm"))
        raise DesignError(
            key,
            f"found {bare_mm(speed, power=power):g}",
            f"give at least {bare_mm(least, power=power):up6}, or at most {bare_mm(-least, power=power):down6} for the "
            "opposite direction",
            "out-of-range",
            least,
        )


def _check_end(key: str, start: float, end: float, speed_key: str, speed: float) -> None:
    """Raise DesignError if the end is not on the side of the start towards which the driver moves."""
    if (end - start) * speed > 0:
        return
    side, other = ("more", "negative") if speed > 0 else ("less", "positive")
    power = int(not key.endswith("_deg"))
    begin, found, rate = (bare_mm(number, power=power) for number in (start, end, speed))
    problem = f"found {found:g}, with {speed_key} = {rate:g}"
    raise DesignError(key, problem, f"give {side} than {begin:g}, the start, or a {other} {speed_key}", "conflict")


@record(checked=True)
class Drive:
    """Rotation of a crank, cam or gear over one turn, and the step between rows of the table."""

    speed_rpm: float = _speed_rpm()
    step_deg: float = _step_deg()
    acceleration_rad_per_s2: float = _acceleration("rad/s2")

    def __post_init__(self) -> None:
        _check_speed("speed_rpm", self.speed_rpm, SLOWEST_RPM)

    def check_rows(self, turns: float = 1.0) -> None:
        """DesignError if a table over so many turns of the driver would have too many rows."""
        check_rows("drive.step_deg", 360 * turns, self.step_deg, "deg")

    @property
    def speed(self) -> float:
        """rad/s."""
        return self.speed_rpm * np.pi / 30

    @property
    def angles(self) -> Real:
        """Driver angles over one turn, rad, both ends included, in equal steps of at most `step_deg`."""
        return np.linspace(0, 2 * np.pi, int(np.ceil(360 / self.step_deg - 1e-9)) + 1)


@record(checked=True)
class Turn:
    """Rotation of a linkage's driver, and the step between rows of the table."""

    speed_rpm: float = _speed_rpm()
    step_deg: float = _step_deg()
    start_deg: float = quantity("driver's first angle", "deg", default=0.0, at_least=-3600, at_most=3600)
    # Never None after `__post_init__`.
    end_deg: float = quantity(
        "driver's last angle; by default 360, or -360 if speed_rpm is negative", "deg",
        default=None, at_least=-3600, at_most=3600, filled_in=360.0,
    )  # fmt: skip
    acceleration_rad_per_s2: float = _acceleration("rad/s2")

    def __post_init__(self) -> None:
        _check_speed("speed_rpm", self.speed_rpm, SLOWEST_RPM)
        if self.end_deg is None:
            object.__setattr__(self, "end_deg", float(np.copysign(360, self.speed_rpm)))
            if (self.end_deg - self.start_deg) * self.speed_rpm <= 0:
                problem = f"found {self.start_deg:g}, and the turn ends at {self.end_deg:g}"
                raise DesignError("start_deg", problem, "give end_deg too", "conflict")
        _check_end("end_deg", self.start_deg, self.end_deg, "speed_rpm", self.speed_rpm)

    @property
    def span_deg(self) -> tuple[float, float]:
        """The driver's first and last angle, deg."""
        return self.start_deg, self.end_deg

    @property
    def turn_deg(self) -> float:
        """Size of the rotation, deg."""
        return abs(self.end_deg - self.start_deg)

    @property
    def rising(self) -> tuple[float, float]:
        """Smallest and largest angle, rad."""
        low, high = np.radians(sorted(self.span_deg)).tolist()
        return low, high

    @property
    def checks(self) -> tuple[Check, ...]:
        """A failed check if the rotation looks like a number of quarter turns in radians."""
        turn = self.turn_deg
        quarters = round(turn / (np.pi / 2))
        if not 1 <= quarters <= MOST_QUARTERS or abs(turn - quarters * np.pi / 2) > IN_RADIANS:
            return ()
        advice = f"{turn:g} looks like radians; the same in degrees is {90 * quarters}"
        end = self.start_deg + float(np.copysign(90 * quarters, self.end_deg - self.start_deg))
        meant = (Suggestion({"drive.end_deg": end}, "deg"),)
        name = "rotation of the driver"
        return (Check("driver_range", name, turn, "at least", 90 * quarters, "deg", advice, suggestions=meant),)

    def check_rows(self, columns: int = 1) -> None:
        """DesignError if a table with so many columns would have too many rows."""
        check_rows("drive.step_deg", self.turn_deg, self.step_deg, "deg", columns)

    @property
    def speed(self) -> float:
        """rad/s."""
        return self.speed_rpm * np.pi / 30

    @property
    def acceleration(self) -> float:
        """rad/s2."""
        return self.acceleration_rad_per_s2

    @property
    def frames(self) -> Real:
        """Angles of the driver, rad, both ends included, in equal steps of at most `step_deg`."""
        return self._in_steps(self.step_deg)

    @property
    def collision_samples(self) -> Real:
        """Angles of the driver, rad, in steps fine enough to find every collision of plates."""
        return self._in_steps(float(np.clip(self.step_deg, FINEST_DEG, 1.0)))

    def _in_steps(self, step: float) -> Real:
        start, end = np.radians(self.span_deg)
        return np.linspace(start, end, int(np.ceil(self.turn_deg / step - 1e-9)) + 1)


@record(checked=True)
class Stroke:
    """Stroke of a sliding driver, and the step between rows of the table."""

    start: float = quantity(
        "driver's first position along its line", "mm", at_least=-FARTHEST, at_most=FARTHEST, example=70
    )
    end: float = quantity("driver's last position", "mm", at_least=-FARTHEST, at_most=FARTHEST, example=110)
    speed: float = quantity(
        "speed of the driver; negative if the end is below the start", "mm/s",
        default=50.0, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    step: float = quantity(
        "displacement of the driver between rows of the motion table", "mm", default=1.0, above=0, at_most=FARTHEST
    )
    acceleration_mm_per_s2: float = _acceleration("mm/s2")

    def __post_init__(self) -> None:
        _check_speed("speed", self.speed, SLOWEST)
        _check_end("end", self.start, self.end, "speed", self.speed)

    @property
    def checks(self) -> tuple[Check, ...]:
        """No checks: a displacement in mm cannot be mistaken for another unit."""
        return ()

    @property
    def rising(self) -> tuple[float, float]:
        """Smallest and largest position, mm."""
        return min(self.start, self.end), max(self.start, self.end)

    @property
    def acceleration(self) -> float:
        """mm/s2."""
        return self.acceleration_mm_per_s2

    def check_rows(self, columns: int = 1) -> None:
        """DesignError if a table with so many columns would have too many rows."""
        check_rows("stroke.step", abs(self.end - self.start), self.step, "mm", columns)

    @property
    def frames(self) -> Real:
        """Positions of the driver, mm, both ends included, in equal steps of at most `step`."""
        return self._in_steps(self.step)

    @property
    def collision_samples(self) -> Real:
        """Positions of the driver, mm, in steps fine enough to find every collision of plates."""
        stroke = abs(self.end - self.start)
        return self._in_steps(float(np.clip(self.step, stroke / 1440, stroke / 180)))

    def _in_steps(self, step: float) -> Real:
        return np.linspace(self.start, self.end, int(np.ceil(abs(self.end - self.start) / step - 1e-9)) + 1)


# Largest component of gravity, m/s2: more is a number in mm/s2.
MOST_GRAVITY = 100.0
_Gravity = Annotated[float, between(-MOST_GRAVITY, MOST_GRAVITY)]
Gravity = tuple[_Gravity, _Gravity]


# m/s2, in the frame of a recipe.
STANDARD_GRAVITY = (0.0, -9.81)


def gravity_entry() -> Any:
    """Field for the gravity of a table of loads."""
    return entry(
        "acceleration of a falling body, [x, y] in m/s2; [0, 0] if it is not considered",
        default=STANDARD_GRAVITY,
        units=("m/s2", "m/s2"),
    )


@record(checked=True)
class BodyMass:
    """Mass of a body in a recipe."""

    mass_kg: float = quantity("mass", "kg", at_least=0, at_most=FARTHEST, example=0.2)
    centre: ComplexPoint = entry("centre of mass in the body's frame, [x, y] in mm", default=0j, example=20 + 0j)
    inertia_kg_mm2: float = quantity(
        "moment of inertia about the centre", "kg mm2", default=0.0, at_least=0, at_most=FARTHEST**2, example=100
    )

    @property
    def mass(self) -> Mass:
        """The mass as the library has it."""
        return Mass(self.mass_kg, self.centre, self.inertia_kg_mm2)
