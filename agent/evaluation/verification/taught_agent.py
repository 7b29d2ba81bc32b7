"""An agent that was taught one learning scenario: its decisions, and the rules read for each.

It is the goal manager with perfect vision and a knowledge base in memory, without language and
body. The rules of `TracingSource` record that they were met, and when anything is read of them that
another level of confidence, or another statement, would change. What identifies the cell of a rule
(features, contexts, functor and argument) only tells that it is there. A run is deterministic: one
that met the cells L and read the cells R decides alike in all learning scenarios that agree on R
and have the same number of rules in each cell of L.
"""

from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import fields
from functools import cache
from typing import NamedTuple, TypeAlias

from ....inference.affordance import Affordances, RuleSource
from ....inference.norms import NormChecker
from ....inference.settings import Settings
from ....inference.taxonomy import Taxonomy
from ....inference.types import Candidate, Inference, Target
from ....kb.knowledge_base import KnowledgeBase
from ....kb.rdf.rule_mapping import BELIEFS, DERIVED_FROM, GENERATED_AT
from ....kb.rule import DEFAULT_SPEAKER, Rule
from ....sim.scene.scene import Placement, Scene
from ...config import actions_with, household, open_base
from ...execution.action_tree_executor import GoalManager
from ...execution.perception import PerfectVision
from ...execution.request import Request

GraphStatement: TypeAlias = "tuple[object, ...]"  # subject, predicate, object
PROVENANCE = (DERIVED_FROM, GENERATED_AT)
STATED = frozenset({"interval", "speaker", "utterance", "time", "status", "trust", "id", "support"})


class RuleKey(NamedTuple):
    """The topic of a rule: an affordance, with an empty context, or a part to grasp in one."""

    object: str
    argument: str
    context: str = ""

    @classmethod
    def from_rule(cls, rule: Rule) -> "RuleKey":
        """Return the cell of a rule."""
        name = rule.argument.name if rule.argument else ""
        return cls(rule.object or "*", name, rule.context or "")


class TracingRule(Rule):
    """A rule that records that it was met, and when its content is read."""

    def __getattribute__(self, name: str) -> object:
        state = object.__getattribute__(self, "__dict__")
        if "source" in state and not name.startswith("__"):  # absent during construction
            state["source"].listed.add(state["key"])
            if name in STATED:
                state["source"].read.add(state["key"])
        return object.__getattribute__(self, name)


class TracingSource:
    """A source of rules that records the cells of those that are met, and that are read."""

    def __init__(self, source: RuleSource) -> None:
        self.source = source
        self.listed, self.read = set[RuleKey](), set[RuleKey]()

    @property
    def sequence(self) -> int:
        """The sequence number of the source."""
        return self.source.sequence

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """Return the rules of the source as tracing rules."""
        found: list[Rule] = []
        for rule in self.source.rules_at_nodes(nodes):
            same = {each.name: getattr(rule, each.name) for each in fields(Rule)}
            found.append(TracingRule(**same))
            found[-1].__dict__.update(key=RuleKey.from_rule(rule), source=self)
        return found


class TracedDecision(NamedTuple):
    """A decision with the keys of the rules it depends on."""

    object: Inference | None  # at the find node; None if no node was reached
    part: Inference | None  # at the grasp node; None if the action does not grasp
    listed: frozenset[RuleKey]  # the cells of all rules that were met
    read: frozenset[RuleKey]  # the cells whose content was read


class TaughtAgent(AbstractContextManager["TaughtAgent"]):
    """An agent with a knowledge base of given rules; close it after use."""

    def __init__(self, rules: Iterable[Rule]) -> None:
        self.base = open_base("memory:")
        self.base.believe("", "", DEFAULT_SPEAKER, rules)
        self._source = TracingSource(self.base)
        taxonomy = Taxonomy.from_base(self.base)
        self._affordances = Affordances(self._source, Settings.load(), taxonomy)
        self._norms = NormChecker(self._affordances)

    def decide(self, action: str, target: Target, scene: Sequence[str]) -> TracedDecision:
        """Decide about a command, with perfect detection of the objects in the scene."""
        things = Scene(tuple(Placement(name, name) for name in scene), seed=0)
        vision = PerfectVision(things, household().objects)
        manager = GoalManager(actions_with(None), self._affordances, vision, None, self._norms)
        source = self._source
        source.listed.clear()
        source.read.clear()
        found = manager.achieve(Request(action, {"object": target}, DEFAULT_SPEAKER)).decision
        chosen = (found.object, found.part) if found else (None, None)
        return TracedDecision(*chosen, frozenset(source.listed), frozenset(source.read))

    def __exit__(self, *_: object) -> None:
        self.base.close()


def belief_graph(base: KnowledgeBase) -> frozenset[GraphStatement]:
    """Return the statements of the graph of beliefs, without the provenance of the rules."""
    quads = base.store.quads(None, None, None, BELIEFS)
    return frozenset(quad[:3] for quad in quads if quad.predicate not in PROVENANCE)


@cache
def graph_after(*rules: Rule) -> frozenset[GraphStatement]:
    """Return the graph of beliefs of an agent that was taught these rules only."""
    with TaughtAgent(rules) as taught:
        return belief_graph(taught.base)


def acceptable_candidates(inference: Inference | None) -> tuple[Candidate, ...]:
    """Return the candidates that may be chosen: the best one and its ties."""
    if inference is None or inference.best is None:
        return ()
    return inference.ties or (inference.best,)
