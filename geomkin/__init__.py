"""geomkin: planar mechanisms from text recipes, and their geometry and motion as a library.

    import numpy as np, geomkin as gk
    linkage = gk.FourBar(ground=100, crank=30, coupler=90, rocker=70, coupler_point=40 + 25j)
    motion = gk.move(linkage, drive=np.linspace(0, 2 * np.pi, 361), speed=10.0)
    motion.point("coupler_point").position

Points are complex numbers in mm; angles are rad unless a name ends in `_deg`; y is up and
counterclockwise positive. Recipes need more than NumPy and are loaded only by `gk.load`,
`gk.make`, `gk.show` and `gk.edit`.
"""

import lazy_loader

from . import face as face
from .core.version import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
