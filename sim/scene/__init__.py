"""Scenes: what is on the table, where, and the simulated world made of it.

`scene` reads descriptions of scenes, `placement` finds a free place for each object, and `world` is
the table with its objects and time; it saves the time of computing objects that lie still.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
