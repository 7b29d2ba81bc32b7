from .interval import CERTAIN, VACUOUS, Interval
from .knowledge_base import KnowledgeBase
from .rule import Atom, Rule, functional, grasping, kind_rule

__all__ = [
    "CERTAIN",
    "VACUOUS",
    "Atom",
    "Interval",
    "KnowledgeBase",
    "Rule",
    "functional",
    "grasping",
    "kind_rule",
]
