"""Media: pictures of a scene for people, and recordings of what happens in it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
