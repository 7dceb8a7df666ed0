"""Belt and chain drives: toothed pulleys, sprockets, idlers and the loop round them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
