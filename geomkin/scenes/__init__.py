"""Mechanisms as scenes: what is cut, where it is at each frame, and what is drawn with it."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .cam import cam_scene as cam_scene
    from .conjugate import conjugate_scene as conjugate_scene
    from .gear import gear_scene as gear_scene
    from .instant import centrodes_scene as centrodes_scene
    from .instant import inflection_scene as inflection_scene
    from .linkage import linkage_scene as linkage_scene
    from .mesh import pair_scene as pair_scene
    from .mesh import planetary_scene as planetary_scene
    from .vectors import force_scene as force_scene
    from .vectors import polygons_scene as polygons_scene
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
