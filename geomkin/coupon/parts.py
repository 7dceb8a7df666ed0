"""A fit test: its sizes, its coupon and gauge, and its scene."""

from __future__ import annotations

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import quantity, rounded_down
from ..core.records import record
from ..core.units import UNITS, Units, mm
from ..export.text import HEIGHTS, MARGIN, strokes_of
from ..model.material import Material
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneBody, SceneMark
from ..model.table import Column, Table
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle, Polyline, rounded_hull
from ..plane.vec import Complex, Real

# Smallest opening, mm: a narrower one is closed by most beams and printers.
NARROWEST_OPENING = 0.2


@record(checked=True)
class FitTest:
    """Openings of a fit test, in equal steps around the size of what goes into them.

    Raises
    ------
    DesignError
        If a size is out of range, or the smallest opening would be narrower than 0.2 mm.

    Examples
    --------
    >>> gk.coupon.FitTest(pin=3, step=0.1, count=5).hole_diameters
    array([2.8, 2.9, 3. , 3.1, 3.2])
    """

    pin: float = quantity("diameter of the pin, screw or shaft to try", "mm", at_least=0.5, at_most=50, example=3.0)
    thickness: float = quantity("thickness of the sheet, as measured", "mm", default=3.0, at_least=0.5, at_most=20)
    step: float = quantity("difference between neighbouring openings", "mm", default=0.1, at_least=0.01, at_most=1)
    count: int = quantity("number of holes, and of slots", default=9, whole=True, at_least=5, at_most=25)

    def __post_init__(self) -> None:
        below = self.count // 2
        for name, size in (("pin", self.pin), ("thickness", self.thickness)):
            largest = (size - NARROWEST_OPENING) / below
            if self.step > largest * (1 + 1e-9):
                opening = size - below * self.step
                problem = f"found {mm(self.step):g}, with which the smallest opening for {name} = {mm(size):g} and "
                problem += f"count = {self.count} would be {mm(opening):.4g} wide"
                remedy = f"give at most {mm(largest):down3}"
                raise DesignError("step", problem, remedy, "conflict", rounded_down(largest, 3))

    @property
    def offsets(self) -> Real:
        """Difference of each opening from the nominal size, mm, shape (count,)."""
        return np.round(self.step * (np.arange(self.count) - self.count // 2), 9)

    @property
    def hole_diameters(self) -> Real:
        """Diameter of each hole, mm, shape (count,)."""
        return np.round(self.pin + self.offsets, 9)

    @property
    def slot_widths(self) -> Real:
        """Width of each slot, mm, shape (count,)."""
        return np.round(self.thickness + self.offsets, 9)

    @property
    def table(self) -> Table:
        """The openings, one row for each hole and its slot."""
        return Table(
            (
                Column("number", "", "number of the hole and of the slot, from the left", np.arange(1, self.count + 1)),
                Column("hole_diameter", "mm", "diameter of the hole", self.hole_diameters),
                Column("slot_width", "mm", "width of the slot", self.slot_widths),
                Column("difference", "mm", "hole minus pin, and slot minus sheet", self.offsets),
            )
        )


# Width and length of the gauge, mm. A wider one shows the same kerf; a narrower one breaks.
GAUGE_WIDTH, GAUGE_LENGTH = 10.0, 60.0
# Corner radius of coupon and gauge, mm: the gauge enters its slots more easily.
CORNER = 1.0
# How much longer a slot is than the gauge is wide, mm, so that the gauge touches only its sides.
END_PLAY = 2.0
# Least material between openings and to the edge, mm, for thin sheets.
THINNEST_WALL = 3.0
# Height of the letters, and space reserved above each opening for its size, mm.
HEIGHT = HEIGHTS[-1]
LETTERING = HEIGHT + 2 * MARGIN


@checked
def fit_test_parts(fit_test: FitTest, material: Material | None = None, units: Units = "mm") -> tuple[Part, Part]:
    """The coupon and the gauge of a fit test.

    Parameters
    ----------
    fit_test : FitTest
        Its sizes.
    material : Material, optional
        Material of the sheet or print.
    units : {"mm", "in"}, optional
        Unit of the engraved sizes.

    Returns
    -------
    tuple of Part
        The coupon, with a row of slots below a row of holes, growing to the right, and the size of each engraved
        above it; and the gauge, a bar 10 mm wide.

    Raises
    ------
    DesignError
        If an argument is out of range.

    Examples
    --------
    >>> coupon, gauge = gk.coupon.fit_test_parts(gk.coupon.FitTest(pin=3, count=5))
    >>> [round(2 * hole.radius, 9) for hole in coupon.holes[:5]]
    [2.8, 2.9, 3.0, 3.1, 3.2]
    """
    centres, wall = hole_centres(fit_test, units), _wall(fit_test)
    diameters, widths, slot_length = fit_test.hole_diameters, fit_test.slot_widths, GAUGE_WIDTH + END_PLAY
    holes = [Circle(complex(centre), float(diameter) / 2) for centre, diameter in zip(centres, diameters)]
    slots = [_rectangle(x - width / 2, width, slot_length) for x, width in zip(centres.real, widths)]
    tops = (*(centres + 0.5j * diameters), *(centres.real + 1j * slot_length))
    marks = [
        stroke for name, top in zip(opening_names(fit_test, units), tops) for stroke in _lettering_above(top, name)
    ]
    margin = centres[1].real / 2 + wall
    # With room for the name of the part above the sizes of the holes.
    height = centres[0].imag + diameters[-1] / 2 + 2 * LETTERING + 2 * wall
    outline = _plate(complex(-margin, -wall), centres[-1].real + 2 * margin, height)
    bar = _plate(complex(-margin, -2 * wall - GAUGE_WIDTH), GAUGE_LENGTH, GAUGE_WIDTH)
    thickness = fit_test.thickness
    return (
        Part("coupon", outline, (*holes, *slots), thickness, marks=tuple(marks), body="coupon", material=material),
        Part("gauge", bar, (), thickness, body="gauge", material=material),
    )


def hole_centres(fit_test: FitTest, units: Units = "mm") -> Complex:
    """Centres of the holes, mm, shape (count,), with room for each opening, its wall and its name."""
    largest_hole, widest_slot = float(fit_test.hole_diameters[-1]), float(fit_test.slot_widths[-1])
    longest_name = max(_width(name) for name in opening_names(fit_test, units)) + 2 * MARGIN
    pitch = float(np.ceil(max(largest_hole + _wall(fit_test), widest_slot + _wall(fit_test), longest_name)))
    height = GAUGE_WIDTH + END_PLAY + LETTERING + _wall(fit_test) + largest_hole / 2
    centres: Complex = pitch * np.arange(fit_test.count) + 1j * height
    return centres


def opening_names(fit_test: FitTest, units: Units = "mm") -> tuple[str, ...]:
    """Sizes of the holes, then of the slots, with up to three decimals of mm or four of inches: neighbours differ."""
    sizes, decimals = (*fit_test.hole_diameters, *fit_test.slot_widths), 3 if units == "mm" else 4
    texts = (f"{UNITS[units].of(size):.{decimals}f}" for size in sizes)
    # Inches without the nought before the point, as in drawings.
    return tuple((text if units == "mm" else text.removeprefix("0")).rstrip("0").rstrip(".") for text in texts)


def _wall(fit_test: FitTest) -> float:
    return max(THINNEST_WALL, fit_test.thickness)


def _lettering_above(top: complex, name: str) -> list[Polyline]:
    """Strokes of a name, centred above the top of an opening."""
    corner = top + 1j * MARGIN - _width(name) / 2
    return [Polyline(corner + HEIGHT * stroke, is_closed=False) for stroke in strokes_of(name)]


def _width(name: str) -> float:
    """Width of lettering, mm."""
    return HEIGHT * max(float(stroke.real.max()) for stroke in strokes_of(name))


def _rectangle(corner: complex, width: float, height: float) -> Polyline:
    """A rectangle from its lower left corner."""
    return Polyline(corner + np.array([0, width, width + 1j * height, 1j * height]))


def _plate(corner: complex, width: float, height: float) -> AbstractCurve:
    """A rectangle with rounded corners from its lower left corner."""
    inner = _rectangle(corner + CORNER * (1 + 1j), width - 2 * CORNER, height - 2 * CORNER)
    return rounded_hull(inner.vertices, CORNER)


# Frames from one hole to the next, and their duration, s: what the eye follows.
FRAMES_PER_HOLE, HOLE_TIME = 20, 0.5


@checked
def fit_test_scene(fit_test: FitTest, parts: tuple[Part, ...]) -> Scene:
    """The coupon and the gauge at rest, and a circle of the pin's diameter that passes over the holes.

    Parameters
    ----------
    fit_test : FitTest
        Its sizes.
    parts : tuple of Part
        The result of `fit_test_parts`.

    Returns
    -------
    Scene
    """
    along = np.linspace(0, fit_test.count - 1, FRAMES_PER_HOLE * (fit_test.count - 1) + 1)
    circles = [hole for hole in parts[0].holes if isinstance(hole, Circle)]
    frames, nearest = len(along), np.rint(along).astype(int)
    place = np.interp(along, np.arange(fit_test.count), [circle.centre for circle in circles])
    table = Table(
        (
            Column("hole_number", "", "position of the pin, as the number of a hole", along + 1),
            Column("difference", "mm", "diameter of the nearest hole minus that of the pin", fit_test.offsets[nearest]),
        )
    )
    still, upright = np.zeros(frames, dtype=complex), np.ones(frames, dtype=complex)
    bodies = tuple(
        SceneBody(part.name, (part,), still, upright, fixed=part is parts[0], named=part is not parts[0])
        for part in parts
    )
    pin = SceneMark("circle", place, label="pin", radius=np.full(frames, fit_test.pin / 2))
    plots = (Plot("hole minus pin", ("difference",)),)
    return Scene(table, HOLE_TIME * along, np.full(frames, True), bodies, marks=(pin,), plots=plots, cyclic=False)
