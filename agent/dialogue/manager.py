# SPDX-License-Identifier: Apache-2.0
"""The dialogue manager: asserts statements, carries out commands, answers questions.

Paper, section 3.2: the rules of a statement are asserted if its speaker is trusted, and are
acknowledged only when they are stored. A command becomes a goal. What is unclear or uncertain is
asked back, and the "yes" or "no" that follows is understood. The history keeps every utterance,
also one that is refused or not understood.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from ...kb.interval import Interval
from ...kb.knowledge_base import KnowledgeBase
from ...kb.rule import Atom, Rule
from ...nlu.language import Language
from ...nlu.lexicon.vocabulary import NewWord
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ...nlu.semantics.coreference import Discourse
from ...ontology.errors import UnknownNameError
from .. import protocols
from ..execution.goal_manager import GoalManager
from ..execution.outcome import Ending, ExecutionResult, GoalResult, Slot, SpokenAnswer
from ..execution.request import Request
from .knowledge import Knowledge
from .questions import answer
from .reply import Reply
from .teaching import (
    lesson_from_statement,
    rules_to_retract,
    word_for_person,
    word_from_base,
    word_to_keep,
)
from .translation import declined, meaning_from_rule, request_from_command, use_of

KINDS = {  # what a command of the CLI listens to -> kinds of meaning
    "tell": ("statement", "correction", "topic"),
    "do": ("command", "control"),
    "ask": ("question",),
}
ALWAYS_HEARD = ("error", "ask_back", "acknowledgement")


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


@dataclass(frozen=True)
class Pending:
    """A question of Hilt that waits for "yes", "no" or a number.

    Attributes:
        asked: the only speaker who can answer it.
        yes: called after a "yes".
        no: called after a "no"; None only acknowledges.
        choices: called after the number of a choice, by number from 1 on.
    """

    asked: str
    yes: Callable[[], Reply]
    no: Callable[[], Reply] | None = None
    choices: tuple[Callable[[], Reply], ...] = ()


class DialogueManager:
    """One conversation, with any number of speakers.

    Args:
        base: where beliefs and the history are kept.
        language: understands utterances and words the answers.
        goals: returns the goal manager, which is made when the first command comes.
        visible: returns the names of the objects in view.
        record_episode: called with every command that was carried out and its reply, and whether
            it is to be kept.
        holding: returns the name of the object in the hand, None when it is empty.
        seed: the seed of everything random, kept with each reply.
        other: a language part that is asked first.

    Attributes:
        language: grows with every word that is learned.
        contexts: what holds now beside the current action: places and roles, with their intervals.
        last_done: the reply to the last command.
    """

    def __init__(
        self,
        base: KnowledgeBase,
        language: Language,
        goals: Callable[[], GoalManager],
        visible: Callable[[], tuple[str, ...]],
        record_episode: Callable[[Request, Reply, bool], None],
        *,
        holding: Callable[[], str | None] = lambda: None,
        seed: int = 0,
        other: protocols.Dialogue | None = None,
    ) -> None:
        self.base = base
        self._other = other
        people = (word_for_person(name) for name in base.trust_by_speaker())
        self.language = language.with_words(
            (*(word_from_base(word) for word in base.words()), *people)
        )
        self.seed = seed
        self.contexts: dict[Atom, Interval] = {}
        self.last_done: Reply | None = None
        self._goals = goals
        self._visible, self._holding = visible, holding
        self._record_episode = record_episode
        self._discourse = Discourse()
        self._pending: Pending | None = None
        self._topic: tuple[Rule, ...] = ()
        self._retracted: tuple[Rule, ...] = ()  # and no other rule was spoken of since
        self._just_acted = False  # and no rule was spoken of since
        self._last_said = ""
        self._interrupted: tuple[DialogueTurn, Request] | None = None  # the command to continue
        self._just_stopped: SpokenAnswer | None = None  # until a control has confirmed it
        self._listeners: dict[type, Callable[[DialogueTurn, Any], Reply]] = {
            meaning.Statement: self._learn,
            meaning.Retraction: self._forget,
            meaning.Topic: self._open_topic,
            meaning.Command: self._carry_out_command,
            meaning.ToolCommand: self._carry_out_command,
            meaning.Question: self._answer,
            meaning.Acknowledgement: self._acknowledge,
            meaning.Control: self._obey,
            meaning.AskBack: self._ask_back,
            meaning.Misunderstanding: self._not_understood,
        }

    def hear(
        self,
        text: str,
        *,
        speaker: str,
        only: str | None = None,
        heard: float = 1.0,
        keep: bool = True,
        accepted: Collection[str] = (),
    ) -> Reply:
        """Understand one utterance, act on it, and return the reply.

        The arguments are those of `Agent.hear`; `accepted` has words that are new although they
        resemble known ones.

        Raises:
            StoreError: what was said could not be stored; then nothing was believed.
        """
        speaker = self.base.match_speaker(speaker)
        pending, number = self._pending, self._chosen(text, speaker)
        if pending and number:
            return pending.choices[number - 1]()
        understood = self._understood(text, speaker, accepted, heard)
        if number == 0:
            understood = replace(understood, meaning=meaning.Acknowledgement("no"))
        turn = DialogueTurn(understood, heard, keep)
        if only and understood.kind not in (*KINDS[only], *ALWAYS_HEARD):
            return self._answered(turn, f"only_{only}", "not_understood")
        if understood.kind not in {"acknowledgement", "control"}:
            self._pending = None
        return self._respond(turn)

    def hear_aside(
        self, text: str, said: meaning.Control, *, speaker: str, heard: float, keep: bool
    ) -> Reply:
        """Confirm a "wait" or "go on" while another thread carries out a command."""
        speaker = self.base.match_speaker(speaker)
        turn = DialogueTurn(Understanding(text, speaker, "self", said), heard, keep)
        return self._answered(turn, "waiting" if said.is_halt else "going_on", "done")

    def _respond(self, turn: DialogueTurn) -> Reply:
        """Act on what was understood, and return the reply."""
        self._discourse = turn.understood.discourse
        said = turn.understood.meaning
        reply = self._listeners[type(said)](turn, said)
        self._last_said = reply.said
        return reply

    def _understood(
        self, text: str, speaker: str, accepted: Collection[str], heard: float
    ) -> Understanding:
        said = self._other.understand(text, speaker=speaker) if self._other else None
        if said is not None:
            return Understanding(text, speaker, "self", said, discourse=self._discourse)
        return self.language.understand(
            text, speaker=speaker, discourse=self._discourse, accepted=accepted, heard=heard
        )

    # --- Statements and retractions -----------------------------------------------------------

    def _learn(self, turn: DialogueTurn, said: meaning.Statement) -> Reply:
        if not self._trusts(turn.speaker):
            return self._answered(turn, "not_trusted", "refused", speaker=turn.speaker)
        taught = lesson_from_statement(self.base, said, turn.speaker, turn.heard, self._topic)
        trust = self.base.trust(turn.speaker)
        weight = trust.lower if trust else 0.0
        echo = taught.echo(self._knowledge(turn).describe, turn.speaker, weight, turn.heard)
        spoken = " ".join(self._say(each) for each in (echo, *_new(turn.understood.new_words)))
        self.base.believe(
            turn.understood.text,
            turn.understood.content,
            turn.speaker,
            taught.rules,
            supersedes=[rule.id for rule in taught.supersedes],
            words=[word_to_keep(word, turn.speaker) for word in turn.understood.new_words],
            kind=turn.understood.kind,
            answer=spoken,
            heard=turn.heard,
        )
        self.language = self.language.with_words(turn.understood.new_words)
        told = tuple(self.base.rule(rule.id) for rule in taught.rules)
        self._set_topic(told)
        return replace(self._reply(turn, spoken), rules=told)

    def _forget(self, turn: DialogueTurn, said: meaning.Retraction) -> Reply:
        if said == meaning.Retraction() and self._just_acted:  # "never mind" means the action
            return self._answered(turn, "forget_what", "failed")
        rules = rules_to_retract(self.base, said, turn.speaker, self._topic)
        own = [rule for rule in rules if rule.speaker == turn.speaker]
        if rules and not own:
            return self._answered(turn, "not_yours", "failed", speaker=rules[0].speaker)
        if not own:
            return self._answered(turn, "nothing_to_forget", "failed")
        return self._retract(turn, own)

    def _retract(self, turn: DialogueTurn, rules: Sequence[Rule]) -> Reply:
        phrases = tuple(map(self._knowledge(turn).describe, rules))
        spoken = self._say(SpokenAnswer("forgotten", {"rules": phrases}))
        understood = turn.understood
        self.base.believe(
            understood.text,
            understood.content,
            turn.speaker,
            (),
            retracts=[rule.id for rule in rules],
            kind="correction",
            answer=spoken,
        )
        self._topic, self._retracted = (), tuple(rules)
        return replace(self._reply(turn, spoken), rules=self._retracted)

    def _open_topic(self, turn: DialogueTurn, said: meaning.Topic) -> Reply:
        """Ask about what the speaker wants to speak of, which may be a new thing."""
        if not self._trusts(turn.speaker):
            return self._answered(turn, "not_trusted", "refused", speaker=turn.speaker)
        words = turn.understood.new_words
        spoken = self._say(SpokenAnswer("topic", {"object": said.topic}))
        self.base.believe(
            turn.understood.text,
            turn.understood.content,
            turn.speaker,
            (),
            words=[word_to_keep(word, turn.speaker) for word in words],
            kind="topic",
            answer=spoken,
            heard=turn.heard,
        )
        self.language = self.language.with_words(words)
        return self._reply(turn, spoken)

    # --- Commands -----------------------------------------------------------------------------

    def _carry_out_command(
        self, turn: DialogueTurn, said: meaning.Command | meaning.ToolCommand
    ) -> Reply:
        if not self._trusts(turn.speaker):
            return self._answered(turn, "not_obeyed", "refused", speaker=turn.speaker)
        if said.negated:
            return self._spoken(turn, declined(said))
        if turn.understood.unknown:
            words = turn.understood.unknown
            key = "unknown_use" if words == (use_of(said),) else "unknown_thing"
            return self._answered(turn, key, "asked", words=words)
        request = request_from_command(said, turn.speaker, self.language.tool_acts)
        return self._carry_out(turn, replace(request, contexts=self.contexts))

    def attempt(self, request: Request) -> tuple[GoalResult, str]:
        """Carry out a request; return its result and the spoken answer."""
        try:
            result = self._goals().achieve(request)
        except UnknownNameError:
            answered = SpokenAnswer("cannot", {"goal": request.action}, "failed")
            result = GoalResult(answered, None, (), ExecutionResult())
        return result, " ".join(self._say(each) for each in (*result.setbacks, result.answer))

    def _carry_out(self, turn: DialogueTurn, request: Request) -> Reply:
        result, spoken = self.attempt(request)
        reply = replace(self._reply(turn, spoken), ending=result.answer.ending, result=result)
        self._record(reply, turn)
        self._record_episode(request, reply, turn.keep)
        self.last_done = reply
        self._interrupted = (turn, request) if reply.is_interrupted else None
        self._just_stopped = result.answer if reply.is_interrupted else None
        self._topic = ()
        self._set_topic(result.decision.rules if result.decision else ())
        self._just_acted = True
        settled = request.confirmed(result)
        if reply.ending == "asked" and settled:
            self._pending = Pending(turn.speaker, yes=lambda: self._carry_out(turn, settled))
        return reply

    # --- Controls -----------------------------------------------------------------------------

    def _obey(self, turn: DialogueTurn, said: meaning.Control) -> Reply:
        """Carry out a control while no command runs; one that ran was interrupted before."""
        pending, self._pending = self._pending, None
        stopped, self._just_stopped = self._just_stopped, None
        if said.control == "stop" and stopped:
            return self._spoken(turn, replace(stopped, ending="done"))
        if said.is_halt:
            return self._answered(turn, "waiting" if said.control == "wait" else "idle", "done")
        if not self._trusts(turn.speaker):
            return self._answered(turn, "not_obeyed", "refused", speaker=turn.speaker)
        if said.control == "continue":
            return self._continue(turn, pending)
        if self.last_done is None:  # there is no need of a body yet
            return self._answered(turn, "nothing_held", "failed")
        return self._spoken(turn, self._goals().empty_hand(said.control, said.object))

    def _continue(self, turn: DialogueTurn, pending: Pending | None) -> Reply:
        if pending and pending.asked == turn.speaker:
            return pending.yes()
        if self._interrupted:
            return self._carry_out(*self._interrupted)
        return self._answered(turn, "nothing_to_continue", "failed")

    # --- Questions, acknowledgements, and what is asked back -----------------------------------

    def _answer(self, turn: DialogueTurn, said: meaning.Question) -> Reply:
        found, rules = answer(said, self._knowledge(turn))
        self._set_topic(rules)
        return replace(self._spoken(turn, found), rules=rules)

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
            self._retracted,
        )

    def _acknowledge(self, turn: DialogueTurn, said: meaning.Acknowledgement) -> Reply:
        pending = self._pending
        if pending and pending.asked != turn.speaker:
            pending = None
        else:
            self._pending = None
        if pending and said.ack in {"yes", "okay"}:
            return pending.yes()
        if pending and said.ack == "no" and pending.no:
            return pending.no()
        key = {"thanks": "welcome", "praise": "praised"}.get(said.ack, said.ack)
        return self._answered(turn, key, "done")

    def _ask_back(self, turn: DialogueTurn, said: meaning.AskBack) -> Reply:
        reply = self._recorded(turn, said.question, "asked")
        choices = [each for each in said.choices if not isinstance(each, str)]
        if choices:
            self._offer(turn, said, choices)
            return reply
        text, speaker = turn.understood.text, turn.speaker
        meant = self._corrected(turn, said)
        if said.choices == (text,):  # heard with low confidence: a "yes" confirms it
            self._pending = Pending(
                speaker, lambda: self.hear(text, speaker=speaker, keep=turn.keep)
            )
        elif meant:
            again, word = meant
            self._pending = Pending(
                speaker,
                yes=lambda: self.hear(again, speaker=speaker, heard=turn.heard),
                no=lambda: self.hear(text, speaker=speaker, heard=turn.heard, accepted=[word]),
            )
        return reply

    def _offer(
        self, turn: DialogueTurn, said: meaning.AskBack, choices: Sequence[meaning.Meaning]
    ) -> None:
        """Wait for the choice of a meaning."""
        heard = tuple(partial(self._take, turn, each) for each in choices)
        again = partial(self._ask_back, turn, said)
        only = heard[0] if len(heard) == 1 else again
        self._pending = Pending(turn.speaker, only, choices=heard)

    def _take(self, turn: DialogueTurn, choice: meaning.Meaning) -> Reply:
        """Respond to a chosen meaning, of the sentence that has it or as one that says it."""
        if turn.understood.reading is not None:
            return self._respond(replace(turn, understood=turn.understood.chosen(choice)))
        text = self.language.generate(choice)
        return self.hear(text, speaker=turn.speaker, heard=turn.heard)

    def _chosen(self, text: str, speaker: str) -> int | None:
        """Which of the choices offered a text takes, 0 for none; None if it is no answer."""
        pending = self._pending
        if pending is None or pending.asked != speaker or not pending.choices:
            return None
        return self.language.chosen(text, len(pending.choices))

    def _corrected(self, turn: DialogueTurn, said: meaning.AskBack) -> tuple[str, str] | None:
        """The utterance with the suggested word in place of the unknown one, and the latter."""
        words = turn.understood.words
        unknown = [word for word in words if not self.language.knows(word)]
        match said.choices:
            case (str(choice),) if unknown:
                return " ".join(choice if w == unknown[0] else w for w in words), unknown[0]
            case _:
                return None

    def _not_understood(self, turn: DialogueTurn, said: meaning.Misunderstanding) -> Reply:
        problem = said.message
        if self._last_said.startswith(problem):
            problem = self._say(SpokenAnswer("still_not_understood"))
        example = SpokenAnswer("try_saying", {"example": said.nearest[:1]})
        step = self._say(example if said.nearest else SpokenAnswer("ask_for_help"))
        return self._recorded(turn, f"{problem} {step}", "not_understood")

    # --- Helpers -----------------------------------------------------------------------------

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


def _new(words: Sequence[NewWord]) -> Iterator[SpokenAnswer]:
    if words:
        yield SpokenAnswer("learned_words", {"words": tuple(word.word for word in words)})
