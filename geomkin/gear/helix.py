"""Teeth along helices: how gears whose transverse section is known run along their face."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np

from ..core.arguments import Positive, checked
from ..core.errors import DesignError
from ..core.fields import entry, quantity
from ..core.records import record
from .contract import AbstractInvoluteGear
from .cutters import STEEPEST

Hand = Literal["right", "left"]


def helix_angle() -> Any:
    """The field for the angle of the teeth, of gears and of their recipes."""
    return quantity(
        "angle of the teeth to the axis at the pitch circle, 0 for straight ones",
        "deg",
        default=0.0,
        at_least=0,
        at_most=STEEPEST,
    )


@record(checked=True)
class Helix:
    """How the teeth of a gear lie along its face: on helices about its axis, or on two halves as a herringbone.

    All sizes of a gear, module, pressure angle and tool included, are those of its transverse section, square to the
    axis; its method `transverse` makes it of sizes in the normal section, square to the teeth. The drawing is the
    section at the bottom, z = 0; the teeth of a right-handed gear go counterclockwise on the way up, as seen from
    above, and so do a right-handed ring's. hand: of a herringbone, that of its lower half. Terms and formulas of ISO
    21771.
    """

    helix_angle_deg: float = helix_angle()
    hand: Hand = entry("hand of the helices; what it meshes with has the one that fits", default="right")
    herringbone: bool = entry("lower half of this hand, upper half of the other", default=False)

    def __post_init__(self) -> None:
        if self.herringbone and self.helix_angle_deg == 0:
            raise DesignError(
                "herringbone", "found true with straight teeth", "give a helix_angle_deg, 30 being usual, or false"
            )

    @property
    def mate(self) -> Helix:
        """That of an external gear in mesh, whose hand is the other; a rack's and a ring's are those of the pinion."""
        return replace(self, hand="left" if self.hand == "right" else "right")

    @property
    def slope(self) -> float:
        """Tangent of the helix angle at the pitch circle; positive for a right hand."""
        return float(np.tan(np.radians(self.helix_angle_deg))) * (1 if self.hand == "right" else -1)

    @checked
    def width(self, face_width: Positive) -> float:
        """Width of the face on which the teeth lie one way, mm: all of it, or of a herringbone half."""
        return face_width / 2 if self.herringbone else face_width

    @checked
    def advance(self, face_width: Positive) -> float:
        """How far a tooth gets along the pitch circle over `width`, mm; positive counterclockwise."""
        return self.width(face_width) * self.slope

    @checked
    def normal_module(self, module: Positive) -> float:
        """Module square to the teeth, mm, for a transverse one."""
        return module * float(np.cos(np.radians(self.helix_angle_deg)))

    @checked
    def normal_pressure_angle(self, gear: AbstractInvoluteGear) -> float:
        """Angle of the flanks at the pitch circle, square to the teeth, rad."""
        return float(np.arctan(np.tan(gear.pressure_angle) * np.cos(np.radians(self.helix_angle_deg))))

    @checked
    def base_angle(self, gear: AbstractInvoluteGear) -> float:
        """Helix angle on the base cylinder, rad."""
        return float(np.arctan(abs(self.slope) * gear.base_radius / gear.pitch_radius))

    @checked
    def lead(self, gear: AbstractInvoluteGear) -> float:
        """Length along the axis in which a tooth would go once round, mm; infinite for straight teeth."""
        return float(2 * np.pi * gear.pitch_radius / abs(self.slope)) if self.slope else float("inf")

    @checked
    def overlap_ratio(self, module: Positive, face_width: Positive) -> float:
        """Axial pitches over the width on which teeth lie one way: what helices add to the contact ratio."""
        return abs(self.advance(face_width)) / (np.pi * module)
