"""What questions are answered from: the base, what is in view and in the hand, what was said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ...kb.knowledge_base import KnowledgeBase
from ...kb.rule import Rule
from ...nlu.generation.templates import AnswerTemplates
from ...nlu.parsing.understanding import Understanding
from ..execution.outcome import AnswerContent, Decision, Slot
from .reply import Reply
from .translation import meaning_from_rule, norm_from_rule

Answered = tuple[AnswerContent, tuple[Rule, ...]]


@dataclass(frozen=True)
class AnswerSources:
    """What questions are answered from.

    Attributes:
        base: the knowledge base.
        words: the answers of the language, for rules in words.
        listener: who asks.
        visible: the names of the objects in view, in the order of the scene.
        last: the reply to the last command.
        topic: the rules that were mentioned last; none after a command that needed none.
        holding: the name of the object in the hand.
        said: the answer before this one.
        control: what a control did after the last command.
        prohibition: the utterance because of which the last command was not carried out, if any.
        unanswered: the answer to the last question if nobody has told what it asks, else empty.
        retracted: the rules that were just retracted; none once others were mentioned.
        called: the name that the one who asks goes by.
    """

    base: KnowledgeBase
    words: AnswerTemplates
    listener: str
    visible: Callable[[], tuple[str, ...]]
    last: Reply | None
    topic: tuple[Rule, ...] = ()
    holding: Callable[[], str | None] = lambda: None
    said: str = ""
    control: AnswerContent | None = None
    retracted: tuple[Rule, ...] = ()
    prohibition: Understanding | None = None
    unanswered: str = ""
    called: str = ""

    def person(self, name: str) -> str:
        """The speaker whom a name means; the one who asks by the name he or she goes by."""
        speaker = self.base.match_speaker(name)
        return self.called if speaker == self.listener and self.called else speaker

    @property
    def decision(self) -> Decision | None:
        """The decision of the last command; None when it made none."""
        return self.last.result.decision if self.last and self.last.result else None

    def describe(self, rule: Rule) -> str:
        """A rule in words: "to pass a knife, often grab it by the blade"."""
        laid_down = norm_from_rule(rule)
        if laid_down:
            return self.words.norm_phrase(laid_down)
        said = meaning_from_rule(rule)
        return self.words.rule_phrase(said) if said else repr(rule)

    def quote(self, rule: Rule) -> str:
        """A rule in words, with who told it if that is not the listener."""
        return self.words.with_notes(self.describe(rule), "", self._source(rule))

    def note(self, what: str, rule: Rule) -> str:
        """Some words, with how often they hold by a rule, and who told it if not the listener."""
        often = self.words.adverb((rule.interval.lower, rule.interval.upper))
        return self.words.with_notes(what, often, self._source(rule))

    def _source(self, rule: Rule) -> str:
        return rule.speaker if rule.speaker != self.listener else ""


def spoken(key: str, *, done: bool = False, **slots: Slot | None) -> AnswerContent:
    """Return an answer by its key, with those of its slots that are filled."""
    given = {name: value for name, value in slots.items() if value is not None}
    return AnswerContent(key, given, "done" if done else "failed")
