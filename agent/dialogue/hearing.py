"""What a hearing may do: from the alternatives of a speech recogniser to a reply.

The certainty of a meaning is the sum of the scores of the alternatives that mean it. What is sure
is believed or done, all else is read back ("Did you say ..?") and carried out after a "yes". What
denies, forbids, corrects or changes trust, and a new word, is read back however sure it is. "Stop"
needs no certainty.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import fsum
from typing import TypeGuard

from ...nlu.language import Language
from ...nlu.offers import checks
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ...ontology.errors import ValidationError
from .conversation import Conversation, UnderstoodTurn, spoken
from .reply import OpenQuestion, Reply

SURE = 0.9
"""The least certainty of what is believed or done unasked."""

NOTABLE = (
    0.01  # the least score with which an alternative puts in doubt whether something is denied
)
CLEAR = 2  # how many times surer than all else together a "yes" must be
MAX_CHOICES = 3

Alternative = tuple[str, float]
"""A text that may have been said, and its score in [0, 1]."""

SoundsLike = Callable[[Language, str, Collection[str]], Iterable[str]]
"""Returns sentences that sound like a text, the nearest first; some names are likely in them."""


def like_nothing(*_: object) -> tuple[str, ...]:
    """Return no sentences, where nothing is known of sounds."""
    return ()


_HARMLESS = {"question", "acknowledgement", "ask_back"}
_SIMPLE_COMMANDS = (meaning.Command, meaning.ToolCommand)
_CHANGES = (meaning.NormStatement, meaning.TrustStatement)


def weigh(text: str, heard: float, alternatives: Iterable[Alternative]) -> dict[str, float]:
    """Return the score of each text that may have been said, in [0, 1] and at most 1 in all.

    `text` with `heard` is one of them, if it is not among the alternatives. ValidationError if a
    score is no number in [0, 1].
    """
    scores: dict[str, list[float]] = {}
    for said, score in alternatives:
        scores.setdefault(said, []).append(score)
    scores.setdefault(text, [heard])
    wrong = [each for all_of_one in scores.values() for each in all_of_one if not 0 <= each <= 1]
    if wrong:
        raise ValidationError([f"The score {each} is not in [0, 1]." for each in wrong])
    total = max(1.0, fsum(score for each in scores.values() for score in each))
    return {said: fsum(each) / total for said, each in scores.items()}


def reaction(
    text: str, scores: Mapping[str, float], language: Language, *, is_spoken: bool
) -> tuple[str, meaning.Control] | None:
    """Return what an utterance does to the command that is being carried out, and its text.

    It ends it ("stop"), or pauses or continues it; None where it waits until that is done. Any
    text that may have been said can end or pause it.
    """
    said = {each: language.understand(each).meaning for each in (text, *scores)}
    own, stop = said[text], meaning.Control("stop")
    for each, found in said.items():
        if found == stop or (isinstance(found, _SIMPLE_COMMANDS) and found.negated):
            return each, stop  # "stop passing me the knife" stops that, too
    waiting = next((each for each, found in said.items() if _is_halt(found)), None)
    if waiting is not None:
        return waiting, meaning.Control("wait")
    if own == meaning.Control("continue"):
        return (text, meaning.Control("continue")) if scores[text] >= SURE else None
    is_no = is_spoken and own == meaning.Acknowledgement("no")
    return (text, stop) if is_no or isinstance(own, meaning.Control) else None


@dataclass(frozen=True)
class MeaningHeard:
    """A meaning of what was heard.

    Attributes:
        text: the likeliest of the texts that mean it.
        certainty: the sum of the scores of these texts, in [0, 1].
        understood: how the text is understood.
        said: the meaning, the answer or the text that it is to the open question, or None.
    """

    text: str
    certainty: float
    understood: Understanding
    said: meaning.Meaning | meaning.Answer | str | None

    @property
    def is_refusal(self) -> bool:
        """Whether it is a "no"."""
        said = self.said
        is_none = isinstance(said, meaning.Answer) and (said.number == 0 or said.is_dismissal)
        return is_none or said == meaning.Acknowledgement("no")

    @property
    def is_choice(self) -> bool:
        """Whether it is a "yes", a "no" or a number."""
        said = self.said
        is_yes = isinstance(said, meaning.Acknowledgement) and said.ack in {"yes", "okay"}
        is_number = isinstance(said, meaning.Answer) and said.number is not None
        return is_yes or is_number or self.is_refusal

    @property
    def new_words(self) -> tuple[str, ...]:
        """The words that it would teach."""
        return tuple(word.said for word in self.understood.new_words)


@dataclass(frozen=True)
class _Heard:
    """An utterance with its meanings, the likeliest first, and the question that it may answer."""

    found: tuple[MeaningHeard, ...]
    pending: OpenQuestion | None
    hear: Callable[..., Reply]
    keep: bool

    @property
    def first(self) -> MeaningHeard:
        return self.found[0]

    @property
    def understood(self) -> list[MeaningHeard]:
        return [each for each in self.found if each.said is not None]

    def taken(self, each: MeaningHeard) -> Reply:
        return self.hear(each.text, heard=each.certainty)


class SpokenDialogue:
    """Decides in a conversation what follows from the alternatives of a recogniser.

    Args:
        hear: hears a text as if it were typed; its arguments are those of `DialogueManager.hear`.
        respond: acts on what was understood, and returns the reply.
        sounds_like: finds what may have been said where a text is not understood.
    """

    def __init__(
        self,
        conversation: Conversation,
        hear: Callable[..., Reply],
        respond: Callable[[UnderstoodTurn], Reply],
        sounds_like: SoundsLike,
    ) -> None:
        self._conversation, self._sounds_like = conversation, sounds_like
        self._hear, self._respond = hear, respond
        self._asked: OpenQuestion | None = None  # the last one that read back what was heard
        self._choices: Sequence[MeaningHeard] = ()

    def reply(
        self, text: str, scores: Mapping[str, float], speaker: str, only: str | None, *, keep: bool
    ) -> Reply:
        """Return the reply to an utterance, of which each text with a score may have been said.

        Of equally likely ones `text` was said. The rest is as in `DialogueManager.hear`.
        """
        pending = self._conversation.open_question
        pending = pending if pending and pending.asked == speaker else None
        found = self._meanings(text, scores, speaker, pending)
        halts = {c.control: each for each in found if (c := each.said) and _is_halt(c)}
        if halts:
            halt = halts.get("stop") or halts["wait"]
            return self._respond(UnderstoodTurn(halt.understood, halt.certainty, keep))
        hear = partial(self._hear, speaker=speaker, only=only, keep=keep)
        heard = _Heard(found, pending, hear, keep)
        reply = self._answer(heard, pending) if pending else None
        return reply or self._take_if_sure(heard) or self._read_back(heard)

    def _meanings(
        self, text: str, scores: Mapping[str, float], speaker: str, pending: OpenQuestion | None
    ) -> tuple[MeaningHeard, ...]:
        groups: dict[object, list[MeaningHeard]] = {}
        for each, score in scores.items():
            understood = self._conversation.understand(each, speaker, heard=1.0)
            said = self._said(understood, pending)
            heard = MeaningHeard(each, score, understood, said)
            groups.setdefault(each if said is None else said, []).append(heard)

        def rank(each: MeaningHeard) -> tuple[float, bool, str]:
            return -each.certainty, each.text != text, each.text

        sums = {key: fsum(each.certainty for each in same) for key, same in groups.items()}
        found = [replace(min(groups[key], key=rank), certainty=min(1.0, sums[key])) for key in sums]
        return tuple(sorted(found, key=rank))

    def _said(
        self, understood: Understanding, pending: OpenQuestion | None
    ) -> meaning.Meaning | meaning.Answer | str | None:
        conversation, text = self._conversation, understood.text
        if pending and not _is_halt(understood.meaning):
            number = conversation.language.chosen(text, len(pending.choices))
            if pending.choices and number is not None:
                return meaning.Answer(number=number)
            discourse, speaker = conversation.discourse, understood.speaker
            answers = conversation.language.short_answers(
                text, speaker=speaker, discourse=discourse
            )
            if answers:
                return answers[0]
        if understood.kind != "error" and (understood.kind != "ask_back" or understood.reading):
            return understood.meaning
        return text if pending and (pending.tell or pending.word) else None

    def _answer(self, heard: _Heard, pending: OpenQuestion) -> Reply | None:
        first, *others = heard.found
        best = next(iter(heard.understood), first)
        if best.is_refusal and pending.no is None:
            return heard.taken(best)
        if pending is self._asked and len(self._choices) > 1 and not self._is_open(first, heard):
            for choice, take in zip(self._choices, pending.choices, strict=True):
                if choice.said == first.said:
                    return take()
        if not first.is_choice:
            return None
        is_clear = first.certainty >= CLEAR * fsum(each.certainty for each in others)
        if is_clear and not any(map(self._denies, others)):
            return heard.taken(first)
        return self._repeat(heard, self._conversation.last_said, pending)

    def _repeat(self, heard: _Heard, question: str, pending: OpenQuestion | None) -> Reply:
        self._conversation.open_question = pending
        turn = UnderstoodTurn(heard.first.understood, heard.first.certainty, heard.keep)
        return self._conversation.recorded(turn, question, "asked")

    def _take_if_sure(self, heard: _Heard) -> Reply | None:
        best = next(iter(heard.understood), None)
        if best is None or self._conversation.language.introduction(best.text):
            return None
        understood, understand = best.understood, self._conversation.understand
        if understood.kind in _HARMLESS and best.said == understood.meaning:
            again = understand(best.text, understood.speaker, heard=best.certainty)
            is_taken = again.meaning == understood.meaning
        else:
            is_taken = best.certainty >= SURE and not self._is_open(best, heard)
        return heard.taken(best) if is_taken else None

    def _is_open(self, each: MeaningHeard, heard: _Heard) -> bool:
        understood = each.understood
        is_change = isinstance(understood.meaning, _CHANGES) or understood.kind == "correction"
        is_denied = any(map(self._denies, heard.found))
        return is_change or is_denied or bool(each.new_words)

    def _denies(self, each: MeaningHeard) -> bool:
        is_denying = self._conversation.language.denies(each.text) or each.is_refusal
        is_negative = checks.is_negative(each.understood.meaning)
        return (is_denying or is_negative) and each.certainty >= NOTABLE

    def _read_back(self, heard: _Heard) -> Reply:
        first, found = heard.first, heard.understood
        if first.new_words and first.certainty >= SURE:
            return self._ask(heard, [first])
        known = [each for each in found if not each.new_words]
        new = [each for each in found if each.new_words]
        if first in new or first not in found:
            known += self._sounding(first, known)
        choices = [*known[: MAX_CHOICES - bool(new)], *new][:MAX_CHOICES]
        asks_for_word = first.understood.kind == "ask_back" and not _offers(first.understood)
        if choices or asks_for_word:
            return self._ask(heard, choices or [first])
        return heard.taken(first)

    def _sounding(self, first: MeaningHeard, known: Collection[MeaningHeard]) -> list[MeaningHeard]:
        conversation, meanings = self._conversation, {each.said for each in known}
        about = (name for rule in conversation.topic for name in (rule.object, rule.part))
        names = {*conversation.visible(), *filter(None, about)}
        found: list[MeaningHeard] = []
        for text in self._sounds_like(conversation.language, first.text, names):
            understood = conversation.understand(text, first.understood.speaker, heard=1.0)
            if understood.meaning not in meanings:
                found.append(MeaningHeard(text, 0.0, understood, understood.meaning))
        return found

    def _ask(self, heard: _Heard, choices: Sequence[MeaningHeard]) -> Reply:
        conversation, is_one, first = self._conversation, len(choices) == 1, heard.first
        said = [each.text.rstrip(" .?!") for each in choices]
        numbered = ". ".join(f"{number}. {each}" for number, each in enumerate(said, start=1))
        question = conversation.say(spoken("did_you_say", said=said[0] if is_one else numbered))
        words = ", ".join("-".join(word.replace(" ", "")) for word in choices[0].new_words)
        if is_one and words:
            question += f" {conversation.say(spoken('is_new_word', word=words))}"
        asked = meaning.AskBack(question, tuple(said))
        turn = UnderstoodTurn(
            replace(
                first.understood, meaning=asked, reading=None, discourse=conversation.discourse
            ),
            first.certainty,
            heard.keep,
        )
        pending = None if heard.pending is self._asked else heard.pending
        ask_again = partial(self._repeat, heard, conversation.last_said, pending)
        takes = tuple(partial(self._take, heard, each, pending, is_one) for each in choices)
        conversation.wait_for(
            turn,
            takes[0] if is_one else partial(self._ask, heard, choices),
            no=ask_again if pending else None,
            choices=takes,
        )
        self._asked, self._choices = conversation.open_question, choices
        conversation.last_said = question
        return conversation.recorded(turn, question, "asked")

    def _take(
        self, heard: _Heard, each: MeaningHeard, pending: OpenQuestion | None, is_all: bool
    ) -> Reply:
        if each.new_words and not is_all:
            return self._ask(heard, [each])
        self._conversation.open_question = pending
        return heard.hear(each.text, accepted=each.new_words)


def _is_halt(said: object) -> TypeGuard[meaning.Control]:
    return isinstance(said, meaning.Control) and said.is_halt


def _offers(understood: Understanding) -> bool:
    asked = understood.meaning
    return isinstance(asked, meaning.AskBack) and not all(isinstance(c, str) for c in asked.choices)
