"""From the wanted motion to the linkage. Knows nothing of plates, files or recipes."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .double_rockers import DoubleRocker as DoubleRocker
    from .double_rockers import double_rocker as double_rocker
    from .families import Family as Family
    from .found import Found as Found
    from .rockers import CrankRocker as CrankRocker
    from .rockers import crank_rocker as crank_rocker
    from .strokes import StrokeCrank as StrokeCrank
    from .strokes import slider_crank_stroke as slider_crank_stroke
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
