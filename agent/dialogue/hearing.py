"""What a hearing may do: from the alternatives of a speech recogniser to a reply.

The certainty of a meaning is the sum of the scores of the alternatives that mean it. What is sure
is believed or done, all else is read back ("Did you say ..?") and carried out after a "yes". What
denies, forbids, corrects or changes trust, and a new word, is always read back; "stop" never is.
"""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import fsum
from typing import TypeGuard

from ...kb.rdf.record_mapping import group_pairs
from ...nlu.language import Language
from ...nlu.offers.checks import is_negative
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ...ontology.errors import ValidationError
from .conversation import Conversation, UnderstoodTurn, spoken
from .reply import OpenQuestion, Reply

SURE = 0.9  # the least certainty of what is believed or done unasked
NOTABLE = 0.01  # the least score of an alternative that puts in doubt whether something is denied
CLEAR = 2  # how many times surer than all else together a "yes" or a number must be
MAX_CHOICES = 3
MOST_REPAIRED = 2  # texts, for each takes some 0.05 s
RIGHT, SLOPE = 1.4, 3.0  # how often the nearest sentence by sound is right: 1.4 - 3 * its cost
FURTHER = 0.08  # how much rarer another one that sounds alike is right: of 186 recordings

Alternative = tuple[str, float]
"""A text that may have been said, and its score in [0, 1]."""

SoundsLike = Callable[[Language, str, Collection[str]], Mapping[str, float]]
"""Returns sentences that sound like a text and how far they are from it, per phone, nearest first;
some names are likely in them."""

_WORD = re.compile(r"[\w'-]+")
_HARMLESS = {"question", "ask_back"}
_CHANGES = (meaning.NormStatement, meaning.TrustStatement)


def weigh(text: str, heard: float, alternatives: Iterable[Alternative]) -> dict[str, float]:
    """Return the score of each text that may have been said, in [0, 1] and at most 1 in all.

    One is `text` with `heard`, if not an alternative. ValidationError for a score not in [0, 1].
    """
    scores = group_pairs(alternatives)
    scores.setdefault(text, [heard])
    given = [score for each in scores.values() for score in each]
    if not all(0 <= score <= 1 for score in given):
        raise ValidationError([f"The score {each} is not in [0, 1]." for each in given])
    total = max(1.0, fsum(given))
    return {said: min(1.0, fsum(each) / total) for said, each in scores.items()}


def reaction(
    text: str, scores: Mapping[str, float], language: Language, *, is_spoken: bool
) -> tuple[str, meaning.Control] | None:
    """Return what an utterance does to the command that is being carried out, and its text.

    It ends it ("stop"), or pauses or continues it; None where it waits until that is done. Any
    text that may have been said can end or pause it.
    """
    said = {each: language.understand(each).meaning for each in scores}
    own, stop = said[text], meaning.Control("stop")
    for each, found in said.items():
        if found == stop or (isinstance(found, meaning.SimpleCommand) and found.negated):
            return each, stop  # "stop passing me the knife" stops that, too
    waiting = next((each for each, found in said.items() if _is_halt(found)), None)
    if waiting is not None:
        return waiting, meaning.Control("wait")
    if isinstance(own, meaning.Control) and own.control == "continue":
        return (text, own) if scores[text] >= SURE else None
    is_no = is_spoken and own == meaning.Acknowledgement("no")
    return (text, stop) if is_no or isinstance(own, meaning.Control) else None


@dataclass(frozen=True)
class MeaningHeard:
    """What may have been meant: the likeliest text that means it, and how sure that is."""

    text: str
    certainty: float  #: the sum of the scores of all such texts, in [0, 1]
    understood: Understanding
    #: its meaning, or what it is as an answer; None where it is not understood
    said: meaning.Meaning | meaning.Answer | str | None
    new_words: tuple[str, ...] = ()  #: the words that it would teach

    @property
    def is_refusal(self) -> bool:
        """Whether it is a "no" or a "neither"."""
        said = self.said
        is_none = isinstance(said, meaning.Answer) and (said.number == 0 or said.is_dismissal)
        return is_none or said == meaning.Acknowledgement("no")

    @property
    def is_choice(self) -> bool:
        """Whether it is a "yes", a "no" or a number."""
        if isinstance(said := self.said, meaning.Acknowledgement):
            return said.ack in {"yes", "okay", "no"}
        return self.is_refusal or (isinstance(said, meaning.Answer) and said.number is not None)


def meanings_heard(
    text: str, scores: Mapping[str, float], conversation: Conversation, pending: OpenQuestion | None
) -> Sequence[MeaningHeard]:
    """Return what texts with these scores may mean, the likeliest first.

    Of equally likely ones that of `text` is first; `pending` is the question that they may answer.
    """
    groups: dict[object, list[MeaningHeard]] = {}
    for each, score in scores.items():
        understood = conversation.understand(each, conversation.listener, heard=1.0)
        said = _said(understood, conversation, pending)
        new = _new_words(understood)
        if said != understood.meaning:  # a short answer, whose words may all be new
            words = map(str.lower, _WORD.findall(each) if said else ())
            new = tuple(word for word in words if word not in conversation.language.lexicon)
        heard = MeaningHeard(each, score, understood, said, new)
        groups.setdefault(each if said is None else said, []).append(heard)

    def rank(each: MeaningHeard) -> tuple[float, bool]:
        return -each.certainty, each.text != text

    found: list[MeaningHeard] = []
    for same in groups.values():
        total = min(1.0, fsum(each.certainty for each in same))
        found.append(replace(min(same, key=rank), certainty=total))
    return sorted(found, key=rank)


def _said(
    understood: Understanding, conversation: Conversation, pending: OpenQuestion | None
) -> meaning.Meaning | meaning.Answer | str | None:
    language, text = conversation.language, understood.text
    if pending and not _is_halt(understood.meaning):
        number = language.chosen(text, len(pending.choices)) if pending.choices else None
        if number is not None:
            return meaning.Answer(number=number)
        if answers := language.short_answers(text, conversation.discourse):
            return answers[0]
    if understood.kind != "error" and (understood.kind != "ask_back" or understood.reading):
        return understood.meaning
    return text if pending and (pending.tell or pending.word) else None


@dataclass(frozen=True)
class SpokenUtterance:
    """What may have been meant by an utterance, the likeliest first, and what follows from it."""

    found: Sequence[MeaningHeard]
    conversation: Conversation
    pending: OpenQuestion | None  #: the question of Hilt that it may answer
    hear: Callable[..., Reply]  #: hears one of the texts as `DialogueManager.hear` does
    sounds_like: SoundsLike  #: finds what may have been said where it is not understood
    keep: bool  #: whether it is written to the history when it is read back

    def reply(self) -> Reply:
        """Carry out what is sure, or ask; return the reply."""
        if halts := [each for each in self.found if _is_halt(each.said)]:
            stop = meaning.Control("stop")
            return self._carry_out(next((each for each in halts if each.said == stop), halts[0]))
        answer = self._answer(self.pending) if self.pending else None
        return answer or self._carry_out_if_sure() or self._read_back()

    def _carry_out(self, each: MeaningHeard) -> Reply:
        return self.hear(each.text, heard=each.certainty)

    @property
    def _understood(self) -> list[MeaningHeard]:
        return [each for each in self.found if each.said is not None]

    def _answer(self, pending: OpenQuestion) -> Reply | None:
        first, *others = self.found
        best = next(iter(self._understood), first)
        if best.is_refusal and pending.no is None:
            return self.hear(best.text)
        is_again = len(pending.meanings) > 1 and first.said in pending.meanings
        if is_again and not self._is_open(first):
            return pending.choices[pending.meanings.index(first.said)]()
        if not first.is_choice:
            return None
        is_clear = first.certainty >= CLEAR * fsum(each.certainty for each in others)
        if is_clear and not any(map(self._denies, others)):
            return self.hear(first.text)
        return self._ask(self.conversation.last_said, pending)

    def _carry_out_if_sure(self) -> Reply | None:
        best, language = next(iter(self._understood), None), self.conversation.language
        if best is None or language.introduction(best.text):
            return None
        if best is self.found[0] and best.understood.kind == "acknowledgement":
            return self.hear(best.text)
        said = best.understood
        if said.kind in _HARMLESS and best.said == said.meaning and not best.new_words:
            again = self.conversation.understand(best.text, said.speaker, heard=best.certainty)
            is_sure = again.meaning == said.meaning
        else:
            is_sure = best.certainty >= SURE and not self._is_open(best)
        return self._carry_out(best) if is_sure else None

    def _is_open(self, each: MeaningHeard) -> bool:
        said = each.understood
        is_change = isinstance(said.meaning, _CHANGES) or said.kind == "correction"
        return is_change or bool(each.new_words) or any(map(self._denies, self.found))

    def _denies(self, each: MeaningHeard) -> bool:
        is_denied = self.conversation.language.denies(each.text) or each.is_refusal
        return each.certainty >= NOTABLE and (is_denied or is_negative(each.understood.meaning))

    def _read_back(self) -> Reply:
        first, understood = self.found[0], self._understood
        known = [each for each in understood if not each.new_words]
        new = [each for each in understood if each.new_words]
        if first in new and first.certainty >= SURE:
            return self._offer([first])
        strange = [e for e in self.found if e.said is None or e.new_words or e.understood.unknown]
        for each in strange[:MOST_REPAIRED] or [e for e in self.found[:1] if e not in known]:
            known += self._likely(each, {each.said for each in known})
        known.sort(key=lambda each: -each.certainty)
        choices = [*known[: MAX_CHOICES - bool(new)], *new][:MAX_CHOICES]
        if choices or first.understood.kind == "ask_back":
            return self._offer(choices or [first])
        return self._carry_out(first)  # which says what is not understood

    def _likely(self, first: MeaningHeard, known: Collection[object]) -> Iterator[MeaningHeard]:
        conversation, speaker = self.conversation, first.understood.speaker
        asked = () if first.understood.reading else getattr(first.understood.meaning, "choices", ())
        offers = [conversation.language.generate(e) for e in asked if not isinstance(e, str)]
        names = [name for rule in conversation.topic for name in (rule.object, rule.part) if name]
        names += conversation.visible()
        sounding = self.sounds_like(conversation.language, first.text, names)
        for place, text in enumerate((*sounding, *offers)):
            said = conversation.understand(text, speaker, heard=1.0)
            if said.meaning in known:
                return  # that is what was misheard
            share = max(0.0, RIGHT - SLOPE * sounding.get(text, 1.0)) * (FURTHER if place else 1)
            yield MeaningHeard(text, share, said, said.meaning, _new_words(said))

    def _offer(self, choices: Sequence[MeaningHeard]) -> Reply:
        conversation, is_one = self.conversation, len(choices) == 1
        said = [each.text.rstrip(" .?!,") for each in choices]
        numbered = ". ".join(f"{number}. {each}" for number, each in enumerate(said, start=1))
        question = conversation.say(spoken("did_you_say", said=said[0] if is_one else numbered))
        new = ", ".join("-".join(word.replace(" ", "")) for word in choices[0].new_words)
        if is_one and new:
            question += f" {conversation.say(spoken('is_new_word', word=new))}"
        pending = self.pending if self.pending and not self.pending.meanings else None
        takes = tuple(partial(self._take, each, pending, is_last=is_one) for each in choices)
        yes = takes[0] if is_one else partial(self._offer, choices)
        no = partial(self._ask, conversation.last_said, pending) if pending else None
        meanings = tuple(each.said for each in choices)
        speaker = self.found[0].understood.speaker
        return self._ask(question, OpenQuestion(speaker, yes, no, takes, meanings=meanings))

    def _ask(self, question: str, pending: OpenQuestion) -> Reply:
        first, conversation = self.found[0], self.conversation
        asked = meaning.AskBack(question, tuple(each.text for each in self.found))
        understood = replace(first.understood, meaning=asked, reading=None, new_words=())
        understood = replace(understood, discourse=conversation.discourse)
        conversation.open_question, conversation.last_said = pending, question
        turn = UnderstoodTurn(understood, first.certainty, self.keep)
        return conversation.recorded(turn, question, "asked")

    def _take(self, each: MeaningHeard, pending: OpenQuestion | None, *, is_last: bool) -> Reply:
        if each.new_words and not is_last:
            return self._offer([each])
        self.conversation.open_question = pending
        return self.hear(each.text, accepted=each.new_words)


def _new_words(understood: Understanding) -> tuple[str, ...]:
    asked = understood.reading if understood.kind == "ask_back" else None
    return tuple(word.said for word in (asked or understood).new_words)


def _is_halt(said: object) -> TypeGuard[meaning.Control]:
    return isinstance(said, meaning.Control) and said.is_halt
