"""Cycloidal drives: a disc of lobes on an eccentric that rolls in a ring of pins, and turns output pins slowly back."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
