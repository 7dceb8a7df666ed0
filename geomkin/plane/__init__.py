"""Plane geometry in complex numbers, in mm: points, poses, curves and measures. No mechanisms here."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
