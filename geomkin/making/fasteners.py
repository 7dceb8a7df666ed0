"""Fasteners that hold plates together: screws with nuts, rods, and printed pins that snap in; and the items to buy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from math import hypot, pi, sqrt, tan
from typing import Annotated, Any, Literal

import numpy as np

from ..core.errors import DesignError, shown
from ..core.field_visitor import WrittenForm
from ..core.fields import last_fit, to_digits
from ..core.records import record
from ..core.units import INCH, mm
from ..model.check import Check
from ..model.material import Material
from ..model.part import Bought, Part
from ..plane.measure import signed_area
from ..plane.primitives import Polyline


@record
class Series:
    """What the screws of metric or of inch threads have in common.

    washer, rod: product and standard of washers and of threaded rods. lengths: standard lengths of screws, mm, and the
    text of each in a bill.
    """

    washer: str
    rod: str
    lengths: Mapping[float, str]


@record
class Size:
    """A screw size; all in mm.

    thread: designation. screw, nut: product and standard. head: diameter and height of the screw's head. lengths:
    shortest and longest screw. nut_width, nut_height: size of the nut across corners and along the screw. pitch: pitch
    of the thread, by which the screw's end projects from the nut at least. washer: its outer diameter and thickness.
    """

    thread: str
    series: Series
    screw: str
    head: tuple[float, float]
    lengths: tuple[float, float]
    nut: str
    nut_width: float
    nut_height: float
    pitch: float
    washer: tuple[float, float]

    @property
    def across(self) -> float:
        """Largest diameter of head, nut and washer, mm."""
        return max(self.head[0], self.nut_width, self.washer[0])


def _inch_size(
    thread: str, head: tuple[float, float], lengths: tuple[float, float], nut: str, nut_width: float, nut_height: float,
    washer: tuple[float, float],
) -> Size:  # fmt: skip
    """A size of an inch thread, from lengths in inches."""
    (across, high), (least, most), (outer, thickness) = head, lengths, washer
    return Size(
        thread, UNIFIED, INCH_BUTTON, (INCH * across, INCH * high), (INCH * least, INCH * most), nut, INCH * nut_width,
        INCH * nut_height, INCH / float(thread.rpartition("-")[2]), (INCH * outer, INCH * thickness),
    )  # fmt: skip


# Standard lengths of screws (ISO 888).
LENGTHS = (3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 80)
METRIC = Series("washer ISO 7089", "threaded rod DIN 976-1", {float(length): f"{length}" for length in LENGTHS})
# The usual lengths of inch screws.
INCH_LENGTHS = (
    "1/8", "3/16", "1/4", "5/16", "3/8", "1/2", "5/8", "3/4", "7/8", "1", "1-1/4", "1-1/2", "1-3/4", "2", "2-1/4",
    "2-1/2", "2-3/4", "3",
)  # fmt: skip
UNIFIED = Series(
    "washer ASME B18.21.1",
    "threaded rod ASME B18.31.3",
    {INCH * float(sum(map(Fraction, length.split("-")))): f"{length} in" for length in INCH_LENGTHS},
)
BUTTON, CAP = "button head screw ISO 7380-1", "cap screw ISO 4762"
LOCK, PLAIN = "lock nut ISO 7040", "nut ISO 4032"
INCH_BUTTON = "button head screw ASME B18.3"
INCH_LOCK, INCH_PLAIN = "lock nut ASME B18.16.6", "nut ASME B18.6.3"
# Sizes by diameter, mm: the upper limits of the named standards. ISO 7380-1 and ISO 7040 begin at M3. Inch lock nuts
# begin at #4; lengths of inch screws are those that shops sell, beyond the longest of ASME B18.3.
SIZES: dict[float, Size] = {
    1.6: Size("M1.6", METRIC, CAP, (3.0, 1.6), (3, 16), PLAIN, 3.41, 1.3, 0.35, (4.0, 0.3)),
    2.0: Size("M2", METRIC, CAP, (3.8, 2.0), (3, 20), PLAIN, 4.32, 1.6, 0.4, (5.0, 0.3)),
    2.5: Size("M2.5", METRIC, CAP, (4.5, 2.5), (4, 25), PLAIN, 5.45, 2.0, 0.45, (6.0, 0.5)),
    3.0: Size("M3", METRIC, BUTTON, (5.7, 1.65), (6, 30), LOCK, 6.01, 4.5, 0.5, (7.0, 0.5)),
    4.0: Size("M4", METRIC, BUTTON, (7.6, 2.2), (8, 40), LOCK, 7.66, 6.0, 0.7, (9.0, 0.8)),
    5.0: Size("M5", METRIC, BUTTON, (9.5, 2.75), (10, 50), LOCK, 8.79, 6.8, 0.8, (10.0, 1.0)),
    6.0: Size("M6", METRIC, BUTTON, (10.5, 3.3), (10, 60), LOCK, 11.05, 8.0, 1.0, (12.0, 1.6)),
    8.0: Size("M8", METRIC, BUTTON, (14.0, 4.4), (12, 80), LOCK, 14.38, 9.5, 1.25, (16.0, 1.6)),
    2.1844: _inch_size("#2-56", (0.164, 0.046), (0.125, 0.5), INCH_PLAIN, 0.217, 0.066, (0.25, 0.02)),
    2.8448: _inch_size("#4-40", (0.213, 0.059), (0.1875, 1), INCH_LOCK, 0.289, 0.163, (0.312, 0.032)),
    3.5052: _inch_size("#6-32", (0.262, 0.073), (0.25, 1.5), INCH_LOCK, 0.361, 0.188, (0.375, 0.049)),
    4.1656: _inch_size("#8-32", (0.312, 0.087), (0.25, 2), INCH_LOCK, 0.397, 0.239, (0.438, 0.049)),
    4.826: _inch_size("#10-24", (0.361, 0.101), (0.25, 2), INCH_LOCK, 0.433, 0.249, (0.5, 0.049)),
    6.35: _inch_size("1/4-20", (0.437, 0.132), (0.375, 3), INCH_LOCK, 0.505, 0.328, (0.625, 0.065)),
    7.9375: _inch_size("5/16-18", (0.547, 0.166), (0.5, 3), INCH_LOCK, 0.577, 0.359, (0.688, 0.065)),
}
DIAMETERS = {size.thread: diameter for diameter, size in SIZES.items()}
THREADS = ", ".join(DIAMETERS)


def size_of(diameter: float) -> Size | None:
    """The screw size of a diameter, mm; None if there is no standard one."""
    # Without its last digits, since 0.138 in is a little more than 3.5052 mm.
    return SIZES.get(round(diameter, 9))


def screw_text(diameter: float) -> str:
    """The name of a screw of a diameter, mm, such as "screw 4 mm" or "screw #6-32"."""
    size = size_of(diameter)
    return f"screw {size.thread}" if size and size.series is UNIFIED else f"screw {mm(diameter):g}"


class ThreadOrDiameter(WrittenForm):
    """Marks a diameter, mm, that a recipe may also give as the name of a thread, such as "M4", "#6-32" or "1/4-20"."""

    def read(self, given: Any, folder: Any) -> Any:
        if isinstance(given, str) and given not in DIAMETERS:
            raise DesignError("", f"found {shown(given)}", f"give a diameter, or a thread: {THREADS}", "wrong-type")
        return DIAMETERS[given] if isinstance(given, str) else given

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        size = size_of(value)
        return size.thread if size and size.series is UNIFIED else value

    def schema(self, plain: dict[str, Any]) -> dict[str, Any]:
        return {"anyOf": [plain, {"type": "string", "enum": list(DIAMETERS)}]}


ThreadDiameter = Annotated[float, ThreadOrDiameter()]
# Largest height of a nut, in sheets. More would need stacks of many spacers on a pin; fewer would exclude screws in
# thin card.
MOST_SHEETS = 20
# Difference of nominal and pitch diameter of a metric thread, in pitches (ISO 724).
PITCH_DEPTH = 0.6495
# Difference of nominal and minor diameter of a screw's thread, in pitches (ISO 724).
MINOR_DEPTH = 1.2269


@record
class Fastener:
    """The fastener of pins of one diameter.

    form: "screw" is a screw of a standard length with a nut and a washer or, if no screw is long enough, a threaded rod
    with a nut and a washer at each end. "rod" is a plain rod, cut flush and glued or pressed into the plate at each end
    that moves with it. play: axial play, mm, so that plates can rotate. head_height: height of the head, mm, if it is
    not that of the standard. tolerance: tolerance class of a rod by ISO 286, such as "g6". "snap" is a
    printed pin, a `SnapPin`.
    """

    diameter: float
    form: Literal["screw", "rod", "snap"]
    play: float
    head_height: float | None = None
    tolerance: str = ""

    @cached_property
    def size(self) -> Size | None:
        """The screw size; None if there is no standard one."""
        return size_of(self.diameter)

    @property
    def across(self) -> float:
        """Largest diameter that projects at either end, mm."""
        return self.diameter if self.form == "rod" or self.size is None else self.size.across

    def length(self, grip: float) -> float | None:
        """The standard length for plates of a thickness `grip`, mm; None for a rod."""
        if self.form == "rod" or self.size is None:
            return None
        low, high = self.size.lengths
        least = max(low, self._threaded(self.size, grip))
        return next((length for length in self.size.series.lengths if least <= length <= high), None)

    def ends(self, grip: float) -> tuple[float, float]:
        """Largest projection of head and nut beyond plates of a thickness `grip`, mm."""
        if self.form == "rod" or self.size is None:
            return 0.0, 0.0
        length = self.length(grip)
        if length is None:
            end = self.size.washer[1] + self.size.nut_height + self.size.pitch + self.play
            return end, end
        head = self.size.head[1] if self.head_height is None else self.head_height
        return head + self.play, length - grip

    def rod(self, length: float) -> tuple[str, int]:
        """The item of a plain rod of a length, mm."""
        size = f"{mm(self.diameter):g} {self.tolerance}".rstrip()
        return f"rod {size}, cut to {mm(length):g}", 1

    def bill(self, grip: float) -> tuple[tuple[str, int], ...]:
        """The items of one joint: name and number of each."""
        if self.form == "rod" or self.size is None:
            return (self.rod(grip + self.play),)
        thread, series, length = self.size.thread, self.size.series, self.length(grip)
        ends = 1 if length else 2
        nuts = (f"{thread} {series.washer}", ends), (f"{thread} {self.size.nut}", ends)
        if length is None:
            rod = self._rod_length(self.size, grip)
            return (f"{thread} {series.rod}, cut to {mm(rod):.1f}", 1), *nuts
        return (f"{thread} x {series.lengths[length]} {self.size.screw}", 1), *nuts

    def volume(self, grip: float) -> float:
        """Volume of the items of one joint through plates of a thickness `grip`, mm3: rod or screw, washers and nuts.

        Threads count with their pitch diameter; sockets and rounded edges of heads are neglected.
        """
        if self.form == "rod" or self.size is None:
            return _disc(self.diameter) * (grip + self.play)
        size, length = self.size, self.length(grip)
        outer, thickness = size.washer
        washer = (_disc(outer) - _disc(self.diameter)) * thickness
        # Area of a hexagon from its width across corners.
        nut = (3 * sqrt(3) / 8 * size.nut_width**2 - _disc(self.diameter)) * size.nut_height
        thread = _disc(self.diameter - PITCH_DEPTH * size.pitch)
        if length is None:
            return thread * self._rod_length(size, grip) + 2 * (washer + nut)
        across, high = size.head
        # A button head is a segment of a ball.
        head = (
            pi * high * (across**2 / 8 + high**2 / 6) if size.screw in (BUTTON, INCH_BUTTON) else _disc(across) * high
        )
        return head + thread * length + washer + nut

    def _rod_length(self, size: Size, grip: float) -> float:
        """Length of a threaded rod with washer and nut at both ends, mm."""
        return self._threaded(size, grip) + size.washer[1] + size.nut_height + size.pitch

    def _threaded(self, size: Size, grip: float) -> float:
        """Least length under the head, mm: plates, play, washer, nut, and one pitch beyond the nut."""
        return grip + self.play + size.washer[1] + size.nut_height + size.pitch


def _disc(diameter: float) -> float:
    return pi / 4 * diameter**2


def fastener_of(
    diameter: float, thickness: float, form: Literal["screw", "rod"] | None, play: float, head_height: float | None
) -> Fastener:
    """The fastener for a pin diameter and a sheet thickness, mm.

    If no form is given: a screw if the diameter is that of a thread and the nut is at most `MOST_SHEETS` sheets high,
    otherwise a rod. Raises DesignError if a requested screw does not meet these conditions.
    """
    if form == "screw" and not size_of(diameter):
        problem = f"found a screw, but there is no screw size of {mm(diameter):g}"
        remedy = f'give pin_diameter as one of {THREADS}, or fastener = "rod"'
        raise DesignError("fastener", problem, remedy, "conflict")
    screw = Fastener(diameter, "screw", play, head_height)
    is_too_high = max(screw.ends(thickness)) > MOST_SHEETS * thickness
    if form == "screw" and is_too_high:
        sheets = max(screw.ends(thickness)) / thickness
        problem = f"found a screw, whose nut is as high as {sheets:.0f} sheets; the limit is {MOST_SHEETS}"
        raise DesignError("fastener", problem, 'give a thicker sheet, a thinner pin, or fastener = "rod"', "conflict")
    fits = size_of(diameter) is not None and not is_too_high
    return Fastener(diameter, form or ("screw" if fits else "rod"), play, head_height)


def gathered(bills: list[tuple[str, tuple[tuple[str, int], ...]]]) -> tuple[Bought, ...]:
    """The bill of all joints, from the bill of each joint: one line for equal items, in the order of first use."""
    entries: dict[str, tuple[int, list[str]]] = {}
    for joint, items in bills:
        for name, count in items:
            number, joints = entries.setdefault(name, (0, []))
            entries[name] = number + count, joints if joint in joints else [*joints, joint]
    return tuple(Bought(name, count, tuple(joints)) for name, (count, joints) in entries.items())


# Sizes in diameters of the pin, chosen here. Width and thickness of the shank, whose edges lie on the pin's circle:
# printed on its side, no layer lies across its axis. With a thicker one its legs become too thin.
WIDTH, THICKNESS = sqrt(3) / 2, 0.5
# Width and height of the head; width of the barbs beyond the hole, at their corners, and the length of their lands.
HEAD_WIDTH, HEAD_HEIGHT, CATCH, LAND = 1.6, 0.4, 0.12, 0.15
# Inclination of the tips that spread the hole's reaction: with a steeper one the pin needs a hammer.
TIP_ANGLE = pi / 6
# Thinnest leg that printers draw with two lines, mm.
THINNEST_LEG = 0.7
# Largest strain of the legs as they snap in: data sheets have 2 to 4 % at yield for PLA, PETG and ABS.
MOST_STRAIN = 0.03
# Axial play of pins in gears and cams, mm, as the default one of linkages.
PLAY = 0.2


# Diameter of a pin whose legs are thick enough with any clearance, mm.
WIDEST = 100.0


def _barb(diameter: float, clearance: float) -> float:
    return sqrt(((diameter + clearance) / 2 + CATCH * diameter) ** 2 - (THICKNESS * diameter / 2) ** 2)


def _deflection(diameter: float, clearance: float) -> float:
    hole = (diameter + clearance) / 2
    return _barb(diameter, clearance) - sqrt(hole**2 - (THICKNESS * diameter / 2) ** 2)


def _leg(diameter: float, clearance: float) -> float:
    return WIDTH * diameter / 2 - _deflection(diameter, clearance)


@record
class SnapPin(Fastener):
    """A printed pin; its holes are wider by the clearance, mm. density: of its material, kg/m3, 0 if unknown."""

    clearance: float = 0.0
    density: float = 0.0

    def __post_init__(self) -> None:
        if self.leg < THINNEST_LEG:
            problem = f"found snap, but legs of a pin of {mm(self.diameter):g} are {mm(max(self.leg, 0.0)):.2g} thick"
            least = last_fit(lambda diameter: _leg(diameter, self.clearance) >= THINNEST_LEG, WIDEST, self.diameter)
            raise DesignError("printing.pins", problem, f"give pins of at least {mm(least):up}", "conflict")

    @property
    def thickness(self) -> float:
        """Of the part as it lies on the bed, mm."""
        return THICKNESS * self.diameter

    @cached_property
    def barb(self) -> float:
        """Half the width across the barbs, mm."""
        return _barb(self.diameter, self.clearance)

    @property
    def deflection(self) -> float:
        """By how much each barb moves inwards to pass the hole, mm."""
        return _deflection(self.diameter, self.clearance)

    @property
    def leg(self) -> float:
        """Thickness of a leg, mm: the slit between both lets them meet."""
        return _leg(self.diameter, self.clearance)

    @property
    def across(self) -> float:
        return max(hypot(HEAD_WIDTH * self.diameter, self.thickness), 2 * hypot(self.barb, self.thickness / 2))

    @property
    def _tip(self) -> float:
        """Half the width of the pin at its tip, mm."""
        return self.deflection + self.leg / 2

    def length(self, grip: float) -> float | None:
        return grip + self.play

    def ends(self, grip: float) -> tuple[float, float]:
        tip = LAND * self.diameter + (self.barb - self._tip) / tan(TIP_ANGLE)
        return HEAD_HEIGHT * self.diameter + self.play, tip + self.play

    def bill(self, grip: float) -> tuple[tuple[str, int], ...]:
        return ()

    def volume(self, grip: float) -> float:
        return self.thickness * signed_area(self.outline(grip))

    def outline(self, grip: float) -> Polyline:
        """The pin seen from the bed, its head at x < 0, for plates of a thickness `grip`, mm."""
        d, slit, end = self.diameter, self.deflection, grip + self.play
        last = end + self.ends(grip)[1] - self.play
        shank, head = WIDTH * d / 2, HEAD_WIDTH * d / 2
        side = np.array(
            [-HEAD_HEIGHT * d + head * 1j, head * 1j, shank * 1j, end + shank * 1j, end + self.barb * 1j,
             end + LAND * d + self.barb * 1j, last + self._tip * 1j, last + slit * 1j, slit * (1 + 1j)]
        )  # fmt: skip
        # From below the head round the tip of the lower leg, then round the end of the slit, then back.
        bulges = np.zeros(2 * len(side))
        bulges[len(side) - 1] = -1.0
        return Polyline(np.concatenate([np.conj(side), side[::-1]]), bulges)

    def strain(self, grip: float) -> float:
        """Largest strain of a leg as it snaps in: of a beam of constant section, clamped at the end of the slit.

        Source: Bayer MaterialScience, Snap-Fit Joints for Plastics, deflection of a rectangular beam.
        """
        return 1.5 * self.leg * self.deflection / (grip + self.play - self.deflection) ** 2


@record(eq=False)
class PinPlace:
    """A snap pin at a joint: its letter, the thickness of the plates on it, mm, and the material to print it of."""

    letter: str
    pin: SnapPin
    grip: float
    material: Material | None = None


def alike(places: Sequence[PinPlace]) -> dict[str, list[PinPlace]]:
    """Equal pins, by the name of their part: that of their first joint."""
    groups: dict[tuple[SnapPin, float], list[PinPlace]] = {}
    for place in places:
        groups.setdefault((place.pin, round(place.grip, 9)), []).append(place)
    return {f"pin_{group[0].letter}": group for group in groups.values()}


def pin_parts(places: Sequence[PinPlace]) -> tuple[Part, ...]:
    """The parts of all pins."""
    return tuple(
        Part(
            name,
            group[0].pin.outline(group[0].grip),
            (),
            to_digits(group[0].pin.thickness),
            count=len(group),
            material=group[0].material,
            joints=tuple(place.letter for place in group),
        )
        for name, group in alike(places).items()
    )


def snap_checks(places: Sequence[PinPlace]) -> tuple[Check, ...]:
    """Check of the largest strain of all pins; empty without any."""
    if not places:
        return ()
    strain, letter = max((place.pin.strain(place.grip), place.letter) for place in places)
    advice = f"the shortest pins, such as {letter}, break: give thicker plates, or thinner pins"
    return (Check("snap_strain", "strain of snap pins", 100 * strain, "at most", 100 * MOST_STRAIN, "%", advice),)
