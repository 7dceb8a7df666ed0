"""From the wanted motion to the linkage, and the recipes that find it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
