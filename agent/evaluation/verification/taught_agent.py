# SPDX-License-Identifier: Apache-2.0
"""A mind that was taught one learning scenario: its decisions, and what it read for each.

It is the goal manager over perfect vision and a real base in memory, without language and body, so
that thousands of decisions can be asked of one base.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from types import TracebackType
from typing import TypeAlias

from ....inference.affordance import Affordances
from ....inference.settings import Settings
from ....inference.taxonomy import Taxonomy
from ....inference.types import Candidate, Inference, Target
from ....kb.knowledge_base import KnowledgeBase
from ....kb.rdf.rule_mapping import BELIEFS, DERIVED_FROM, GENERATED_AT
from ....kb.rule import DEFAULT_SPEAKER, Rule
from ....ontology.actions import load_actions
from ....ontology.objects import load_household
from ....sim.scene.scene import Placement, Scene
from ...config import open_base
from ...execution.goal_manager import GoalManager
from ...execution.outcome import Decision
from ...execution.perception import PerfectVision
from ...execution.request import Request
from .space import Cell
from .tracing import Traced

Statement: TypeAlias = "tuple[object, ...]"  # subject, predicate, object
WHEN = (DERIVED_FROM, GENERATED_AT)

# What comes with the program is read once: it never changes.
_objects = cache(lambda: load_household().objects)
_actions = cache(load_actions)


@dataclass(frozen=True)
class Decided:
    """A decision, and what it rests on.

    Attributes:
        object: the inference at the find node; None where no node was reached.
        part: the inference at the grasp node; None where the action does not grasp.
        read: the cells of which it was read what they say.
    """

    object: Inference | None
    part: Inference | None
    read: frozenset[Cell]


class Taught:
    """A base in memory that was taught some rules, and who decides by it; close it after use."""

    def __init__(self, rules: Iterable[Rule]) -> None:
        self.base = open_base("memory:")
        self.base.believe("", "", DEFAULT_SPEAKER, rules)
        self._traced = Traced(self.base)
        self._affordances = Affordances(
            self._traced, Settings.load(), Taxonomy.from_base(self.base)
        )

    def decide(self, action: str, target: Target, scene: Sequence[str]) -> Decided:
        """Decide about a command, all of a scene being seen with certainty.

        Args:
            action: the tree to walk ("pass").
            target: what it is about.
            scene: the objects on the table.
        """
        things = Scene(tuple(Placement(name, name) for name in scene), seed=0)
        manager = GoalManager(
            _actions(), self._affordances, PerfectVision(things, _objects()), motion=None
        )
        self._traced.read.clear()
        came = manager.achieve(Request(action, {"object": target}, DEFAULT_SPEAKER))
        read = frozenset(self._traced.read)
        found: Decision | None = came.decision
        return Decided(found and found.object, found and found.part, read)

    def __enter__(self) -> Taught:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.base.close()


def believed(base: KnowledgeBase) -> frozenset[Statement]:
    """The statements of the graph of beliefs, but for when each rule was said."""
    quads = base.store.quads(None, None, None, BELIEFS)
    return frozenset(quad[:3] for quad in quads if quad.predicate not in WHEN)


def acceptable(inference: Inference | None) -> tuple[Candidate, ...]:
    """The conclusions that may be acted on: the best, and all that tie with it."""
    if inference is None or inference.best is None:
        return ()
    return inference.ties or (inference.best,)
