"""Courtesies: what in an utterance that is not understood only greets, thanks or praises.

"Good morning, I'm your first pupil" is a greeting although nobody taught the word *pupil*. A part
between pauses is a courtesy or chatter only where it names nothing that a rule or a command is
about, denies nothing and asks nothing. Nothing follows from it but a polite answer.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from pathlib import Path

from ...ontology.yaml_reader import read_yaml
from ..grammar.word_patterns import Steps, match_pattern, read_patterns, read_phrases
from ..lexicon.tokenizer import Tokens
from ..lexicon.unknown_words import KnownWords
from ..semantics.discourse import Discourse
from ..semantics.interpretation import GOALS
from .mentions import find_mentions
from .utterance_segments import parts

Phrase = tuple[str, ...]

_JUDGING = frozenset({"praise", "blame"})
_VALUED = _JUDGING | {"thanks"}
_LONGEST_ADDRESS = 3  # words of "my little helper"
_LONGEST_COMPLEMENT = 6  # words of "for all your help this morning"
_FORMAL = frozenset({"greeting", "thanks", "farewell"})
_PEOPLE = ("RN", "HN")
_PATTERNS = ("chatter", "openers", "introducing")
_LISTS = ("before", "denying", "stating", "verbs", "pronouns")

_REPLIES = {"thanks": "welcome", "praise": "praised", "apology": "no_problem", "blame": "regrets"}
"""The answers to acknowledgements that are not called like them."""


def answer_to(acknowledgement: str) -> str:
    """Return the key of the answer to an acknowledgement of this kind."""
    return _REPLIES.get(acknowledgement, acknowledgement)


@dataclass(frozen=True)
class Courtesy:
    """What is said by the way in an utterance, and what else it says.

    Attributes:
        kind: `farewell`, `greeting`, `thanks`, `apology`, `blame` or `praise`; empty for chatter.
        rest: the text of all else, from the first to the last part of it; empty when there is none.
        is_formal: whether only greetings, thanks and goodbyes are said by the way.
        name: how its speaker introduces himself or herself, empty when nobody does.
    """

    kind: str
    rest: str
    is_formal: bool
    name: str = ""


@dataclass(frozen=True)
class CourtesyPhrases:
    """The phrases by which courtesies are found.

    Attributes:
        kinds: the phrases of each kind, in the order in which they count.
        chatter: the beginnings of parts that are only said by the way.
        openers: what praise or blame begins with: "you are clever", but not "the sky is lovely".
        introducing: what precedes the name of the speaker: "my name is".
        lists: single words by key: those that may precede any phrase ("oh, good morning"), that
            deny or set a condition, that state something, other verbs, and pronouns for things.
    """

    kinds: Mapping[str, tuple[Steps, ...]]
    chatter: tuple[Steps, ...]
    openers: tuple[Steps, ...]
    introducing: tuple[Steps, ...]
    lists: Mapping[str, frozenset[str]]

    def find(self, tokens: Tokens, known: KnownWords) -> Courtesy | None:
        """Return the courtesy in an utterance; None where there is none."""
        found: set[str] = set()
        kept: list[tuple[int, int]] = []
        name, introduced = "", (0, 0)
        for start, end in parts(tokens):
            part = tokens.part(start, end)
            has_content = part.asks or self.has_content(part, known)
            kind = None if has_content else self._kind(part, known)
            if not has_content and not name and (name := self._introduced(part, known)):
                kind, introduced = "greeting", (start, end)
            elif not has_content and start == introduced[1] > 0:  # "I'm Kim, your new neighbour"
                kind, introduced = "greeting", (introduced[0], end)
            if kind is None:
                kept.append((start, end))
            else:
                found.add(kind)
        if not found:
            return None
        kind = next((each for each in self.kinds if each in found), "")
        rest = _text(tokens, kept[0][0], kept[-1][1]) if kept else ""
        is_within = kept and kept[0][0] < introduced[0] < kept[-1][0]
        return Courtesy(kind, rest, found <= _FORMAL, "" if is_within else name)

    def introduction(self, tokens: Tokens, known: KnownWords) -> Courtesy | None:
        """Return the courtesy in which a speaker introduces himself or herself, None without."""
        if not any(token.capital for token in tokens.items[2:]):
            return None
        if not any(self._introduced(tokens.part(*span), known) for span in parts(tokens)):
            return None
        found = self.find(tokens, known)
        return found if found and found.name else None

    def _introduced(self, part: Tokens, known: KnownWords) -> str:
        """The name by which its speaker is introduced in a part, empty when there is none."""
        words = part.words
        for start in range(min(len(words), _LONGEST_ADDRESS)):
            ends = [e for steps in self.introducing for _, e in match_pattern(steps, words, start)]
            token = part.items[max(ends)] if ends and max(ends) < len(words) else None
            if token is None or not token.capital or not self._ends_with(words, max(ends) + 1):
                continue
            if known.lexicon.is_name(token.word, _PEOPLE) or not known.has(token.word):
                return token.word
        return ""

    def _ends_with(self, words: Phrase, start: int) -> bool:
        """Whether what follows a place is no clause."""
        verbs = self.lists["stating"] | self.lists["verbs"]
        return len(words) - start <= _LONGEST_COMPLEMENT and verbs.isdisjoint(words[start:])

    def _kind(self, part: Tokens, known: KnownWords) -> str | None:
        """The kind of a part: empty for chatter, None where it is neither."""
        words = part.words
        is_denied = not self.lists["denying"].isdisjoint(words)
        is_of_hilt = _occurs(self.openers, words, 0)
        for kind, phrases in self.kinds.items():
            is_bare = kind in _JUDGING and not is_of_hilt
            if is_bare and not self.lists["stating"].isdisjoint(words):
                continue
            places = range(1 if is_bare else len(words))
            if any(self._is_all(phrases, words, at, kind) for at in places):
                return None if is_denied and kind in _VALUED else kind
        unknown = known.unknown(part)
        is_address = len(words) <= _LONGEST_ADDRESS and unknown
        is_denied |= any(token.word.endswith("ing") for token in unknown)  # it may be a new use
        is_chatter = not is_denied and (is_address or _occurs(self.chatter, words, 0))
        return "" if is_chatter else None

    def _is_all(self, phrases: Sequence[Steps], words: Phrase, start: int, kind: str) -> bool:
        """Whether a part begins with a phrase at a place, and what follows is no clause."""
        ends = [end for steps in phrases for _, end in match_pattern(steps, words, start)]
        if not ends:
            return False
        led = self.openers if kind in _JUDGING else ()
        is_led = self.lists["before"].issuperset(words[:start]) or _occurs(led, words, 0)
        return is_led and self._ends_with(words, max(ends))

    def has_content(self, part: Tokens, known: KnownWords) -> bool:
        """Whether a part names something that a rule or a command is about."""
        found = find_mentions(part, known, {}, Discourse())
        is_act = any(each.role == "act" and each.name in GOALS for each in found.names)
        return bool(found.required) or (
            is_act and not self.lists["pronouns"].isdisjoint(part.words)
        )


def _occurs(phrases: Sequence[Steps], words: Sequence[str], start: int) -> bool:
    return any(True for steps in phrases for _ in match_pattern(steps, words, start))


def _text(tokens: Tokens, start: int, end: int) -> str:
    """The text from one token to before another, with the mark that ends it."""
    following = tokens.items[end].start if end < len(tokens.items) else len(tokens.text)
    return tokens.text[tokens.items[start].start : following].strip(" ,:-–—")


@lru_cache(maxsize=4)
def load_courtesies(path: Path) -> CourtesyPhrases:
    """Return the courtesies of a language; `DataError` says where the file is not as expected."""
    parts = read_yaml(path).entries(required=("courtesies", *_PATTERNS, *_LISTS), optional=())
    lists = {key: frozenset(chain(*read_phrases(parts[key]))) for key in _LISTS}
    kinds = {kind: read_patterns(each) for kind, each in parts["courtesies"].entries().items()}
    chatter, openers, introducing = (read_patterns(parts[key]) for key in _PATTERNS)
    return CourtesyPhrases(kinds, chatter, openers, introducing, lists)
