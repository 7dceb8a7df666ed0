"""Helical teeth: how the transverse section of a gear changes along its face."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import entry, quantity
from ..core.records import record
from .contract import AbstractInvoluteGear
from .cutters import STEEPEST

Hand = Literal["right", "left"]


def helix_angle() -> Any:
    """The field for the helix angle of gears and of their recipes."""
    return quantity(
        "angle of the teeth to the axis at the pitch circle, 0 for straight ones", "deg",
        default=0.0, at_least=0, at_most=STEEPEST,
    )  # fmt: skip


@record(checked=True)
class Helix:
    """Direction of a gear's teeth along its face: on helices about its axis, or as a herringbone.

    Parameters
    ----------
    helix_angle_deg : float, optional
        Angle of the teeth to the axis at the pitch circle, 0 to 45 deg; 0 for straight teeth.
    hand : {"right", "left"}, optional
        Hand of the helices; for a herringbone, of its lower half.
    herringbone : bool, optional
        Whether the upper half of the face has the other hand.

    Raises
    ------
    DesignError
        If an angle is out of range, or a herringbone has straight teeth.

    Notes
    -----
    All sizes of a gear, including module, pressure angle and tool, refer to its transverse section, perpendicular to
    the axis; the gear's method `transverse` converts sizes of the normal section, perpendicular to the teeth. The
    drawing shows the section at the bottom, z = 0. With increasing z the teeth of a right-handed gear or ring rotate
    counterclockwise, seen from above. Terms and formulas of ISO 21771.

    Examples
    --------
    >>> round(gk.gear.Helix(20.0).overlap_ratio(module=2.0, face_width=20.0), 4)
    1.1586
    """

    helix_angle_deg: float = helix_angle()
    hand: Hand = entry("hand of the helices; that of the mate follows", default="right")
    herringbone: bool = entry("lower half with this hand, upper half with the other", default=False)

    def __post_init__(self) -> None:
        if self.herringbone and self.helix_angle_deg == 0:
            problem = "found true with straight teeth"
            raise DesignError("herringbone", problem, "give a helix_angle_deg, usually 30, or false", "conflict")

    @property
    def mate(self) -> Helix:
        """The helix of an external gear in mesh, with the other hand. A rack or ring has the helix of its pinion."""
        return replace(self, hand="left" if self.hand == "right" else "right")

    @property
    def slope(self) -> float:
        """Tangent of the helix angle at the pitch circle; positive for a right hand."""
        return float(np.tan(np.radians(self.helix_angle_deg))) * (1 if self.hand == "right" else -1)

    @checked
    def width(self, face_width: PositiveFloat) -> float:
        """Face width over which the teeth have one hand, mm: all of it, or half for a herringbone.

        Parameters
        ----------
        face_width : float
            Width of the whole face, mm, above 0.
        """
        return face_width / 2 if self.herringbone else face_width

    @checked
    def advance(self, face_width: PositiveFloat) -> float:
        """Displacement of a tooth along the pitch circle over `width`, mm, positive counterclockwise.

        Parameters
        ----------
        face_width : float
            Width of the whole face, mm, above 0.
        """
        return self.width(face_width) * self.slope

    @checked
    def normal_module(self, module: PositiveFloat) -> float:
        """Normal module, mm, for a transverse module.

        Parameters
        ----------
        module : float
            Transverse module, mm, above 0.
        """
        return module * float(np.cos(np.radians(self.helix_angle_deg)))

    @checked
    def normal_pressure_angle(self, gear: AbstractInvoluteGear) -> float:
        """Normal pressure angle of a gear at its pitch circle, rad.

        Parameters
        ----------
        gear : AbstractInvoluteGear
            The gear's transverse section.
        """
        return float(np.arctan(np.tan(gear.pressure_angle) * np.cos(np.radians(self.helix_angle_deg))))

    @checked
    def base_angle(self, gear: AbstractInvoluteGear) -> float:
        """Helix angle on the base cylinder, rad.

        Parameters
        ----------
        gear : AbstractInvoluteGear
            The gear's transverse section.
        """
        return float(np.arctan(abs(self.slope) * gear.base_radius / gear.pitch_radius))

    @checked
    def lead(self, gear: AbstractInvoluteGear) -> float:
        """Lead: axial length of one full turn of a helix, mm; inf for straight teeth.

        Parameters
        ----------
        gear : AbstractInvoluteGear
            The gear's transverse section.
        """
        return float(2 * np.pi * gear.pitch_radius / abs(self.slope)) if self.slope else float("inf")

    @checked
    def overlap_ratio(self, module: PositiveFloat, face_width: PositiveFloat) -> float:
        """Overlap ratio, the part of the contact ratio that is due to the helix: `width` in axial pitches.

        Parameters
        ----------
        module : float
            Transverse module, mm, above 0.
        face_width : float
            Width of the whole face, mm, above 0.
        """
        return abs(self.advance(face_width)) / (np.pi * module)
