"""Speed against accuracy: what each way to a result keeps of its digits where methods fail."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .study import Stability as Stability
    from .study import stability as stability
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
