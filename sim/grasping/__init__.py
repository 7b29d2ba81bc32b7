"""Grasp planning: from the percept of an object to the grasp to execute.

In the order of the data: `context` has the points that matter, `sampling` proposes candidates,
`scoring` judges their contacts, `planner` ranks them, `selection` takes the best reachable one.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
