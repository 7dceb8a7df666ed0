"""The sheet that links are cut from, the pins that join them, and the motor that turns them."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cached_property
from math import ceil
from typing import Literal

from ...core.errors import DesignError
from ...core.fields import FARTHEST, PlaceOnBody, check_sizes, entry, quantity
from ...core.records import record
from ...core.units import mm
from ...making.attachments import Attachment, attachments_entry
from ...making.bores import AbstractBored, fit_entry, interference
from ...making.bores import clearance as wider
from ...making.fasteners import Fastener, ThreadDiameter, fastener_of
from ...making.materials import MaterialKey, material_entry
from ...making.motors import MountedMotorKey, face_of, mounted_motor_entry
from ...making.snap_pins import SnapPin
from ...model.limits import Fit, IsoFit, fit_limits

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
        'fit of the pins in their holes by ISO 286, such as "H7/g6", in place of the clearance', default=""
    )
    fastener: Literal["screw", "rod"] | None = entry(
        "screws with nuts, or rods cut flush; by default screws if the sheet carries those of pin_diameter",
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
            object.__setattr__(self, "clearance", limits.middle)
            check_sizes(self)
        # Raises DesignError if no such screw exists.
        _ = self.fastener_used
        self._check_motor()
        for k, attachment in enumerate(self.attachments):
            attachment.check(0j, self.clearance, f"attachments[{k}]")
        if self.bar_width <= self.hole_diameter:
            raise DesignError(
                "bar_width",
                f"found {mm(self.bar_width):g}, but the pin holes are {mm(self.hole_diameter):g} wide",
                "give wider bars or thinner pins",
            )

    @cached_property
    def fastener_used(self) -> Fastener:
        """The fastener that holds the pins."""
        found = fastener_of(self.pin_diameter, self.thickness, self.fastener, self.play, self.head_height)
        return replace(found, tolerance=self.pin_fit.partition("/")[2])

    @property
    def hole_diameter(self) -> float:
        """Diameter of a pin hole, mm."""
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
            raise DesignError(
                "bar_width",
                f"found {mm(self.bar_width):g}, but the hole for the motor's shaft is {mm(widest):g} wide",
                "give wider bars, or omit motor",
            )


@record(checked=True)
class SnapLinkStock(LinkStock):
    """The sheet of links that printed pins join."""

    @cached_property
    def fastener_used(self) -> Fastener:
        density = self.material.density if self.material and self.material.density else 0.0
        return SnapPin(self.pin_diameter, "snap", self.play, clearance=self.clearance, density=density)
