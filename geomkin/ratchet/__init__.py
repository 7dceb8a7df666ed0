"""Ratchets: a toothed wheel and a pawl that draws itself into its teeth, so that the wheel turns one way only."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
