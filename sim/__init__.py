"""The simulated robot: a table with objects, cameras, an arm with a hand, and their physics.

>>> from hilt.ontology.objects import load_objects
>>> from hilt.sim import parse_scene
>>> parse_scene("objects:knife,mug", seed=7, objects=load_objects()).types
('knife', 'mug')

The body knows nothing of rules. It is told which object and which part::

    with Body(scene, objects, seed=7) as body:
        knife = body.search(["object:knife"])[0]
        body.grasp(knife, "blade")
        body.lift()
        body.hand_over()
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
