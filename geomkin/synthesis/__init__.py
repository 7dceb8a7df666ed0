"""From the wanted motion to the linkage. Knows nothing of plates, files or recipes."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .found import Found as Found
    from .path import path_generator as path_generator
    from .path_found import PathFound as PathFound
    from .path_points import svg_path_points as svg_path_points
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
