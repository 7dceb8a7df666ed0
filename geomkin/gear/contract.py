"""What every gear tells of itself: all that plates, checks, measures, tables and mates ask of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import Length
from ..core.reprs import still
from ..plane.curve import AbstractCurve, Reversed
from ..plane.primitives import Arc, Segment
from ..plane.vec import Pose, Real

__all__ = ["AbstractGear", "AbstractInvoluteGear", "AbstractShaper", "AbstractTooth", "check_alike"]

# Lands and tips narrower than this share of the gear are left out: two points that far apart are one in every file,
# and an arc between them would have no direction.
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
            """Radius of the circle that rolls on the rack's or the mate's, mm; infinite for a rack."""


class AbstractGear(_AbstractToothed):
    """A gear about the origin, or a rack along the x axis, with a tooth centred on +y."""

    # Whether it is a ring: its teeth point inwards, and its outline is the hole of its plate.
    is_ring: bool = False

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def tip_radius(self) -> float:
            """Radius of the tips of the teeth, mm, the smallest of a ring; infinite for a rack."""

        @property
        @abstractmethod
        def root_radius(self) -> float:
            """Radius of the bottoms of the spaces, mm, the largest of a ring; infinite for a rack."""

        @property
        @abstractmethod
        def tip_thickness(self) -> float:
            """Thickness of a tooth at its tip, mm; negative where the flanks would have met below."""

        @property
        @abstractmethod
        def outline(self) -> AbstractCurve:
            """The whole gear as one closed counterclockwise curve of exact pieces; of a ring the hole of its plate."""

    def _repr_svg_(self) -> str | None:
        return still(self, (self.outline,))

    @property
    def hole_room(self) -> float:
        """Diameter, mm, that a hole about the axis must stay below to leave the teeth standing; 0 for a rack."""
        return 2 * self.root_radius

    @property
    def solid_rim(self) -> float | None:
        """Thickness under the teeth, mm, where nothing is cut out: to the axis; None of a ring, whose plate has it."""
        return None if self.is_ring else self.root_radius

    @property
    def lost_to_undercut(self) -> float | None:
        """Height of the involute that undercut takes away, mm along the radius; None where no tool can undercut it."""
        return None


class AbstractTooth(ABC):
    """Sizes and curves of the tooth on +y of an involute gear, mm and rad, of which nothing is checked.

    What checks, and what looks for sizes to advise, is built on it.
    """

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def base_radius(self) -> float:
            """Radius of the circle from which the flanks unwind, mm."""

        @property
        @abstractmethod
        def tip_radius(self) -> float:
            """Radius of the tips, mm."""

        @property
        @abstractmethod
        def root_radius(self) -> float:
            """Radius of the bottoms of the spaces, mm."""

        @property
        @abstractmethod
        def rolls(self) -> tuple[float, float]:
            """Roll angles of the involute at its two ends, the inner first, rad."""

    @abstractmethod
    def half_angle(self, radius: float) -> float:
        """Half the angle that the tooth takes on a circle through its involute, rad."""

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
        """Rounding or chamfer of the tip's right-hand edge, from the flank on; None where it is sharp."""
        return None


class AbstractInvoluteGear(AbstractGear):
    """A gear whose flanks are involutes (ISO 21771, DIN 3960)."""

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def profile_shift(self) -> float:
            """Outward shift of the tool that cuts it, modules."""

        @property
        @abstractmethod
        def tooth_thickness_allowance(self) -> float:
            """How much thinner each tooth is along the pitch circle, for backlash, mm."""

        @property
        @abstractmethod
        def pressure_angle(self) -> float:
            """Angle of the flanks at the pitch circle, rad: the tool's."""

        @property
        @abstractmethod
        def tooth(self) -> AbstractTooth:
            """Sizes and curves of the tooth on +y."""

    def tool(self, turn: Real) -> tuple[AbstractCurve, Pose] | None:
        """Cutting edge of the tool that cuts it, mm, and where that stands when the gear has turned by `turn`, rad.

        Any shape; it rolls on the pitch circle, on the side of +y. None where that is not told.
        """
        return None

    @property
    def cutting_angle(self) -> float:
        """Angle of the line along which the tool cuts the flanks, from the tangent of the circles that roll, rad."""
        return self.pressure_angle

    @property
    def is_undercut(self) -> bool:
        """Whether the tool's tip cuts away part of the involute it has made."""
        return False

    @property
    def involute_lost(self) -> float:
        """Share of the involute's length, from base circle to tip, that undercut takes away; 0 without undercut."""
        first, last = self.tooth.rolls
        return (first / last) ** 2 if self.is_undercut else 0.0

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle on which the tool rolls, mm: half the module times the teeth."""
        return self.module * self.teeth / 2

    @property
    def base_radius(self) -> float:
        """Radius of the circle from which the flanks unwind, mm."""
        return self.tooth.base_radius

    @property
    def tip_radius(self) -> float:
        """Radius of the tips of the teeth, mm: of a ring the smallest."""
        return self.tooth.tip_radius

    @property
    def root_radius(self) -> float:
        """Radius of the bottoms of the spaces, mm: of a ring the largest."""
        return self.tooth.root_radius

    @property
    def base_pitch(self) -> float:
        """Distance of neighbouring flanks of one side, along any tangent of the base circle, mm."""
        return 2 * np.pi * self.base_radius / self.teeth

    @property
    def form_radius(self) -> float:
        """Radius where involute and root curve join, mm: where they touch, or cross if the tooth is undercut."""
        return self.base_radius * float(np.hypot(1, self.tooth.rolls[1 if self.is_ring else 0]))

    @property
    def flank_lengths(self) -> tuple[float, float]:
        """Tangent lengths from the base circle to the involute's two ends, the inner first, mm."""
        first, last = self.tooth.rolls
        return self.base_radius * first, self.base_radius * last

    @property
    def tip_thickness(self) -> float:
        """Thickness of the tooth along its tip circle, mm; negative where the flanks would have met below."""
        return self.thickness(self.tip_radius)

    @checked
    def thickness(self, radius: float) -> float:
        """Thickness of the tooth along a circle through its involute, mm."""
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
        """Rounding or chamfer of the right-hand edge of the tip on +y; None where the edge is sharp."""
        return self.tooth.tip_edge

    @property
    def regions(self) -> Mapping[str, AbstractCurve]:
        """Curves of the right-hand half of the tooth on +y, from the middle of the space to the middle of the tooth.

        Of a ring the other way round, so that both go outwards. By name: `bottom land`, `root fillet`, `flank`,
        `tip rounding` or `tip chamfer`, `tip land`; those that a tooth does not have are left out.
        """
        edge = self.tip_edge
        start, last = complex(self.root_curve.point(self.root_curve.breaks[0])), edge or self.flank
        end, half_pitch = complex(last.point(last.breaks[-1])), np.pi / self.teeth
        space = 1j * abs(start) * np.exp(-1j * half_pitch)
        lands = _land(space, start), _land(end, 1j * abs(end))
        word = "tip chamfer" if isinstance(edge, Segment) else "tip rounding"
        curves = (lands[0], self.root_curve, self.flank, edge, lands[1])
        found = dict(zip(("bottom land", "root fillet", "flank", word, "tip land"), curves))
        held = {name: curve for name, curve in found.items() if curve is not None}
        return {name: Reversed(held[name]) for name in reversed(held)} if self.is_ring else held


def _land(start: complex, end: complex) -> Arc | None:
    """The arc about the axis between two points; None where they are one."""
    angle = float(np.angle(end / start))
    return Arc(0j, start, angle) if angle > NARROW else None


def check_alike(driver: AbstractInvoluteGear, module: float, pressure_angle: float, name: str, tool: str) -> None:
    """Raise DesignError where what a gear drives, called `name` and made by its `tool`, has other teeth."""
    if abs(driver.module - module) > 1e-9 * driver.module:
        found = f"found {module:g} mm beside {driver.module:g} mm"
        raise DesignError(f"{name}.module", found, f"give {driver.module:.10g}")
    if abs(driver.pressure_angle - pressure_angle) > 1e-9:
        found = f"found {np.degrees(pressure_angle):g} deg beside {np.degrees(driver.pressure_angle):g} deg"
        raise DesignError(f"{name}.{tool}.pressure_angle_deg", found, "give both tools the same")


class AbstractShaper(_AbstractToothed):
    """A gear about the origin that shapes a mate: it is taken as the tool, and the mate is what its teeth leave."""

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def most_backlash(self) -> float:
            """Backlash, mm along the pitch circle, for which neighbouring teeth of the cutter meet."""

    @abstractmethod
    def cutter(self, clearance: Length, backlash: Length = 0.0) -> AbstractCurve:
        """One tooth of the tool: the gear's own drawn out by the clearance and thicker by the backlash, mm.

        Its first pieces are the side that drives, the right-hand one of the tooth on +y.
        """
