"""A cam in its setting: its motion, its plates, their masses and their assembly."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from ...core.records import record
from ...making.assembly import Assembly, BaseStock
from ...making.fasteners import pin_parts
from ...making.motors import MOTORS
from ...model.material import Mass
from ...model.motor import Motor
from ...model.part import Part
from ...recipe.aspect import Setting
from ...recipe.recipe import part_masses
from ...recipe.settings import Drive
from ..cam import Cam
from ..parts import CamStock, cam_assembly, cam_parts, follower_plates, pin_masses
from ..undercut import Undercut, undercut


@record(eq=False)
class MadeCam:
    """A cam and its follower as plates, at the cam angles and the speed of a recipe or of its setting."""

    cam: Cam
    drive: Drive
    stock: CamStock
    base: BaseStock | None
    setting: Setting
    has_snap_pins: bool

    @property
    def speed(self) -> float:
        """Of the cam, rad/s, in the direction in which it turns; below 0 if a machine turns it backwards."""
        return self.drive.speed if self.setting.speed is None else self.setting.speed

    @property
    def acceleration(self) -> float:
        """Of the cam, rad/s2."""
        given = self.setting.acceleration
        return self.drive.acceleration_rad_per_s2 if given is None else given

    @cached_property
    def cut(self) -> Undercut:
        """The undercut of the cam and its trimmed outline."""
        return undercut(self.cam)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The plates of cam, follower and base."""
        return (*cam_parts(self.cam, self.stock, self.cut, self.base), *pin_parts(self.assembly.snap_pins))

    @cached_property
    def masses(self) -> Mapping[str, Mass]:
        """Mass of cam, roller and follower; that of the follower with the pins that are glued into it."""
        bodies = part_masses(self.parts)
        if bodies and not self.has_snap_pins:
            plates = follower_plates(self.cam, self.stock, self.base)
            for body, mass in pin_masses(plates, self.stock, self.base).items():
                bodies[body] += mass
        return bodies

    @cached_property
    def assembly(self) -> Assembly:
        """Shafts, pins and collars of cam and follower, and the assembly steps."""
        return cam_assembly(self.cam, self.stock, self.base, self.has_snap_pins)

    @property
    def mounted_motor(self) -> Motor | None:
        """The motor for which a plate has holes."""
        return MOTORS.get(str(self.stock.motor))
