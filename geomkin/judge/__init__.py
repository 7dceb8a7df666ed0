"""When a design is good: limits, each with its source, and what is checked against them."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .cam import cam_checks as cam_checks
    from .conjugate import conjugate_checks as conjugate_checks
    from .conjugate import touch_check as touch_check
    from .gear import gear_checks as gear_checks
    from .linkage import collision_check as collision_check
    from .linkage import hole_check as hole_check
    from .linkage import linkage_checks as linkage_checks
    from .mesh import mesh_checks as mesh_checks
    from .mesh import planetary_checks as planetary_checks
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
