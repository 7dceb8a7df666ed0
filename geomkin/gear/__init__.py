"""Gears: the rack that cuts them and the teeth it leaves. Knows nothing of plates or files."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .conjugate.conjugate import Conjugate as Conjugate
    from .conjugate.conjugate import Untouched as Untouched
    from .conjugate.flank_gears import AbstractFlankGear as AbstractFlankGear
    from .conjugate.flank_gears import FlankGear as FlankGear
    from .conjugate.flank_gears import PointToothGear as PointToothGear
    from .conjugate.flank_gears import StraightSidedGear as StraightSidedGear
    from .conjugate.lantern import LanternPinion as LanternPinion
    from .conjugate.tables import flank_table as flank_table
    from .conjugate.tables import pin_table as pin_table
    from .contact import contact_table as contact_table
    from .contract import AbstractGear as AbstractGear
    from .contract import AbstractInvoluteGear as AbstractInvoluteGear
    from .contract import AbstractShaper as AbstractShaper
    from .cutters import RackCutter as RackCutter
    from .cutters import balanced_shifts as balanced_shifts
    from .cutters import undercut_free_shift as undercut_free_shift
    from .helix import Helix as Helix
    from .measures import chord as chord
    from .measures import over_pins as over_pins
    from .measures import span as span
    from .measures import tooth_table as tooth_table
    from .pinion_cutter import PinionCutter as PinionCutter
    from .planetary import PlanetarySet as PlanetarySet
    from .rack import GearRack as GearRack
    from .rack import RackPair as RackPair
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
