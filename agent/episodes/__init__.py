"""Episodes: commands and their results, with all that is needed to run them again."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
