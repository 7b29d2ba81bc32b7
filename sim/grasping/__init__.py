"""Grasp planning: from the percept of an object to the grasp to execute."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
