"""The sheet that links are cut from, their pins and their motor; and sheets on which drawings are engraved."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from functools import cached_property
from math import ceil
from typing import Literal

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, PlaceOnBody, entry, quantity
from ...core.records import record
from ...core.units import mm
from ...making.attachments import Attachment, attachments_entry
from ...making.bores import AbstractBored, fit_entry, interference
from ...making.bores import clearance as wider
from ...making.fasteners import Fastener, SnapPin, ThreadDiameter, fastener_of
from ...making.materials import MaterialKey, material_entry
from ...making.motors import MountedMotorKey, face_of, mounted_motor_entry
from ...model.part import Fit, IsoFit, Part, fit_limits
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, Polyline, Segment, rounded_hull
from ...plane.vec import Complex
from ..motion import Motion

# Largest number of plates between a motor and the ground. More would use up the length of most shafts.
MOST_MOTOR_PLATES = 3


@record(kw_only=True)
class LinkAttachment(Attachment):
    """What a body of a linkage drives."""

    body: str = entry("the body to whose plate it is screwed", example="ground")
    at: PlaceOnBody = entry(
        "its middle: a point of that body by name, or [x, y] in mm in the body's frame; the plate extends to it",
        default=0j, example=-60 - 60j,
    )  # fmt: skip
    mass_kg: float = quantity("its mass, in its middle", "kg", default=0.0, at_least=0, at_most=FARTHEST)


@record(checked=True)
class LinkStock:
    """The sheet that links are cut from, and the pins that join them.

    Raises
    ------
    DesignError
        If a size is out of range, or the holes do not fit into the links.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=3.0, at_least=0.01, at_most=1000)
    bar_width: float = quantity("width of the links", "mm", default=14.0, above=0, at_most=FARTHEST)
    pin_diameter: ThreadDiameter = quantity(
        'diameter of the pins, or their thread, as "#6-32"', "mm", default=4.0, at_least=1e-12, at_most=FARTHEST
    )
    clearance: float = wider(0.2)
    pin_fit: IsoFit = entry(
        'fit of the pins, which are rods, in their holes by ISO 286, such as "H7/g6", in place of the clearance',
        default="",
    )
    fastener: Literal["screw", "rod"] | None = entry(
        "screws with nuts, or rods cut flush; by default screws if the sheet carries those of pin_diameter, and rods "
        "with a pin_fit",
        default=None,
    )
    play: float = quantity("axial play along a pin, so that its plates turn", "mm", default=0.2, at_least=0, at_most=10)
    head_height: float | None = quantity(
        "height of the screws' heads, if it is not that of the standard", "mm", default=None, at_least=0, at_most=100
    )

    motor: MountedMotorKey | None = mounted_motor_entry(
        "motor that turns the crank; its holes are in the ground, its shaft's in the crank"
    )
    fit: Fit = fit_entry("the crank's bore on a motor")
    interference: float = interference()
    material: MaterialKey | None = material_entry("the sheet")
    attachments: tuple[LinkAttachment, ...] = attachments_entry("a body")

    def __post_init__(self) -> None:
        if self.pin_fit:
            try:
                limits = fit_limits(self.pin_fit, self.pin_diameter)
            except DesignError as error:
                raise error.named("pin_fit") from None
            if limits.least_clearance < 0:
                problem = (
                    f"found {self.pin_fit}, whose pin may be {mm(-limits.least_clearance):.4g} wider than its hole"
                )
                raise DesignError("pin_fit", problem, 'give a fit with clearance, such as "H7/g6"', "out-of-range")
            if self.fastener == "screw":
                problem = f"found {self.pin_fit}, and fastener = screw, whose thread has no such class"
                raise DesignError("pin_fit", problem, 'give fastener = "rod", or omit pin_fit', "conflict")
        # Raises DesignError if no such screw exists.
        _ = self.fastener_used
        self._check_motor()
        for k, attachment in enumerate(self.attachments):
            attachment.check(0j, self.clearance, f"attachments[{k}]")
        if self.bar_width <= (widest := max(self.hole_diameter, self.spacer_hole)):
            problem = f"found {mm(self.bar_width):g}, but the pin holes are {mm(widest):g} wide"
            raise DesignError("bar_width", problem, "give wider bars or thinner pins")

    @cached_property
    def fastener_used(self) -> Fastener:
        """The fastener that holds the pins."""
        # A fit is that of a smooth shank.
        form = self.fastener or ("rod" if self.pin_fit else None)
        found = fastener_of(self.pin_diameter, self.thickness, form, self.play, self.head_height)
        return replace(found, tolerance=self.pin_fit.partition("/")[2])

    @property
    def pin_clearance(self) -> float:
        """How much wider a pin hole is than its pin, mm: in the middle of its fit, or by the clearance."""
        return fit_limits(self.pin_fit, self.pin_diameter).middle if self.pin_fit else self.clearance

    @property
    def hole_diameter(self) -> float:
        """Diameter of a pin hole, mm."""
        return self.pin_diameter + self.pin_clearance

    @property
    def spacer_hole(self) -> float:
        """Diameter of the hole of a spacer, mm."""
        return self.pin_diameter + self.clearance

    @property
    def largest_clearance(self) -> float:
        """Largest clearance of a pin in its hole, mm: by the limits of its fit, or the clearance."""
        return fit_limits(self.pin_fit, self.pin_diameter).largest_clearance if self.pin_fit else self.clearance

    @property
    def shaft(self) -> AbstractBored | None:
        """The motor's shaft and its fit in the crank; None without a motor."""
        if self.motor is None:
            return None
        face = face_of(self.motor)
        return AbstractBored(
            thickness=self.thickness,
            bore=face.shaft,
            bore_form=face.bore_form,
            flat=face.flat,
            fit=self.fit,
            interference=self.interference,
            clearance=self.clearance,
            motor=self.motor,
        )

    @property
    def motor_plates(self) -> int:
        """Number of plates between the motor and the ground, which take up a boss higher than the sheet."""
        if self.motor is None:
            return 0
        missing = ceil(face_of(self.motor).boss_height / self.thickness) - 1
        return missing if 0 < missing <= MOST_MOTOR_PLATES else 0

    @property
    def snapped(self) -> LinkStock:
        """The same stock with printed pins. DesignError if screws or rods are wanted."""
        if self.fastener is not None:
            problem = f"found snap, and stock.fastener = {self.fastener}"
            raise DesignError("printing.pins", problem, "give one of them", "conflict")
        return SnapLinkStock(**{field.name: getattr(self, field.name) for field in fields(self)})

    def _check_motor(self) -> None:
        if (shaft := self.shaft) is None or self.motor is None:
            if self.fit == "press":
                raise DesignError("fit", "found press, but no motor", "give motor, or omit fit", "conflict")
            return
        face_of(self.motor).check_plate(self.thickness, "motor", 1 + MOST_MOTOR_PLATES)
        if self.bar_width <= (widest := shaft.bore + shaft.play):
            problem = f"found {mm(self.bar_width):g}, but the hole for the motor's shaft is {mm(widest):g} wide"
            raise DesignError("bar_width", problem, "give wider bars, or omit motor")


@record(checked=True)
class SnapLinkStock(LinkStock):
    """The sheet of links that printed pins join."""

    @cached_property
    def fastener_used(self) -> Fastener:
        density = self.material.density if self.material and self.material.density else 0.0
        return SnapPin(self.pin_diameter, "snap", self.play, clearance=self.pin_clearance, density=density)


# Radius of the plate's corners and length of arrow heads, mm.
CORNER = 3.0
HEAD = 3.0
# Length of a pose's y axis relative to its x axis.
SHORTER = 0.5


@record(checked=True)
class PlateStock:
    """The plate on which a drawing is engraved.

    Parameters
    ----------
    thickness : float
        Thickness of the sheet, mm; from 0.01 to 1000.
    margin : float
        Clear edge around the drawing, mm; from 3 to 1000.
    pin_diameter : float
        Diameter of the circles drawn for pins, mm; above 0.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=3.0, at_least=0.01, at_most=1000)
    margin: float = quantity("clear edge around the drawing", "mm", default=8.0, at_least=3, at_most=1000)
    pin_diameter: float = quantity("diameter of the circles drawn for pins", "mm", default=4.0, above=0, at_most=1000)


@checked
def engraved(name: str, marks: Sequence[AbstractCurve], stock: PlateStock = PlateStock()) -> Part:
    """A plate that fits some marks and a margin, with the marks engraved; the coordinates of the drawing are kept.

    Parameters
    ----------
    name : str
        Name of the plate.
    marks : sequence of AbstractCurve
        Curves to engrave, mm.
    stock : PlateStock
        The plate.

    Returns
    -------
    Part

    Raises
    ------
    DesignError
        If there are no marks; its field is the plate's name.

    Notes
    -----
    Derived here.
    """
    curves = tuple(marks)
    if not curves:
        raise DesignError(
            name, "there is nothing to draw", "give a position that the linkage reaches", "does-not-assemble"
        )
    # Sixteenths of each smooth piece locate its extremes to far less than the margin.
    sampled = np.concatenate(
        [curve.point(np.linspace(curve.breaks[:-1], curve.breaks[1:], 17).ravel()) for curve in curves]
    )
    room = stock.margin - CORNER
    low = complex(sampled.real.min() - room, sampled.imag.min() - room)
    high = complex(sampled.real.max() + room, sampled.imag.max() + room)
    corners = [low, complex(high.real, low.imag), high, complex(low.real, high.imag)]
    return Part(name, rounded_hull(corners, CORNER), (), stock.thickness, marks=curves)


def skeleton(motion: Motion, frame: int, stock: PlateStock) -> list[AbstractCurve]:
    """The linkage at a frame: each body as lines between its points, with circles at the pins."""
    marks: list[AbstractCurve] = []
    radius = stock.pin_diameter / 2
    pins: dict[str, complex] = {}
    for name, points in motion.linkage.bodies.items():
        body = motion.bodies[name]
        places = {p: complex(body.point(z).position[frame]) for p, z in points.items()}
        pins |= {p: z for p, z in places.items() if p in motion.linkage.pins}
        if name == motion.linkage.ground:
            continue
        # Coincident points would draw their lines twice.
        corners = list(dict.fromkeys(places.values()))
        joints = list(zip(corners[:-1], corners[1:])) + ([(corners[-1], corners[0])] if len(corners) > 2 else [])
        marks += [line for a, b in joints for line in _between(a, b, radius)]
    return marks + [Circle(z, radius) for z in pins.values()]


def _between(a: complex, b: complex, radius: float) -> list[AbstractCurve]:
    """The line between two circles, if they leave room for one."""
    if abs(b - a) <= 2 * radius:
        return []
    offset = (b - a) / abs(b - a) * radius
    return [Segment(a + offset, b - offset)]


def pose_axes(poses: Iterable[tuple[complex, float]], length: float) -> list[AbstractCurve]:
    """Poses, position in mm and angle in rad, as axes: x of `length`, mm, and a shorter y."""
    x_axes = [(z, length * np.exp(1j * angle)) for z, angle in poses]
    return [Polyline(np.array([z + axis, z, z + SHORTER * 1j * axis]), is_closed=False) for z, axis in x_axes]


def arrow(tail: complex, tip: complex) -> list[AbstractCurve]:
    """A vector as a line with a head; nothing if it is too short for the files."""
    length = abs(tip - tail)
    if length < 1e-3:
        return []
    head = min(HEAD, length / 3) * (tail - tip) / length
    barbs = [tip + head * np.exp(1j * side * np.pi / 9) for side in (1, -1)]
    return [Segment(tail, tip), Polyline(np.array([barbs[0], tip, barbs[1]]), is_closed=False)]


def strokes(runs: Iterable[Complex]) -> list[AbstractCurve]:
    """Runs of points as open polylines."""
    return [Polyline(np.asarray(run), is_closed=False) for run in runs if len(run) > 1]
