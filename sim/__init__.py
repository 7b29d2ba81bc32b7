"""The simulated robot: a table with objects, cameras, an arm with a hand, and their physics.

scene         a description of what is on the table; a placement is one object of it
world         the table with its objects, and time
physics       the PyBullet engine, which knows bodies, links and joints by name
model         an object type or a robot as files for the engine
percept       an object that vision has found, with a point cloud for each part
grasp         a pose of the hand from which its fingers close on one part, with a score
motion        a movement of the arm with what it holds; objects are held by friction only
report        the outcome of a motion: success, or the reason of a failure, and measurements
body          vision, robot and motions together, as the agent uses them

The body knows nothing of rules. It is told which object and which part:

    with Body(scene, objects, seed=7) as body:
        knife = body.search(["object:knife"])[0]
        body.grasp(knife, "blade")
        body.lift()
        body.hand_over()

A scene needs no simulator yet:

>>> from hilt.ontology.objects import load_objects
>>> from hilt.sim import parse_scene
>>> parse_scene("objects:knife,mug", seed=7, objects=load_objects()).types
('knife', 'mug')
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
