"""Bores of parts on shafts and pins: running or press fit, round, with a flat or with a keyway, and their checks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from math import cos, pi
from typing import Any, Literal, Self

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, inside, quantity, rounded_down, to_digits
from ..core.records import record
from ..core.units import INCH, bare_mm, mm
from ..model.check import Check
from ..model.part import Fit, FitLimits, HoleFit, HoleTolerance, Part, fit_limits
from ..plane.primitives import Circle, Polyline
from .materials import MaterialKey, material_entry
from .motors import HEADS, MountedMotorKey, engagement_check, face_of, motor_plate, mounted_motor_entry

# Smallest diameter of a hole, mm. No cutter makes a smaller one.
SMALLEST = 0.01


def shaft(item: str, default: float, fitted: bool = False) -> Any:
    """The field for the diameter of a shaft or pin. item: its name, such as "the cam shaft".

    fitted: whether the stock also has a field for the fit of the hole.
    """
    pressed = ", or for a press fit narrower by the interference" if fitted else ""
    meaning = f"diameter of {item}, 0 for no hole; its hole is wider by the clearance{pressed}"
    return quantity(meaning, "mm", default=default, at_least=0)


def clearance(default: float) -> Any:
    """The field of stock tables for the clearance of holes."""
    return quantity(
        "how much wider a hole is than its pin or shaft",
        "mm",
        default=default,
        at_least=0,
        at_most=FARTHEST,
        printed=1.0,
    )


def widened(diameter: float, clearance: float) -> float:
    """Diameter of the hole for a shaft or pin, mm; 0 for diameter 0."""
    return diameter + clearance if diameter else 0.0


def fits_of(diameter: float, play: float) -> tuple[HoleFit, ...]:
    """The fit of a hole that is wider than its shaft or pin by `play`, mm; empty for diameter 0."""
    return (HoleFit(diameter, play),) if diameter else ()


def bore(diameter: float, clearance: float, widest: float, key: str, centre: complex = 0j) -> tuple[Circle, ...]:
    """The hole for a shaft; none for diameter 0. Raises DesignError if it is too small, or as wide as the part.

    clearance: difference of the diameters of hole and shaft, mm, negative for a press fit. widest: least width of the
    part round the hole, mm. key: the recipe's key of the diameter; the key of the clearance is in the same table.
    """
    if diameter == 0:
        return ()
    room = f"in a part whose least width is {mm(widest):.7g}"
    if not SMALLEST <= diameter < widest - min(clearance, 0.0):
        most = widest - clearance
        # Pins and screws are needed.
        ways = ["give 0 for none"] if key.endswith("bore") else []
        ways += (
            [f"give at least {bare_mm(SMALLEST):up} and less than {mm(most):down}"]
            if most > SMALLEST
            else ["make the part larger"]
        )
        remedy = ", or ".join(ways)
        problem = f"found {mm(diameter):g} {room}"
        raise DesignError(key, problem, remedy, value=inside(most, 1) if most > SMALLEST else 0)
    if diameter + clearance >= widest:
        most = to_digits(widest - diameter, 12)
        problem = f"found {mm(clearance):g} for a shaft of {mm(diameter):g} {room}"
        remedy = f"give less than {mm(most):down}, or a smaller {key.rpartition('.')[2]}"
        raise DesignError(f"{key.rpartition('.')[0]}.clearance", problem, remedy, value=inside(most, 1))
    return (Circle(centre, (diameter + clearance) / 2),)


def keyed_bore(
    diameter: float, clearance: float, width: float, depth: float, towards: complex, widest: float, key: str
) -> tuple[Circle | Polyline, ...]:
    """The hole for a shaft about a part's axis, with a keyway of a width and depth, mm, as one outline.

    diameter: diameter of the shaft; the bore is wider by the clearance, which is negative for a press fit. depth: depth
    of the keyway beyond the bore, along its centre line. towards: unit direction of this line. widest: least width of
    the part, mm. The keyway has square corners. With width and depth 0 the bore is plain; for diameter 0 there is no
    hole. Raises DesignError if the part is too narrow; its field begins with `key`.
    """
    holes = bore(diameter, clearance, widest, f"{key}.bore")
    if width == 0 and depth == 0:
        return holes
    if width == 0 or depth == 0:
        missing = "width" if width == 0 else "depth"
        remedy = "give width and depth of the keyway, or neither"
        raise DesignError(f"{key}.keyway_{missing}", f"found {mm(0):g}", remedy, "conflict")
    across = diameter + clearance
    if width >= across:
        problem = f"found {mm(width):g} in a bore of {mm(across):g}"
        raise DesignError(f"{key}.keyway_width", problem, "give a keyway narrower than the bore")
    radius = across / 2
    corner = radius + depth + 0.5j * width
    if abs(corner) >= widest / 2:
        raise DesignError(
            f"{key}.keyway_depth",
            f"found {mm(depth):g}, so the keyway extends {mm(abs(corner)):.4g} from the axis of a part whose least "
            "width "
            f"is {mm(widest):.4g}",
            "give a shallower keyway or a smaller bore",
        )
    mouth = np.sqrt(radius**2 - width**2 / 4) + 0.5j * width
    # Round the bore from one side of the mouth to the other, then along the three sides of the keyway.
    sweep = 2 * np.pi - 2 * float(np.angle(mouth))
    corners = np.array([mouth, np.conj(mouth), np.conj(corner), corner])
    return (Polyline(corners * towards, np.array([np.tan(sweep / 4), 0, 0, 0])),)


def flattened_bore(
    diameter: float, clearance: float, flat: float, towards: complex, widest: float, key: str
) -> tuple[Circle | Polyline, ...]:
    """The hole for a D-shaft about a part's axis; none for diameter 0.

    diameter: diameter of the shaft. flat: its width from the flat side across to the round side, mm, more than half the
    diameter. towards: unit direction that the flat side faces. The gap between hole and shaft is half the clearance all
    round, at the flat side too. Raises DesignError as `bore` does.
    """
    if not (circles := bore(diameter, clearance, widest, f"{key}.bore")):
        return ()
    radius = circles[0].radius
    height = flat + clearance - radius
    corner = height + 1j * np.sqrt(radius**2 - height**2)
    sweep = 2 * np.pi - 2 * float(np.angle(corner))
    return (Polyline(np.array([corner, np.conj(corner)]) * towards, np.array([np.tan(sweep / 4), 0])),)


# Largest difference from sharp corners, as a share of the shaft's width, at which they are drawn sharp. A smaller value
# draws arcs too short to cut where `bore` is rounded.
SHARP = 0.01


def corners_are_sharp(diameter: float, flat: float, flats: int) -> bool:
    """Whether the flats of a shaft meet in corners, not in parts of its round side. Sizes as for `many_sided_bore`."""
    return bool(flat <= diameter * np.cos(np.pi / flats) * (1 + SHARP))


def corner_radius(diameter: float, clearance: float, flat: float, flats: int) -> float:
    """Greatest radius of the hole for a shaft with flats, mm. Sizes as for `many_sided_bore`."""
    if corners_are_sharp(diameter, flat, flats):
        return float((flat + clearance) / 2 / np.cos(np.pi / flats))
    return (diameter + clearance) / 2


def many_sided_bore(
    diameter: float, clearance: float, flat: float, flats: int, towards: complex, widest: float, key: str
) -> tuple[Circle | Polyline, ...]:
    """The hole for a shaft with 2, 4 or 6 equal flats about a part's axis; none for diameter 0.

    diameter: of the shaft over its corners, mm. flat: distance of opposite flats, mm, less than the diameter. Where the
    flats do not meet, the sides between them are round. towards: unit direction that a flat faces. Otherwise as
    `flattened_bore`.
    """
    reach = corner_radius(diameter, clearance, flat, flats)
    if not (circles := bore(diameter, clearance, widest - 2 * reach + diameter + clearance, f"{key}.bore")):
        return ()
    radius, height = circles[0].radius, (flat + clearance) / 2
    middles = np.exp(2j * np.pi / flats * np.arange(flats))
    if corners_are_sharp(diameter, flat, flats):
        return (Polyline(reach * middles * np.exp(1j * np.pi / flats) * towards),)
    half = float(np.arccos(height / radius))
    corners = radius * np.column_stack([middles * np.exp(-1j * half), middles * np.exp(1j * half)]).ravel()
    bulge = np.tan((np.pi / flats - half) / 2)
    return (Polyline(corners * towards, np.tile([0.0, bulge], flats)),)


@record
class ParallelKey:
    """A parallel key of one section; all in mm.

    thickest: diameter of the largest shaft for it. width, height: size of its section; its keyways have the same width.
    shaft_depth: depth of the keyway in the shaft. hub_depth: depth of the keyway in the part, beyond the bore along the
    centre line. lengths: shortest and longest standard length; none if keys are cut from stock. name: of its section in
    inches; "" of a metric one.
    """

    thickest: float
    width: float
    height: float
    shaft_depth: float
    hub_depth: float
    lengths: tuple[float, float] | None
    name: str = ""

    def bill(self, room: float) -> str:
        """The longest standard key for a part of a thickness `room`, mm, or else a piece of key steel."""
        if self.lengths is None:
            return f"key steel ASME B17.1 {self.name} in square, cut to {mm(room):g}"
        section = f"{self.width:g} x {self.height:g}"
        least, most = self.lengths
        fitting = [length for length in LENGTHS if least <= length <= min(room, most)]
        if not fitting:
            return f"key steel DIN 6880 {section}, cut to {mm(room):g}"
        return f"parallel key DIN 6885-1 A {section} x {fitting[-1]:g}"


# The thinnest shaft with a standard key, mm.
THINNEST = 6.0
# Rows by the largest shaft, mm; the high form. With other numbers no standard key fits the keyway.
# Source: DIN 6885-1, table 1, the same as ISO 773; sections and depths compared with Flender's catalogue MD 30.1,
# lengths up to a width of 16 mm with the table at engineeringhardware.com/guide/standard/din-6885-parallel-keys.
PARALLEL_KEYS = tuple(
    ParallelKey(*row)
    for row in (
        (8, 2, 2, 1.2, 1.0, (6, 20)),
        (10, 3, 3, 1.8, 1.4, (6, 36)),
        (12, 4, 4, 2.5, 1.8, (8, 45)),
        (17, 5, 5, 3.0, 2.3, (10, 56)),
        (22, 6, 6, 3.5, 2.8, (14, 70)),
        (30, 8, 7, 4.0, 3.3, (18, 90)),
        (38, 10, 8, 5.0, 3.3, (22, 110)),
        (44, 12, 8, 5.0, 3.3, (28, 140)),
        (50, 14, 9, 5.5, 3.8, (36, 160)),
        (58, 16, 10, 6.0, 4.3, (45, 180)),
        (65, 18, 11, 7.0, 4.4, (50, 200)),
        (75, 20, 12, 7.5, 4.9, (56, 220)),
        (85, 22, 14, 9.0, 5.4, (63, 250)),
        (95, 25, 14, 9.0, 5.4, (70, 280)),
        (110, 28, 16, 10.0, 6.4, (80, 320)),
        (130, 32, 18, 11.0, 7.4, (90, 360)),
        (150, 36, 20, 12.0, 8.4, (100, 400)),
        (170, 40, 22, 13.0, 9.4, (100, 400)),
        (200, 45, 25, 15.0, 10.4, (110, 400)),
        (230, 50, 28, 17.0, 11.4, (125, 400)),
    )
)
# Standard lengths of keys, mm: DIN 6885-1 as printed in ZAE's catalogue E 040. Between 280 and 400 mm it has 315 and
# 355, other tables 320 and 360; none of these is listed, as a shorter key fits as well.
LENGTHS = (
    6, 8, 10, 12, 14, 16, 18, 20, 22, 25, 28, 32, 36, 40, 45, 50, 56, 63, 70, 80,
    90, 100, 110, 125, 140, 160, 180, 200, 220, 250, 280, 400,
)  # fmt: skip


# Square keys of inch shafts: largest diameter of the shaft and width of the key, in.
# Source: ASME B17.1-1967, tables 1 and 2; the square keys up to 6 1/2 in. With other numbers no stock fits the keyway.
INCH_KEYS = (
    ("7/16", "3/32"), ("9/16", "1/8"), ("7/8", "3/16"), ("5/4", "1/4"), ("11/8", "5/16"), ("7/4", "3/8"),
    ("9/4", "1/2"), ("11/4", "5/8"), ("13/4", "3/4"), ("15/4", "7/8"), ("9/2", "1"), ("11/2", "1-1/4"),
    ("13/2", "1-1/2"),
)  # fmt: skip
# The thinnest inch shaft with a key, exclusive, and the clearance above a key in the hub, in: of that standard.
THINNEST_INCH, OVER_KEY = 0.3125, 0.005


def _inch_key(shaft: float) -> ParallelKey | None:
    """The key for a shaft of whole sixteenths of an inch, mm; None for others and for whole millimetres.

    The depths are those of the standard: half of the key below the edges of the keyway in the shaft.
    """
    sixteenths = shaft / INCH * 16
    is_inch = abs(sixteenths - round(sixteenths)) < 1e-6 and abs(shaft - round(shaft)) > 1e-6
    if not is_inch or shaft <= THINNEST_INCH * INCH:
        return None
    for most, name in INCH_KEYS:
        if shaft <= float(Fraction(most)) * INCH * (1 + 1e-9):
            width = float(sum(map(Fraction, name.split("-")))) * INCH
            edge = (shaft - float(np.sqrt(shaft**2 - width**2))) / 2
            hub = to_digits(width / 2 - edge + OVER_KEY * INCH, 9)
            thickest = float(Fraction(most)) * INCH
            return ParallelKey(thickest, to_digits(width, 9), width, to_digits(edge + width / 2, 9), hub, None, name)
    return None


def key_of(shaft: float) -> ParallelKey | None:
    """The key for a shaft of a diameter, mm; None if the standard has none.

    A shaft of whole sixteenths of an inch, from 3/8 in on, has that of ASME B17.1. The upper end of a range belongs to
    it: a shaft of 10 mm has a key 3 mm wide.
    """
    if (inch_key := _inch_key(shaft)) is not None:
        return inch_key
    if shaft < THINNEST:
        return None
    return next((key for key in PARALLEL_KEYS if shaft <= key.thickest), None)


# Default interference, mm: twice the error of lasers and printers, so that the hole still grips. It stretches a hole of
# 5 mm by 2 %, which wood and plastics withstand. More cracks acrylic; with less the part may slip on its shaft.
INTERFERENCE = 0.1
# Distance from the flat to the round side of motors' D-shafts, mm, by their diameter: small gear motors (3, 4 and 6),
# stepping motors (5) and larger ones (8), from makers' drawings; chosen here. For other shafts the user gives `flat`.
MOTOR_FLATS = {3.0: 2.5, 4.0: 3.5, 5.0: 4.5, 6.0: 5.5, 8.0: 7.5}
# Largest difference of the diameters of equal shafts, mm: that of a metric one given in inches with four digits.
SAME_SHAFT = 0.002
SHAFTS = ", ".join(f"{flat:g} for {shaft:g}" for shaft, flat in MOTOR_FLATS.items())
BoreForm = Literal["round", "D", "double-D", "square", "hexagonal", "keyed"]
# Fits by the clearance or the interference of a stock, not by ISO 286.
FITS_BY_PLAY = ("running", "press")
# Number of flats of forms with flats.
FLATS: dict[str, Literal[1, 2, 4, 6]] = {"D": 1, "double-D": 2, "square": 4, "hexagonal": 6}


def bore_form_entry(bore: str = "the bore") -> Any:
    """The field for the form of a bore; bore: its name in the meaning."""
    meaning = (
        f"form of {bore}: for a round shaft, a shaft with one or two flats, a square or hexagonal one, or with the "
        "keyway of DIN 6885-1 or, in a bore of whole sixteenths of an inch, of ASME B17.1"
    )
    return entry(meaning, default="round")


def flat_across() -> Any:
    """The field for the flat side of a D-shaft."""
    meaning = (
        f"of a D-shaft, from its flat side across to the round side; if omitted, a motor's: {SHAFTS}; "
        "of a shaft with two flats, a square or hexagonal one, the distance of opposite flats"
    )
    return quantity(meaning, "mm", default=None, above=0, at_most=FARTHEST)


def keyway_width(bore: str = "the bore") -> Any:
    """The field for the width of the keyway in a bore."""
    meaning = f"width of the keyway in {bore}; 0 for none or, in a keyed bore, for the standard width"
    return quantity(meaning, "mm", default=0.0, at_least=0, at_most=FARTHEST)


def keyway_depth(bore: str = "the bore") -> Any:
    """The field for the depth of the keyway in a bore."""
    meaning = f"depth of the keyway beyond {bore}, along its centre line"
    return quantity(meaning, "mm", default=0.0, at_least=0, at_most=FARTHEST)


def fit_entry(bore: str = "the bore") -> Any:
    """The field for the fit of a bore."""
    meaning = (
        f"{bore} runs on its shaft with the clearance, is a press fit with the interference, or has a fit of ISO 286 "
        'such as "H7/g6"; running, press or a fit'
    )
    return entry(meaning, default="running")


def bore_tolerance(bore: str = "the bore") -> Any:
    """The field for the tolerance class of a bore."""
    meaning = f'tolerance class of {bore} by ISO 286, such as "H7", in place of the clearance'
    return entry(meaning, default="")


def interference() -> Any:
    """The field for the interference of press fits."""
    meaning = "interference of a press-fit bore; below 0 if holes come out narrower than drawn, as on printers"
    return quantity(meaning, "mm", default=INTERFERENCE, at_least=-1, at_most=FARTHEST)


@record(checked=True)
class AbstractBored:
    """Base class of stock tables of parts on a shaft; all lengths in mm.

    Raises
    ------
    DesignError
        If a size is out of range, or if bore, form, flat and keyway contradict each other.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the shaft", 0.0, fitted=True)
    bore_form: BoreForm = bore_form_entry()
    flat: float | None = flat_across()
    keyway_width: float = keyway_width()
    keyway_depth: float = keyway_depth()
    fit: Fit = fit_entry()
    bore_tolerance: HoleTolerance = bore_tolerance()
    interference: float = interference()
    clearance: float = clearance(0.0)
    motor: MountedMotorKey | None = mounted_motor_entry(
        "motor that drives the part; adds the motor's mounting plate, or its holes in a base"
    )
    material: MaterialKey | None = material_entry("the part")

    def __post_init__(self) -> None:
        self._check_bore()

    def with_round_bore(self, diameter: float, **changes: Any) -> Self:
        """The table for a round bore on another shaft, which no motor turns."""
        plain = {"bore_form": "round", "flat": None, "keyway_width": 0.0, "keyway_depth": 0.0, "motor": None}
        return replace(self, bore=diameter, **plain, **changes)  # type: ignore[arg-type]

    @property
    def motor_parts(self) -> tuple[Part, ...]:
        """The motor's mounting plate, about the part's axis; empty without a motor."""
        return () if self.motor is None else (motor_plate(self.motor, self.thickness, self.clearance),)

    @property
    def hub_length(self) -> float:
        """Length of the motor's shaft that a hub on the part engages, mm."""
        return 0.0

    def engagement_checks(self, is_on_base: bool) -> Iterator[Check]:
        """Whether the part engages the shaft of its motor.

        is_on_base: whether it lies on a base as thick as the part, not over the motor's own plate.
        """
        if self.motor is not None and self.bore:
            below = self.thickness + (0.0 if is_on_base else HEADS)
            yield engagement_check(self.motor, self.thickness + self.hub_length, below)

    @property
    def play(self) -> float:
        """How much wider the bore is drawn than its shaft, mm; usually negative for a press fit."""
        if self.limits is not None:
            return self.limits.middle
        return self.clearance if self.fit == "running" else -self.interference

    @property
    def iso_fit(self) -> str:
        """Tolerance class of the bore by ISO 286, or those of bore and shaft; "" for none."""
        return self.bore_tolerance or (self.fit if self.fit not in FITS_BY_PLAY else "")

    @property
    def limits(self) -> FitLimits | None:
        """Limits of the bore and its shaft by ISO 286; None without such a fit or a bore."""
        return fit_limits(self.iso_fit, self.bore) if self.iso_fit and self.bore else None

    @property
    def is_pressed(self) -> bool:
        """Whether the bore is pressed on its shaft."""
        return self.fit == "press" if self.limits is None else self.limits.is_press

    @property
    def hole_diameter(self) -> float:
        """Diameter of a round hole in which the shaft runs, as in a base plate, mm; 0 for none."""
        return widened(self.bore, self.clearance)

    @property
    def running_fits(self) -> tuple[HoleFit, ...]:
        """The fit of such a round hole; empty for diameter 0."""
        return fits_of(self.bore, self.clearance)

    @property
    def fits(self) -> tuple[HoleFit, ...]:
        """The fit of the bore; empty for diameter 0."""
        if not self.bore:
            return ()
        flat = 0.0 if self.across_flat is None else self.across_flat + self.play
        flats = FLATS.get(self.bore_form, 1)
        return (
            HoleFit(
                self.bore, self.play, flat, self.keyway, flats=flats, is_press=self.is_pressed, iso_fit=self.iso_fit
            ),
        )

    @property
    def hole_reach(self) -> float:
        """Radius of the circle that contains bore and keyway, mm."""
        if self.across_flat is not None and (flats := FLATS[self.bore_form]) > 1:
            return corner_radius(self.bore, self.play, self.across_flat, flats)
        width, depth = self.keyway
        return float(abs(widened(self.bore, self.play) / 2 + depth + 0.5j * width))

    @property
    def keyway(self) -> tuple[float, float]:
        """Width of the keyway, and its depth beyond the bore, mm; 0 for none."""
        given = self.keyway_width, self.keyway_depth
        if self.bore_form != "keyed" or any(given) or not (key := key_of(self.bore)):
            return given
        return key.width, key.hub_depth

    @property
    def across_flat(self) -> float | None:
        """Distance from the flat of a D-shaft to its round side, or of opposite flats, mm; None for other shafts."""
        if self.bore_form not in FLATS:
            return None
        if self.flat is not None:
            return self.flat
        face = None if self.motor is None else face_of(self.motor)
        if face is not None and abs(face.shaft - self.bore) < SAME_SHAFT and face.bore_form == self.bore_form:
            return face.flat
        if (flats := FLATS[self.bore_form]) > 2:
            return self.bore * cos(pi / flats)
        if flats == 2:
            return None
        return next((flat for shaft, flat in MOTOR_FLATS.items() if abs(shaft - self.bore) < SAME_SHAFT), None)

    def hole(self, towards: complex, widest: float, key: str) -> tuple[Circle | Polyline, ...]:
        """The bore about the part's axis; empty for diameter 0.

        Parameters
        ----------
        towards : complex
            Unit direction of the keyway, or that the flat side faces.
        widest : float
            Least width of the part round the bore, mm.
        key : str
            Key of the stock in the recipe, for messages.
        """
        if (across := self.across_flat) is not None:
            if (flats := FLATS[self.bore_form]) > 1:
                return many_sided_bore(self.bore, self.play, across, flats, towards, widest, key)
            return flattened_bore(self.bore, self.play, across, towards, widest, key)
        if any(keyway := self.keyway):
            return keyed_bore(self.bore, self.play, *keyway, towards, widest, key)
        return bore(self.bore, self.play, widest, f"{key}.bore")

    def _check_bore(self) -> None:
        """DesignError for sizes that contradict each other, independent of the part."""
        if self.bore_form != "round" and not self.bore:
            problem = f'found {mm(0):g}, which means no hole, and bore_form = "{self.bore_form}"'
            raise DesignError("bore", problem, 'give the shaft\'s diameter, or bore_form = "round"', "conflict")
        if self.flat is not None and self.bore_form not in FLATS:
            problem = f"found {mm(self.flat):g} for a bore without a flat"
            raise DesignError("flat", problem, 'omit it, or give bore_form = "D"', "conflict")
        if self.motor is not None and self.bore >= (boss := face_of(self.motor).boss_diameter):
            problem = f"found {mm(self.bore):g} on the shaft of {self.motor}, whose boss is {mm(boss):g} wide"
            remedy = f"give less than {mm(boss):down}, or omit motor"
            raise DesignError("bore", problem, remedy, value=inside(boss, 1))
        if self.bore_form in FLATS:
            self._check_flat()
        if self.bore_tolerance and self.fit != "running":
            problem = f"found {self.bore_tolerance}, and fit = {self.fit}"
            raise DesignError("bore_tolerance", problem, "give one of both", "conflict")
        # Raises DesignError for a size that the standard does not have.
        if self.limits is None and self.fit == "press":
            self._check_interference()
        if self.bore_form == "keyed" and not self.keyway_width and not self.keyway_depth and not key_of(self.bore):
            thickest = PARALLEL_KEYS[-1].thickest
            nearest = f"at least {mm(THINNEST):up}" if self.bore < THINNEST else f"at most {mm(thickest):down}"
            raise DesignError(
                "bore",
                f"found {mm(self.bore):g}, but DIN 6885-1 has keys for shafts of "
                f"{mm(THINNEST, thickest, between=' to '):g} only",
                f'give {nearest}, your own keyway_width and keyway_depth, or bore_form = "D"',
                "out-of-range",
            )

    def _check_interference(self) -> None:
        """DesignError for an interference that leaves no hole at the narrowest width of the shaft."""
        narrowest = self.across_flat or self.bore
        if 0 < narrowest < self.interference + SMALLEST:
            problem = f"found {mm(self.interference):g}, which leaves no hole for a shaft {mm(narrowest):g} across"
            value = rounded_down(narrowest - SMALLEST) if narrowest > SMALLEST else None
            remedy = "give a thicker shaft" if value is None else f"give at most {mm(narrowest - SMALLEST):down}"
            raise DesignError("interference", problem, remedy, value=value)

    def _check_flat(self) -> None:
        half, across = (self.bore / 2 if self.bore_form == "D" else 0.0), self.across_flat
        if across is None and self.bore_form == "double-D":
            remedy = f"give the distance of the flats, less than {mm(self.bore):down6}"
            raise DesignError("flat", 'is missing for bore_form = "double-D"', remedy, "missing-key")
        if across is None:
            shafts = f"{bare_mm(*MOTOR_FLATS):g}"
            raise DesignError(
                "bore",
                f"found {mm(self.bore):g}, which is no usual diameter of a D-shaft",
                f"give one of {shafts}, or give flat, more than {bare_mm(half):up} and less than {mm(self.bore):down6}",
                "out-of-range",
            )
        if (flats := FLATS[self.bore_form]) > 2:
            half = (1 - SHARP) * self.bore * cos(pi / flats)
        if not half < across < self.bore:
            problem = f"found {mm(across):g} across a shaft of {mm(self.bore):g}"
            remedy = f"give more than {bare_mm(half):up} and less than {mm(self.bore):down}"
            raise DesignError("flat", problem, remedy, "out-of-range", inside(self.bore, 1))
        for name, size in (("keyway_width", self.keyway_width), ("keyway_depth", self.keyway_depth)):
            if size:
                problem = f"found {mm(size):g} in a bore with a flat"
                raise DesignError(name, problem, 'give 0, or bore_form = "keyed"', "conflict")
