"""The one table of kinds: what a recipe of each kind is, and what can be worked out from it.

A new kind of mechanism is one recipe class and one row.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from ..check import Check
from ..part import Part
from ..table import Table
from . import disk_cam, four_bar, spur_gear


class Kind(NamedTuple):
    """recipe: its dataclass; table, checks, parts: functions of an instance."""

    recipe: type
    table: Callable[[Any], Table]
    checks: Callable[[Any], list[Check]]
    parts: Callable[[Any], list[Part]]


KINDS: dict[str, Kind] = {
    "four-bar": Kind(
        four_bar.FourBarRecipe, four_bar.four_bar_table, four_bar.four_bar_checks, four_bar.four_bar_plates
    ),
    "disk-cam": Kind(
        disk_cam.DiskCamRecipe, disk_cam.disk_cam_table, disk_cam.disk_cam_checks, disk_cam.disk_cam_plates
    ),
    "spur-gear": Kind(
        spur_gear.SpurGearRecipe, spur_gear.spur_gear_table, spur_gear.spur_gear_checks, spur_gear.spur_gear_plates
    ),
}
