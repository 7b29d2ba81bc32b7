# SPDX-License-Identifier: Apache-2.0
"""What questions are answered from: the base, what is in view and in the hand, what was said."""

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
        weigh: adds the confidence and the speaker of a rule to some words.
        visible: the names of the objects in view, in the order of the scene.
        last: the reply to the last command.
        topic: the rules that were mentioned last; none after a command that needed none.
        holding: the name of the object in the hand.
        said: the answer before this one.
        retracted: the rules that were just retracted; none once others were mentioned.
    """

    base: KnowledgeBase
    describe: Describe
    weigh: Callable[[str, Rule], str]
    visible: Callable[[], tuple[str, ...]]
    last: Reply | None
    topic: tuple[Rule, ...] = ()
    holding: Callable[[], str | None] = lambda: None
    said: str = ""
    retracted: tuple[Rule, ...] = ()

    @property
    def decision(self) -> Decision | None:
        """The decision of the last command; None when it made none."""
        return self.last.result.decision if self.last and self.last.result else None


def spoken(key: str, *, done: bool = False, **slots: Slot | None) -> SpokenAnswer:
    """Return an answer by its key, with those of its slots that are filled."""
    given = {name: value for name, value in slots.items() if value is not None}
    return SpokenAnswer(key, given, "done" if done else "failed")
