"""Gears: the rack that cuts them and the teeth it leaves. Knows nothing of plates or files."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .conjugate.conjugate import Conjugate as Conjugate
    from .conjugate.flank_gear import FlankGear as FlankGear
    from .conjugate.lantern import LanternPinion as LanternPinion
    from .conjugate.point_tooth import PointToothGear as PointToothGear
    from .conjugate.straight_sided import StraightSidedGear as StraightSidedGear
    from .conjugate.tables import flank_table as flank_table
    from .conjugate.tables import pin_table as pin_table
    from .conjugate.untouched import Untouched as Untouched
    from .cutter import PinionCutter as PinionCutter
    from .gear_rack import GearRack as GearRack
    from .measures import base_pitch as base_pitch
    from .measures import chord as chord
    from .measures import over_pins as over_pins
    from .measures import span as span
    from .planetary import PlanetarySet as PlanetarySet
    from .rack import RackCutter as RackCutter
    from .rack_pair import RackPair as RackPair
    from .shifts import balanced_shifts as balanced_shifts
    from .shifts import undercut_free_shift as undercut_free_shift
    from .tables import contact_table as contact_table
    from .tables import tooth_table as tooth_table
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
