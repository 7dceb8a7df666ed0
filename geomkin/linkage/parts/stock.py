"""What links are cut from, what joins them, and the motor that turns them."""

from __future__ import annotations

from typing import Literal

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity
from ...core.records import record
from ...making.bores import clearance as wider
from ...making.fasteners import Fastener, fastener_of
from ...making.fits import AbstractBored, Fit, fit, interference
from ...making.motors import MOTORS, MotorName


@record(checked=True)
class LinkStock:
    """What links are cut from, and the pins that join them."""

    thickness: float = quantity("thickness of the sheet", "mm", default=3.0, at_least=0.01, at_most=1000)
    bar_width: float = quantity("width of the links", "mm", default=14.0, above=0, at_most=FARTHEST)
    pin_diameter: float = quantity("diameter of the pins", "mm", default=4.0, at_least=1e-12, at_most=FARTHEST)
    clearance: float = wider(0.2)
    fastener: Literal["screw", "rod"] | None = entry(
        "screws with nuts, or rods cut flush; left out, screws where pin_diameter is that of one and sheets bear it",
        default=None,
    )
    play: float = quantity("along a pin, so that its plates turn", "mm", default=0.2, at_least=0, at_most=10)
    head_height: float | None = quantity(
        "of the screws' heads, where they are not those of the standard", "mm", default=None, at_least=0, at_most=100
    )

    motor: MotorName | None = entry(
        "what turns the crank: its holes are in the ground, its shaft's in the crank; left out, no motor", default=None
    )
    fit: Fit = fit("the crank's bore on a motor")
    interference: float = interference()

    def __post_init__(self) -> None:
        # Refuses a screw that there is none of.
        _ = self.fastener_used
        self._check_motor()
        if self.bar_width <= self.hole_diameter:
            raise DesignError(
                "bar_width",
                f"found {self.bar_width:g} mm, but the pin holes are {self.hole_diameter:g} mm wide",
                "give wider bars or thinner pins",
            )

    @property
    def fastener_used(self) -> Fastener:
        """What holds the pins."""
        return fastener_of(self.pin_diameter, self.thickness, self.fastener, self.play, self.head_height)

    @property
    def hole_diameter(self) -> float:
        """Diameter of a pin hole, mm."""
        return self.pin_diameter + self.clearance

    @property
    def shaft(self) -> AbstractBored | None:
        """The motor's shaft, and how the crank sits on it."""
        if self.motor is None:
            return None
        return AbstractBored(
            thickness=self.thickness,
            bore=MOTORS[self.motor].shaft,
            bore_form="D",
            fit=self.fit,
            interference=self.interference,
            clearance=self.clearance,
            motor=self.motor,
        )

    def _check_motor(self) -> None:
        if (shaft := self.shaft) is None or self.motor is None:
            if self.fit == "press":
                raise DesignError(
                    "fit", "found press, but no motor whose shaft it is for", "give motor, or leave it out"
                )
            return
        MOTORS[self.motor].check_plate(self.motor, self.thickness, "motor")
        if self.bar_width <= (widest := shaft.bore + shaft.play):
            raise DesignError(
                "bar_width",
                f"found {self.bar_width:g} mm, but the hole for the motor's shaft is {widest:g} mm wide",
                "give wider bars, or leave out motor",
            )
