# SPDX-License-Identifier: Apache-2.0
"""Affordance inference: what observed things afford, and how surely.

evidence     intervals combined: AND, modus ponens, fusion, and the measure lambda
goal         what is wanted: an action and the thing it is about
observation  one thing that vision reports, with an interval for each feature
candidate    one conclusion about one thing, with its interval and its rules
inference    all candidates at one node of the action tree, the best first
threshold    what lambda must exceed before the robot acts

>>> from hilt.kb import Interval, KnowledgeBase, functional
>>> from hilt.kb.rule import Atom
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

from .affordance import Affordances, RuleSource
from .evidence import Operators
from .settings import Settings
from .types import Candidate, Conclusion, Goal, Inference, Observation, Target

__all__ = [
    "Affordances",
    "Candidate",
    "Conclusion",
    "Goal",
    "Inference",
    "Observation",
    "Operators",
    "RuleSource",
    "Settings",
    "Target",
]
