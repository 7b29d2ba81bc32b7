# SPDX-License-Identifier: Apache-2.0
"""What questions are answered from, and how an answer to one is put."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ...kb.knowledge_base import KnowledgeBase
from ...kb.rule import Rule
from ..execution.outcome import Decision, Slot, SpokenAnswer
from .reply import Reply

Describe = Callable[[Rule], str]
Answered = tuple[SpokenAnswer, tuple[Rule, ...]]


@dataclass(frozen=True)
class Knowledge:
    """What questions are answered from.

    Attributes:
        base: the knowledge base.
        describe: puts a rule into words.
        weigh: puts behind some words how sure a rule makes them, and who told it.
        visible: the names of the objects in view, in the order of the scene.
        last: the last command that was carried out or tried.
        topic: the rules that were last spoken of; none right after a command that needed none.
    """

    base: KnowledgeBase
    describe: Describe
    weigh: Callable[[str, Rule], str]
    visible: Callable[[], tuple[str, ...]]
    last: Reply | None
    topic: tuple[Rule, ...] = ()

    @property
    def decision(self) -> Decision | None:
        """What the last command chose; None where it did not get so far."""
        return self.last.achievement.decision if self.last and self.last.achievement else None


def say(key: str, *, done: bool = False, **slots: Slot | None) -> SpokenAnswer:
    """An answer by its key, with those of its slots that are filled."""
    given = {name: value for name, value in slots.items() if value is not None}
    return SpokenAnswer(key, given, "done" if done else "failed")
