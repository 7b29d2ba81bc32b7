# SPDX-License-Identifier: Apache-2.0
"""The knowledge base: interval-annotated rules on an RDF graph.

Interval    bounds [lower, upper] of the probability of a statement
atom        one thing a rule speaks of: object:knife, part:blade, action:pass
rule        features and contexts imply an affordance, within an interval, as one speaker told it
feature     what must be seen for a rule to apply
context     what the robot is doing, or where, for a rule to apply
affordance  what follows: what the object is used for, how the action is done
utterance   one sentence of the history: who said it, when, and what it did to the rules
trust       how far what a speaker says is believed
node        an action-tree node; the rules that matter there hang on it
base        a folder, the memory, or an endpoint that keeps all of it

>>> from hilt.kb import Interval, KnowledgeBase, grasping
>>> kb = KnowledgeBase.open("memory:")
>>> rule = grasping("knife", "blade", "pass", interval=Interval(0.95, 1))
>>> told = kb.believe("To pass a knife grab the knife by the blade", "implies(...)", "sam", [rule])
>>> kb.rules_at_nodes(["pass.graspObject"])
[<Rule pass, object:knife => graspObject(blade) [0.95, 1.00]>]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .interval import CERTAIN, VACUOUS, Interval
from .rule import Atom, Rule, functional, grasping

if TYPE_CHECKING:
    from .knowledge_base import KnowledgeBase

__all__ = [
    "CERTAIN",
    "VACUOUS",
    "Atom",
    "Interval",
    "KnowledgeBase",
    "Rule",
    "functional",
    "grasping",
]


def __getattr__(name: str) -> object:
    # The base brings the store engine with it; who needs only the values does not pay for that.
    if name == "KnowledgeBase":
        from .knowledge_base import KnowledgeBase

        return KnowledgeBase
    raise AttributeError(name)
