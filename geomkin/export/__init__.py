"""Parts, tables and scenes as files. Nothing here knows a mechanism."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
