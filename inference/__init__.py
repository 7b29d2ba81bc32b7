"""Affordance inference: what observed objects afford, and how certain that is.

>>> from hilt.kb import Interval, KnowledgeBase, functional
>>> from hilt.kb.rule import Atom
>>> from hilt.inference import Affordances, Goal, Observation, Target
>>> base = KnowledgeBase.open("memory:")
>>> rule = functional("knife", "cutting", interval=Interval(0.95, 1))
>>> told = base.believe("A knife is used for cutting", "implies(knife,cutting,high)", "sam", [rule])
>>> goal = Goal("pass", Target(used_for="cutting"))
>>> affordances = Affordances(base)
>>> [str(feature) for feature in affordances.features("pass/findObject", goal)]
['object:knife']
>>> seen = Observation("knife 1", "knife", {Atom("object", "knife"): Interval(0.9, 1)})
>>> print(affordances.infer("pass/findObject", goal, [seen]).best.interval)
[0.85, 1.00]
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
