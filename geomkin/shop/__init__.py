"""Mechanism and stock to parts. The one place that knows both."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .base import BaseStock as BaseStock
    from .base import RackBaseStock as RackBaseStock
    from .cam import CamStock as CamStock
    from .cam import cam_parts as cam_parts
    from .cam_assembly import cam_bought as cam_bought
    from .drawing import PlateStock as PlateStock
    from .drawing import engraved as engraved
    from .gear.bases import carrier as carrier
    from .gear.bases import pair_base as pair_base
    from .gear.bases import planetary_base as planetary_base
    from .gear.bases import rack_base as rack_base
    from .gear.conjugate import LanternStock as LanternStock
    from .gear.conjugate import PairStock as PairStock
    from .gear.conjugate import lantern_parts as lantern_parts
    from .gear.conjugate import pair_parts as pair_parts
    from .gear.gears import GearStock as GearStock
    from .gear.gears import RingStock as RingStock
    from .gear.gears import Web as Web
    from .gear.gears import base_plate as base_plate
    from .gear.gears import gear_parts as gear_parts
    from .linkage.stack import Stack as Stack
    from .linkage.stack import link_parts as link_parts
    from .linkage.stack import stack_links as stack_links
    from .linkage.stock import LinkStock as LinkStock
    from .motors import motor_plate as motor_plate
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
