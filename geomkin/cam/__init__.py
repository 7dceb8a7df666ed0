"""Disk cams: motion laws, followers, profiles, their checks, parts, scenes and recipes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
