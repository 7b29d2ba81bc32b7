# SPDX-License-Identifier: Apache-2.0
"""The state of one conversation, and replies to its utterances, which the history keeps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from ...kb.knowledge_base import KnowledgeBase
from ...kb.rule import Rule
from ...nlu.language import Language
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics.coreference import Discourse
from .. import protocols
from ..execution.outcome import Ending, Slot, SpokenAnswer
from .answer_sources import Knowledge
from .open_question import OpenQuestion
from .reply import Reply
from .translation import meaning_from_rule


@dataclass(frozen=True)
class DialogueTurn:
    """One utterance as it was understood.

    Attributes:
        understood: how it was understood.
        heard: the confidence of the speech recogniser, in [0, 1].
        keep: whether it is written to the history when it teaches nothing.
    """

    understood: Understanding
    heard: float
    keep: bool

    @property
    def speaker(self) -> str:
        """Who said it."""
        return self.understood.speaker


class Conversation:
    """What was said, done and asked so far, and how Hilt says an answer.

    Args:
        base: where beliefs and the history are kept.
        language: understands utterances and words the answers.
        visible: returns the names of the objects in view.
        holding: returns the name of the object in the hand, None when it is empty.
        seed: the seed of everything random, kept with each reply.
        other: a language part that is asked first.

    Attributes:
        language: grows with every word that is learned.
        last_done: the reply to the last command.
    """

    def __init__(
        self,
        base: KnowledgeBase,
        language: Language,
        visible: Callable[[], tuple[str, ...]],
        *,
        holding: Callable[[], str | None],
        seed: int,
        other: protocols.Dialogue | None,
    ) -> None:
        self.base, self.language, self.seed = base, language, seed
        self.last_done: Reply | None = None
        self._other = other
        self._visible, self._holding = visible, holding
        self._discourse = Discourse()
        self._open: OpenQuestion | None = None
        self._topic: tuple[Rule, ...] = ()
        self._retracted: tuple[Rule, ...] = ()  # and no other rule was spoken of since
        self._just_acted = False  # and no rule was spoken of since
        self._last_said = ""
        self._control_done: SpokenAnswer | None = None  # since the last command

    def _knowledge(self, turn: DialogueTurn) -> Knowledge:
        return Knowledge(
            self.base,
            self.language.answers,
            turn.speaker,
            self._visible,
            self.last_done,
            self._topic,
            self._holding,
            self._last_said,
            self._control_done,
            self._retracted,
        )

    def _set_topic(self, rules: tuple[Rule, ...]) -> None:
        """Make these rules the topic; "no, by the handle" and "forget that" mean the last."""
        said = meaning_from_rule(rules[-1]) if rules else None
        if said:
            self._topic, self._retracted, self._just_acted = rules, (), False
            self._discourse = replace(self._discourse, rule=said)

    def _trusts(self, speaker: str) -> bool:
        trust = self.base.trust(speaker)
        return trust is not None and trust.upper > 0

    def _answered(self, turn: DialogueTurn, key: str, ending: Ending, **slots: Slot) -> Reply:
        return self._spoken(turn, SpokenAnswer(key, slots, ending))

    def _spoken(self, turn: DialogueTurn, answered: SpokenAnswer) -> Reply:
        return self._recorded(turn, self._say(answered), answered.ending)

    def _recorded(self, turn: DialogueTurn, spoken: str, ending: Ending) -> Reply:
        """Return the reply with this answer, and write the utterance to the history."""
        reply = replace(self._reply(turn, spoken), ending=ending)
        self._record(reply, turn)
        return reply

    def _say(self, answered: SpokenAnswer) -> str:
        """An answer in words, with the slots that its template has."""
        wanted = self.language.slots(answered.key)
        slots = {name: answered.slots[name] for name in wanted}
        spoken = self.language.say(answered.key, **slots)
        return self._other.say(answered, spoken) if self._other else spoken

    def _record(self, reply: Reply, turn: DialogueTurn) -> None:
        if not turn.keep:
            return
        self.base.record(
            reply.text,
            reply.understanding.content,
            reply.speaker,
            reply.understanding.kind,
            accepted=reply.is_done,
            answer=reply.said,
            heard=turn.heard,
        )

    def _reply(self, turn: DialogueTurn, spoken: str) -> Reply:
        understood = turn.understood
        return Reply(understood.text, turn.speaker, understood, spoken, "done", seed=self.seed)
