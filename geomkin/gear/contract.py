"""The contracts of gears: what plates, checks, measures, tables and mates use; and helical teeth."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import Length, entry, quantity, still_picture
from ..core.records import record
from ..core.units import bare_mm, mm
from ..plane.curve import AbstractCurve, Reversed
from ..plane.primitives import Arc, Segment
from ..plane.vec import Pose, Real
from .cutters import STEEPEST, HelixAngle, transverse_section

__all__ = ["AbstractGear", "AbstractInvoluteGear", "AbstractShaper", "AbstractTooth", "check_alike", "check_shortening"]

# Lands and tips narrower than this share of the gear are omitted: in every file two such points coincide, and an arc
# between them would have no direction.
NARROW = 1e-12

# Members that a class may give as fields, properties or cached properties are declared for the type checker only: a
# dataclass would take an inherited property for the default of its field.


class _AbstractToothed(ABC):  # noqa: B024  # its members are declared for the type checker
    if TYPE_CHECKING:

        @property
        @abstractmethod
        def teeth(self) -> int:
            """Number of teeth."""

        @property
        @abstractmethod
        def module(self) -> float:
            """Pitch diameter per tooth, mm."""

        @property
        @abstractmethod
        def pitch_radius(self) -> float:
            """Radius of the pitch circle, mm; inf for a rack."""


class AbstractGear(_AbstractToothed):
    """Base class of gears about the origin, and of racks along the x axis, with a tooth centred on +y."""

    # Whether the gear is a ring: its teeth point inwards, and its outline is the hole of its plate.
    is_ring: bool = False

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def tip_radius(self) -> float:
            """Radius of the tip circle, mm, the smallest radius of a ring; inf for a rack."""

        @property
        @abstractmethod
        def root_radius(self) -> float:
            """Radius of the root circle, mm, the largest radius of a ring; inf for a rack."""

        @property
        @abstractmethod
        def tip_thickness(self) -> float:
            """Thickness of a tooth at its tip, mm; negative if the flanks meet below the tip."""

        @property
        @abstractmethod
        def outline(self) -> AbstractCurve:
            """The gear as one closed counterclockwise curve of exact pieces; of a ring, the hole of its plate."""

    def _repr_svg_(self) -> str | None:
        return still_picture(self, (self.outline,))

    @property
    def hole_room(self) -> float:
        """Diameter of the root circle, which a hole about the axis must not reach, mm; 0 for a rack."""
        return 2 * self.root_radius

    @property
    def solid_rim(self) -> float | None:
        """Thickness of the solid gear under its teeth, mm; None for a ring, whose stock defines the rim."""
        return None if self.is_ring else self.root_radius

    @property
    def lost_to_undercut(self) -> float | None:
        """Height of the involute lost to undercut, mm along the radius; None if no tool can undercut the gear."""
        return None


class AbstractTooth(ABC):
    """Sizes and curves of the tooth on +y of an involute gear, mm and rad, without checks.

    The checks of the gears, and the search for sizes to advise, are based on it.
    """

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def base_radius(self) -> float:
            """Radius of the base circle of the involutes, mm."""

        @property
        @abstractmethod
        def tip_radius(self) -> float:
            """Radius of the tip circle, mm."""

        @property
        @abstractmethod
        def root_radius(self) -> float:
            """Radius of the root circle, mm."""

        @property
        @abstractmethod
        def rolls(self) -> tuple[float, float]:
            """Roll angles of the involute at its two ends, the inner first, rad."""

    @abstractmethod
    def half_angle(self, radius: float) -> float:
        """Half the angle of the tooth on a circle through its involute, rad."""

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def flank(self) -> AbstractCurve:
            """Right-hand flank, from the root curve to the tip."""

        @property
        @abstractmethod
        def root_curve(self) -> AbstractCurve:
            """Right-hand root curve, from the bottom land to the flank."""

    @property
    def tip_edge(self) -> AbstractCurve | None:
        """Rounding or chamfer of the tip's right-hand edge, starting at the flank; None if the edge is sharp."""
        return None


class AbstractInvoluteGear(AbstractGear):
    """Base class of gears with involute flanks (ISO 21771, DIN 3960)."""

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def profile_shift(self) -> float:
            """Profile shift: the outward shift of the cutting tool, modules."""

        @property
        @abstractmethod
        def tooth_thickness_allowance(self) -> float:
            """Reduction of the thickness of each tooth along the pitch circle, for backlash, mm."""

        @property
        @abstractmethod
        def pressure_angle(self) -> float:
            """Pressure angle at the pitch circle, rad: that of the tool."""

        @property
        @abstractmethod
        def tooth(self) -> AbstractTooth:
            """Sizes and curves of the tooth on +y."""

    def tool(self, turn: Real) -> tuple[AbstractCurve, Pose] | None:
        """Cutting edge of the tool, mm, and its poses.

        Parameters
        ----------
        turn : ndarray
            Rotations of the gear, rad, any shape.

        Returns
        -------
        tuple of AbstractCurve and Pose, or None
            The tool rolls on the pitch circle, on the side of +y. None if the tool is not modelled.
        """
        return None

    @property
    def cutting_angle(self) -> float:
        """Working pressure angle between gear and tool, rad."""
        return self.pressure_angle

    @property
    def is_undercut(self) -> bool:
        """Whether the tool's tip removes part of the involute."""
        return False

    @property
    def involute_lost(self) -> float:
        """Share of the involute's length, from base circle to tip, that is lost to undercut; 0 without undercut."""
        first, last = self.tooth.rolls
        return (first / last) ** 2 if self.is_undercut else 0.0

    @property
    def pitch_radius(self) -> float:
        """Radius of the pitch circle, mm: half the module times the number of teeth."""
        return self.module * self.teeth / 2

    @property
    def base_radius(self) -> float:
        """Radius of the base circle, from which the involutes start, mm."""
        return self.tooth.base_radius

    @property
    def tip_radius(self) -> float:
        """Radius of the tip circle, mm: the smallest radius of a ring."""
        return self.tooth.tip_radius

    @property
    def root_radius(self) -> float:
        """Radius of the root circle, mm: the largest radius of a ring."""
        return self.tooth.root_radius

    @property
    def base_pitch(self) -> float:
        """Base pitch: distance of adjacent flanks of the same side along a tangent of the base circle, mm."""
        return 2 * np.pi * self.base_radius / self.teeth

    @property
    def form_radius(self) -> float:
        """Form radius, mm: where involute and root curve touch, or cross if the tooth is undercut."""
        return self.base_radius * float(np.hypot(1, self.tooth.rolls[1 if self.is_ring else 0]))

    @property
    def flank_lengths(self) -> tuple[float, float]:
        """Tangent lengths from the base circle to the involute's two ends, the inner first, mm."""
        first, last = self.tooth.rolls
        return self.base_radius * first, self.base_radius * last

    @property
    def tip_thickness(self) -> float:
        """Thickness of the tooth along its tip circle, mm; negative if the flanks meet below the tip circle."""
        return self.thickness(self.tip_radius)

    @checked
    def thickness(self, radius: float) -> float:
        """Thickness of the tooth along a circle.

        Parameters
        ----------
        radius : float
            Radius of a circle through the involute, mm.

        Returns
        -------
        float
            Length of the arc, mm.
        """
        return 2 * radius * self.tooth.half_angle(radius)

    @property
    def flank(self) -> AbstractCurve:
        """Right-hand flank of the tooth on +y, from the root curve to the tip."""
        return self.tooth.flank

    @property
    def root_curve(self) -> AbstractCurve:
        """Right-hand root curve of the tooth on +y, from the bottom land to the flank."""
        return self.tooth.root_curve

    @property
    def tip_edge(self) -> AbstractCurve | None:
        """Rounding or chamfer of the right-hand edge of the tip on +y; None if the edge is sharp."""
        return self.tooth.tip_edge

    @property
    def regions(self) -> Mapping[str, AbstractCurve]:
        """Curves of the right-hand half of the tooth on +y, by name, from the inside outwards.

        The names are `bottom land`, `root fillet`, `flank`, `tip rounding` or `tip chamfer`, and `tip land`; regions
        that a tooth does not have are omitted. The curves run from the middle of the space to the middle of the tooth,
        those of a ring in the opposite order and direction.
        """
        edge = self.tip_edge
        start, last = complex(self.root_curve.point(self.root_curve.breaks[0])), edge or self.flank
        end, half_pitch = complex(last.point(last.breaks[-1])), np.pi / self.teeth
        space = 1j * abs(start) * np.exp(-1j * half_pitch)
        lands = _land(space, start), _land(end, 1j * abs(end))
        edge_name = "tip chamfer" if isinstance(edge, Segment) else "tip rounding"
        names = ("bottom land", "root fillet", "flank", edge_name, "tip land")
        curves = (lands[0], self.root_curve, self.flank, edge, lands[1])
        regions = {name: curve for name, curve in zip(names, curves) if curve is not None}
        return {name: Reversed(regions[name]) for name in reversed(regions)} if self.is_ring else regions

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> Self:
        """The transverse section of helical teeth whose normal section has this gear's sizes.

        Parameters
        ----------
        helix_angle_deg : float
            Angle of the teeth to the axis at the pitch circle, 0 to 45 deg.

        Returns
        -------
        SpurGear or RingGear
            Module, profile shift, heights, tip edges and tool of the section perpendicular to the axis (ISO 21771);
            `tooth_thickness_allowance`, mm along the pitch circle, is unchanged.
        """
        return transverse_section(self, helix_angle_deg)


def _land(start: complex, end: complex) -> Arc | None:
    """The arc about the axis between two points; None if they coincide."""
    angle = float(np.angle(end / start))
    return Arc(0j, start, angle) if angle > NARROW else None


def check_alike(driver: AbstractInvoluteGear, module: float, pressure_angle: float, name: str, tool: str) -> None:
    """Raise DesignError if module or pressure angle of the driven gear `name`, cut by `tool`, are not the driver's."""
    if abs(driver.module - module) > 1e-9 * driver.module:
        problem = f"found {mm(module):g}, but the driving gear has {mm(driver.module):g}; they must be equal"
        raise DesignError(f"{name}.module", problem, f"give {bare_mm(driver.module):.15g}", "conflict", driver.module)
    if abs(driver.pressure_angle - pressure_angle) > 1e-9:
        angles = np.degrees(pressure_angle), np.degrees(driver.pressure_angle)
        problem = f"found {angles[0]:g} deg, but the driving gear has {angles[1]:g} deg; they must be equal"
        remedy = "give both tools the same pressure angle"
        raise DesignError(f"{name}.{tool}.pressure_angle_deg", problem, remedy, "conflict")


def check_shortening(gear: AbstractInvoluteGear, by: float, addendum: float) -> None:
    """Raise DesignError if shortened tips leave no teeth above the reference line; in modules."""
    if by >= addendum:
        problem = f"found {gear.profile_shift:g}, with which tips of full clearance are shortened by {by:.4g} modules"
        raise DesignError("profile_shift", problem, "give smaller profile shifts", "conflict")


class AbstractShaper(_AbstractToothed):
    """Base class of gears about the origin that generate a mate: the gear is the tool that cuts the mate's teeth."""

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def most_backlash(self) -> float:
            """Backlash at which adjacent teeth of the cutter meet, mm along the pitch circle."""

    @abstractmethod
    def cutter(self, clearance: Length, backlash: Length = 0.0) -> AbstractCurve:
        """One tooth of the tool: the gear's tooth, longer by the clearance and thicker by the backlash, mm.

        Its first pieces are the driving side, the right-hand side of the tooth on +y.
        """


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
