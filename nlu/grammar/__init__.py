"""Combinatory categorial grammar (CCG) with lambda terms, read from the notation of data files."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
