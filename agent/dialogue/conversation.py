"""The state of one conversation, and replies to its utterances, which the history keeps.

The parts of the dialogue manager share one `Conversation`, and change its state between turns.
"""

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from ...kb.history import IMPORT
from ...kb.interval import CERTAIN, Interval
from ...kb.knowledge_base import KnowledgeBase
from ...kb.learned import LearnedPhrase
from ...kb.rule import Atom, Rule
from ...nlu.language import Language, Session
from ...nlu.lexicon.vocabulary import NewWord
from ...nlu.offers.meaning_shapes import MeaningShape
from ...nlu.offers.phrase_memory import PhrasePattern
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ...nlu.semantics.discourse import Discourse
from ...ontology.logs import timed
from .. import protocols
from ..execution.outcome import AnswerContent, Decision, Ending, Slot
from . import translation
from .acquaintances import Acquaintances
from .reply import OpenQuestion, Reply

OPEN = ("error", "ask_back")  # the kinds of what is not understood
SENTENCE_END = re.compile(r"(?<=[.!?])\s+")

Answered = tuple[AnswerContent, tuple[Rule, ...]]  # an answer, and the rules that it rests on


@dataclass(frozen=True)
class UnderstoodTurn:
    """One utterance as it was understood.

    `heard` is the confidence of the speech recogniser, in [0, 1]; `keep` says whether it is written
    to the history when it teaches nothing.
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
        seed: the seed of everything random, kept with each reply.
        other: a language part that is asked first.
    """

    def __init__(
        self,
        base: KnowledgeBase,
        language: Language,
        visible: Callable[[], tuple[str, ...]],
        *,
        holding: Callable[[], str | None] = lambda: None,
        seed: int = 0,
        other: protocols.Dialogue | None = None,
    ) -> None:
        self.base, self._seed, self._other = base, seed, other
        self.language, self._noticed = language, -1
        self.notice_others()
        self.people, self.visible, self.holding = Acquaintances(base), visible, holding
        self.discourse = Discourse()
        self.open_question: OpenQuestion | None = None
        #: the rules that were spoken of last; none after a command that needed none
        self.topic: tuple[Rule, ...] = ()
        self.topic_from: Literal["lesson", "answer", "deed"] = "answer"  #: in what it was spoken of
        self.retracted: tuple[Rule, ...] = ()  #: those just retracted; none once others were topic
        #: who spoke last; what answered the last question, while nobody has told what it asks
        self.listener = self.unanswered = self.last_said = ""
        self.last_done: Reply | None = None  #: the reply to the last command
        self.control_done: AnswerContent | None = None  #: what a control did since then
        self.noted = defaultdict[str, dict[Atom, Interval]](dict)  #: what kinds at hand are like
        self.noted_in: dict[str, Understanding] = {}  #: who said so, by kind
        self.reason: Understanding | None = None  #: what the last reply rests on, if no rule

    def notice_others(self) -> bool:
        """Add the words, phrases and people that other robots at the same base have learned.

        Returns whether anything was said to any of them since the last call.
        """
        sequence = self.base.sequence if self.base.is_shared else 0
        is_new, self._noticed = sequence != self._noticed, sequence
        if is_new:
            people = map(translation.word_for_person, self.base.trust_by_speaker())
            names = (*map(translation.word_from_base, self.base.words()), *people)
            kept = ((each.pattern.split(" "), each.meaning) for each in self.base.phrases())
            phrases = (PhrasePattern(tuple(words), MeaningShape(meant)) for words, meant in kept)
            self.language = self.language.with_words(names).with_phrases(phrases)
        return is_new

    def expect_news(self) -> None:
        """Let the next `notice_others` look: the base was changed past this conversation."""
        self._noticed = -1

    # --- What is understood and known ---------------------------------------------------------

    def understand(
        self, text: str, speaker: str, *, heard: float, accepted: Collection[str] = ()
    ) -> Understanding:
        """Return how an utterance is understood here; the rest is as in `Language.understand`."""
        said = self._other.understand(text, speaker=speaker) if self._other else None
        if said is not None:
            return Understanding(text, speaker, "self", said, discourse=self.discourse)
        with timed(__name__, "understand %r", text):
            return self.language.understand(
                text, speaker=speaker, discourse=self.discourse, accepted=accepted, heard=heard
            )

    def sentences(self, found: Understanding, kinds: Collection[str] = ()) -> list[Understanding]:
        """Return the sentences of what is not understood, if each stands alone; else just that."""
        session, said = Session(self.language, self.discourse), list[Understanding]()
        for text in SENTENCE_END.split(found.text.strip()) if found.kind in OPEN else ():
            each, session = session.hear(text, speaker=found.speaker)
            if not _stands_alone(each.meaning) or each.kind not in (kinds or {each.kind}):
                return [found]
            said.append(each)
        return said or [found]

    @property
    def decision(self) -> Decision | None:
        """The decision of the last command; None when it made none."""
        return self.last_done.decision if self.last_done else None

    def person(self, name: str) -> str:
        """Return the speaker whom a name means; who asks goes by the name given to Hilt."""
        speaker = self.base.match_speaker(name)
        return self.people.called(speaker) if speaker == self.listener else speaker

    # --- What changes ------------------------------------------------------------------------

    def believe(
        self,
        turn: UnderstoodTurn,
        rules: Iterable[Rule],
        spoken: str,
        words: Iterable[NewWord] = (),
        looks: Mapping[str, str] | None = None,
        **more: Any,
    ) -> None:
        """Let the base believe rules and new words by a turn, and add the words to the language.

        `looks` has those of words; the rest is as in `KnowledgeBase.believe`.
        """
        said, looks = (turn.understood.text, turn.understood.content, turn.speaker), looks or {}
        kept = {word.word: translation.word_to_keep(word, turn.speaker) for word in words}
        more["words"] = [replace(each, look=looks.get(name, "")) for name, each in kept.items()]
        self.base.believe(*said, rules, answer=spoken, heard=turn.heard, **more)
        self.language = self.language.with_words(words)

    def note(self, name: str, props: Iterable[str], *, is_so: bool) -> None:
        """Note what the thing of a kind at hand is like or not; of opposites the last one holds."""
        for prop in props:
            denied = self.language.opposites(prop) if is_so else {prop}
            told = dict.fromkeys(denied, Interval(0.0, 0.0)) | ({prop: CERTAIN} if is_so else {})
            self.noted[name] |= {Atom("property", each): held for each, held in told.items()}

    def lesson_reply(self, turn: UnderstoodTurn, rules: Iterable[Rule], spoken: str) -> Reply:
        """Return the reply to a lesson, and make its rules the topic."""
        told = tuple(self.base.rule(rule.id) for rule in rules)
        self.set_topic(told)
        self.topic_from = "lesson"
        return replace(self.reply(turn, spoken), rules=told)

    def vouch(
        self, speaker: str, name: str, lower: float = 1.0, upper: float | None = None
    ) -> AnswerContent:
        """Trust a person because a speaker says so, at most as far as the speaker is trusted.

        The trust is that of `KnowledgeBase.set_trust`. The answer says whether it is set.
        """
        asked = Interval(lower, 1.0 if upper is None else upper)
        person = self.base.match_speaker(name)
        if not self.people.may_vouch(speaker, person):
            return AnswerContent("may_not_vouch", {"speaker": person}, "refused")
        self.trust(person, min(asked.lower, self.people.trust_in(speaker)), upper, by=speaker)
        return spoken("trusts_now" if lower else "trusts_no_more", done=True, speaker=person)

    def trust(self, person: str, lower: float = 1, upper: float | None = None, *, by: str) -> None:
        """Set the trust in a person, whose name can be said from now on."""
        self.base.set_trust(person, lower, upper=upper, by=by)
        self.language = self.language.with_words([translation.word_for_person(person)])

    def wait_for(
        self, turn: UnderstoodTurn, yes: Callable[[], Reply] | None = None, **answers: Any
    ) -> None:
        """Wait for the speaker's answer to a question; the rest is as in `OpenQuestion`."""
        self.open_question = OpenQuestion(turn.speaker, yes, **answers)

    def learn_phrase(self, turn: UnderstoodTurn, meant: meaning.Meaning) -> None:
        """Keep how a turn says what its speaker has confirmed, if that is worth remembering."""
        text, speaker = turn.understood.text, turn.speaker
        phrase = self.language.phrase_of(text, meant)
        if phrase is not None and self.people.trusts(speaker):
            self.language = self.language.with_phrases([phrase])
            pattern = " ".join(phrase.pattern)
            self.base.learn_phrase(LearnedPhrase(pattern, phrase.shape.text, text, speaker))

    def set_topic(self, rules: tuple[Rule, ...]) -> None:
        """Make these rules the topic; "no, by the handle" and "forget that" mean the last.

        Nothing changes where there are none, or where the last one cannot be said.
        """
        said = translation.meaning_from_rule(rules[-1]) if rules else None
        if said or (rules and rules[-1].kind == "norm"):
            self.topic, self.retracted, self.unanswered = rules, (), ""
            self.topic_from = "answer"
        if isinstance(said, meaning.Rule):
            self.discourse = replace(self.discourse, rule=said)

    # --- Answers and replies ------------------------------------------------------------------

    def describe(self, rule: Rule) -> str:
        """Return a rule in words: "to pass a knife, often grab it by the blade"."""
        said, words = translation.meaning_from_rule(rule), self.language.answers
        if isinstance(said, meaning.Norm):
            return words.norm_phrase(said)
        if isinstance(said, meaning.KindRelation):
            return words.kind_phrase(said)
        return words.rule_phrase(said) if said else repr(rule)

    def words_of(self, rule: Rule) -> str:
        """Return the sentence that taught a rule; what came from a file was not said in words."""
        utterance = self.base.utterance(rule.utterance) if rule.utterance else None
        if utterance is None or utterance.kind == IMPORT:
            return self.describe(rule)
        return utterance.text

    def quote(self, rule: Rule, what: str = "") -> str:
        """Return a rule in words, or else `what` with how often it holds by the rule.

        Who told the rule is said, if that is not the listener.
        """
        words, source = self.language.answers, rule.speaker if rule.speaker != self.listener else ""
        often = words.adverb((rule.interval.lower, rule.interval.upper)) if what else ""
        return words.with_notes(what or self.describe(rule), often, source)

    def say(self, answered: AnswerContent) -> str:
        """Return an answer in words, with the slots that its template has."""
        slots = {each: answered.slots[each] for each in self.language.answers.slots(answered.key)}
        spoken = self.language.say(answered.key, **slots)
        return self._other.say(answered, spoken) if self._other else spoken

    def reply(self, turn: UnderstoodTurn, spoken: str, ending: Ending = "done") -> Reply:
        """Return the reply to a turn with an answer in words; the history is not written."""
        said = (turn.understood.text, turn.speaker, turn.understood, spoken)
        return Reply(*said, ending, seed=self._seed, heard=turn.heard)

    def answered(self, turn: UnderstoodTurn, key: str, ending: Ending, **slots: Slot) -> Reply:
        """Write a turn to the history, and return its reply with the answer of this template."""
        return self.spoken(turn, AnswerContent(key, slots, ending))

    def spoken(self, turn: UnderstoodTurn, answered: AnswerContent) -> Reply:
        """Write a turn to the history, and return its reply with an answer put in words."""
        return self.recorded(turn, self.say(answered), answered.ending)

    def recorded(self, turn: UnderstoodTurn, spoken: str, ending: Ending) -> Reply:
        """Write a turn to the history, and return its reply with an answer in words."""
        reply = self.reply(turn, spoken, ending)
        self.record(reply, turn)
        return reply

    def record(self, reply: Reply, turn: UnderstoodTurn) -> None:
        """Write the reply to a turn to the history, if the turn is to be kept."""
        if turn.keep:
            said = (reply.text, turn.understood.content, turn.speaker, turn.understood.kind)
            done, heard = reply.is_done, turn.heard
            self.base.record(*said, accepted=done, answer=reply.said, heard=heard)


def spoken(key: str, *, done: bool = False, **slots: Slot | None) -> AnswerContent:
    """Return an answer by its key, with those of its slots that are filled."""
    given = {name: value for name, value in slots.items() if value is not None}
    return AnswerContent(key, given, "done" if done else "failed")


def _stands_alone(said: meaning.Meaning) -> bool:
    if isinstance(said, meaning.Question):  # not "is that true?"
        return bool(said.object or said.affordance)
    kinds = (*meaning.TEACHING, meaning.Plan, meaning.Command, meaning.ToolCommand)
    is_polite = getattr(said, "ack", "") in {"thanks", "praise", "greeting", "okay", "farewell"}
    return is_polite or (isinstance(said, kinds) and not getattr(said, "negated", False))
