"""Physics: the PyBullet simulator, spoken to by the names of bodies, links and joints.

`engine` is one simulator with its four parts: `bodies` (loading and poses), `joints` (positions and
motors), `contacts` (touch, friction, sleeping) and `rendering` (camera images). They call PyBullet
through `client`, the only module that imports it.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
