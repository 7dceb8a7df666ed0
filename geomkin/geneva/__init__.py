"""Geneva drives: a crank whose pins turn a slotted wheel by steps, and a disc that locks the wheel between them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
