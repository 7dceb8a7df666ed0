"""geomkin: planar mechanisms from text recipes, and their geometry and motion as a library.

    import numpy as np, geomkin as gk
    linkage = gk.FourBar(ground=100, crank=30, coupler=90, rocker=70, coupler_point=40 + 25j)
    motion = gk.move(linkage, drive=np.linspace(0, 2 * np.pi, 361), speed=10.0)
    motion.point("coupler_point").position

Points are complex numbers in mm; angles are rad unless a name ends in `_deg`; y is up and
counterclockwise positive. Recipes need more than NumPy and are loaded only by `gk.load`, `gk.make`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from .build import make as make
    from .public import *  # noqa: F403
    from .recipe.load import load as load

# Names that load the validator of recipes, which is heavier than NumPy alone.
_HEAVIER = {"load": "recipe.load", "make": "build"}


def __getattr__(name: str) -> Any:
    """Names are loaded when first used, so that the command line answers before NumPy is there."""
    from importlib import import_module

    if name in _HEAVIER:
        value = getattr(import_module(f".{_HEAVIER[name]}", __name__), name)
    elif name.startswith("_"):
        raise AttributeError(name)
    else:
        public = import_module(".public", __name__)
        if name not in public.__all__:
            raise AttributeError(f"geomkin has no {name!r}")
        value = getattr(public, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    from .public import __all__

    return sorted([*__all__, *_HEAVIER, "__version__"])
