"""Speed against accuracy: how long each method takes, how far it errs, and where it loses digits."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
