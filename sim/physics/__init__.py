"""Physics: the PyBullet simulator, spoken to by the names of bodies, links and joints."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
