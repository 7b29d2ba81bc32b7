# SPDX-License-Identifier: Apache-2.0
"""The dialogue: believe what is told, carry out what is asked, answer what is wanted.

Paper, section 3.2: of an utterance that wants something believed it is checked whether the speaker
is trusted; if so the rules are asserted, and only when they are stored is that acknowledged. One
that wants something done becomes a goal. Everything that is heard is kept in the history, also
what is refused or not understood.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from ..kb.beliefs import KnowledgeBase
from ..kb.rule import Rule
from ..nlu import meaning
from ..nlu.language import Language
from ..nlu.reference import Discourse
from ..nlu.understanding import Understanding
from ..ontology.errors import UnknownNameError
from .episodes import episode_of
from .goals import GoalManager
from .outcome import Achievement, Answer, World
from .questions import Knowledge, answer
from .reply import Reply
from .translation import request_of, rule_of, said_of

KINDS = {  # what a command of the CLI listens to -> kinds of meaning
    "tell": ("statement", "correction"),
    "do": ("command",),
    "ask": ("question",),
}
UNCLEAR = ("error", "ask_back")


class Dialogue:
    """One conversation.

    Args:
        base: where beliefs and the history are kept.
        language: how utterances are understood and answers put into words.
        goals: gives the goal manager, which is made when the first command comes.
        visible: tells the objects in view.
        seed: of everything random, kept with each reply.
    """

    def __init__(
        self,
        base: KnowledgeBase,
        language: Language,
        goals: Callable[[], GoalManager],
        visible: Callable[[], tuple[str, ...]],
        *,
        seed: int = 0,
    ) -> None:
        self.base = base
        self.language = language
        self.seed = seed
        self.last_done: Reply | None = None
        self._goals = goals
        self._visible = visible
        self._discourse = Discourse()
        self._listeners: dict[type, Callable[[Understanding, Any], Reply]] = {
            meaning.Statement: self._believe,
            meaning.Retraction: self._forget,
            meaning.Command: self._obey,
            meaning.ToolCommand: self._obey,
            meaning.Question: self._answer,
            meaning.Acknowledgement: self._acknowledge,
            meaning.AskBack: self._not_understood,
            meaning.Misunderstanding: self._not_understood,
        }

    def hear(self, text: str, *, speaker: str, only: str | None = None) -> Reply:
        """Understand one utterance, act on it, and answer.

        Args:
            text: what was said.
            speaker: who said it.
            only: "tell", "do" or "ask" to listen to statements, commands or questions only.

        Raises:
            StoreError: what was said could not be stored; then nothing was believed.
        """
        understood = self.language.understand(text, speaker=speaker, discourse=self._discourse)
        self._discourse = understood.discourse
        if only and understood.kind not in (*KINDS[only], *UNCLEAR):
            return self._answered(understood, Answer(f"only_{only}", {}, "not_understood"))
        return self._listeners[type(understood.meaning)](understood, understood.meaning)

    # --- Being told --------------------------------------------------------------------------

    def _believe(self, understood: Understanding, said: meaning.Statement) -> Reply:
        speaker = understood.speaker
        if not self._trusts(speaker):
            return self._answered(
                understood, Answer("not_trusted", {"speaker": speaker}, "refused")
            )
        rules = tuple(rule_of(rule, speaker) for rule in said.rules)
        known = {rule.id for rule in self.base.rules(speaker=speaker)}
        key = "known_already" if all(rule.id in known for rule in rules) else "learned"
        spoken = self._echo(key, rules)
        self.base.believe(understood.text, understood.content, speaker, rules, answer=spoken)
        self.language = self.language.with_words(understood.new_words)
        told = tuple(self.base.rule(rule.id) for rule in rules)
        return replace(self._reply(understood, spoken), rules=told)

    def _echo(self, key: str, rules: Iterable[Rule]) -> str:
        """Say back what was believed, a sentence a rule."""
        answers = (
            Answer(
                key,
                {
                    "rule": self._in_words(rule),
                    "confidence": (rule.interval.lower, rule.interval.upper),
                    "speaker": rule.speaker,
                },
            )
            for rule in rules
        )
        return " ".join(self._say(each) for each in answers)

    def _in_words(self, rule: Rule) -> str:
        said = said_of(rule)
        return self.language.phrase(said) if said else repr(rule)

    def _forget(self, understood: Understanding, said: meaning.Retraction) -> Reply:
        speaker = understood.speaker
        told = sorted(self.base.rules(speaker=speaker), key=lambda rule: rule.utterance or 0)
        if said.rule is not None:
            wanted = rule_of(said.rule, speaker)
            told = [
                rule
                for rule in told
                if rule.node == wanted.node and rule.features == wanted.features
            ]
        if not told:
            return self._answered(understood, Answer("nothing_to_forget", {}, "failed"))
        spoken = self.language.say("forgotten", rule=self._in_words(told[-1]))
        self.base.retract(told[-1].id, understood.text, understood.content, speaker, answer=spoken)
        return replace(self._reply(understood, spoken), rules=(told[-1],))

    # --- Being asked to do something -----------------------------------------------------------

    def _obey(
        self, understood: Understanding, said: meaning.Command | meaning.ToolCommand
    ) -> Reply:
        speaker = understood.speaker
        if not self._trusts(speaker):
            return self._answered(understood, Answer("not_obeyed", {"speaker": speaker}, "refused"))
        if said.negated:
            return self._answered(understood, _declined(said))
        try:
            came = self._goals().achieve(request_of(said, speaker))
        except UnknownNameError:
            came = Achievement(Answer("cannot", {"goal": said.goal}, "failed"), None, (), World())
        spoken = self._say(came.answer)
        reply = replace(
            self._reply(understood, spoken), ending=came.answer.ending, achievement=came
        )
        self._record(reply)
        self.base.record_episode(episode_of(reply))
        self.last_done = reply
        return reply

    # --- Being asked -------------------------------------------------------------------------

    def _answer(self, understood: Understanding, said: meaning.Question) -> Reply:
        known = Knowledge(self.base, self._in_words, self._visible, self.last_done)
        found, rules = answer(said, known)
        return replace(self._answered(understood, found), rules=rules)

    def _acknowledge(self, understood: Understanding, said: meaning.Acknowledgement) -> Reply:
        key = {"thanks": "welcome", "praise": "praised"}.get(said.ack, said.ack)
        return self._answered(understood, Answer(key))

    def _not_understood(
        self, understood: Understanding, said: meaning.AskBack | meaning.Misunderstanding
    ) -> Reply:
        asks = isinstance(said, meaning.AskBack)
        reply = replace(
            self._reply(understood, said.question if asks else said.message),
            ending="asked" if asks else "not_understood",
        )
        self._record(reply)
        return reply

    # --- Helpers -----------------------------------------------------------------------------

    def _trusts(self, speaker: str) -> bool:
        trust = self.base.trust(speaker)
        return trust is not None and trust.upper > 0

    def _answered(self, understood: Understanding, answered: Answer) -> Reply:
        """Put an answer into words, and keep what was heard in the history."""
        spoken = self._say(answered)
        reply = replace(self._reply(understood, spoken), ending=answered.ending)
        self._record(reply)
        return reply

    def _say(self, answered: Answer) -> str:
        """An answer in words, filled with those of its slots that the language asks for."""
        wanted = self.language.speech.answers[answered.key].slots
        return self.language.say(answered.key, **{name: answered.slots[name] for name in wanted})

    def _record(self, reply: Reply) -> None:
        understood = reply.understanding
        self.base.record(
            reply.text,
            understood.content,
            reply.speaker,
            understood.kind,
            accepted=reply.is_done,
            answer=reply.said,
        )

    def _reply(self, understood: Understanding, spoken: str) -> Reply:
        return Reply(
            understood.text, understood.speaker, understood, spoken, "done", seed=self.seed
        )


def _declined(said: meaning.Command | meaning.ToolCommand) -> Answer:
    """The answer to a command that forbids."""
    if isinstance(said, meaning.ToolCommand):
        return Answer("will_not_tool", {"goal": said.goal, "patient": said.patient}, "refused")
    name = said.target.object or said.target.used_for or "thing"
    return Answer("will_not", {"goal": said.goal, "object": name}, "refused")
