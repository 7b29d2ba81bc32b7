"""Tokenizer: a text as lower-case words, with contractions and possessives split.

Quotation marks, a smile and the number of a list are dropped; commas, colons, dashes and a pair of
round brackets become pauses. A full stop, question mark or semicolon within a text becomes the
token `;` between two sentences. All else that is no word is a token that no lexicon has.
"""

import re
import unicodedata
from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

MAX_CHARACTERS = 2000
MAX_TOKENS = 40

BREAK = ";"

_APOSTROPHES = str.maketrans(dict.fromkeys("‘’‚‛ʼ`´′＇", "'"))
_PAUSES = frozenset(",:–—")
_LAYOUT = re.compile(
    r"^\s*(?P<number>\(?\d{1,2}[.)](?=\s+\S)|[-*•](?=\s))"
    r"|(?<!\S)(?P<smile>:-?\))(?!\S)"
    r"|(?<=\s)(?P<dash>-+)(?=\s)"
    r"|\((?P<aside>[^()]*)\)"
)
_TOKEN = re.compile(
    r"(?P<word>[^\W\d_]+(?:'[^\W\d_]+)*)"
    r"|(?P<silent>[,:\"“”„«»'\-–—‐‑]+)"
    r"|(?P<stop>[.;!?…]+)"
    r"|(?P<other>[^\s,:\"“”„«».;!?…'\-–—‐‑]+?(?=[\s,.;!?]|$)|\S)"
)


@dataclass(frozen=True, slots=True)
class Token:
    """A word in lower case, its characters `[start, end)` in the text, and if it has a capital."""

    word: str
    start: int
    end: int
    capital: bool = False


@dataclass(frozen=True)
class Tokens:
    """The tokens of one utterance."""

    text: str  #: the utterance as it was written
    items: tuple[Token, ...]
    asks: bool  #: whether the text ends with a question mark
    pauses: tuple[int, ...] = ()  #: indices of the tokens that follow a comma or dash
    #: the phrases that were taken out because they add nothing
    removed: tuple[tuple[str, ...], ...] = ()

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The words of the tokens."""
        return tuple(token.word for token in self.items)

    @cached_property
    def beginnings(self) -> tuple[int, ...]:
        """The places where a piece may begin: the first, after a pause, after a break."""
        breaks = (place for place, word in enumerate(self.words, start=1) if word == BREAK)
        return tuple(sorted({0, *self.pauses, *breaks} - {len(self.items)}))

    @property
    def parts(self) -> list[tuple[int, int]]:
        """The spans from one pause or break to the next that have words."""
        spans = pairwise((*self.beginnings, len(self.items)))
        return [span for span in spans if set(self.words[slice(*span)]) - {BREAK}]

    @property
    def sentences(self) -> list[tuple[int, int]]:
        """The spans from one break to the next, each with the break that ends it."""
        breaks = (place for place, word in enumerate(self.words, start=1) if word == BREAK)
        return list(pairwise((0, *sorted({*breaks, len(self.items)}))))

    @cached_property
    def edges(self) -> frozenset[int]:
        """The places where a piece may begin or end, which are also those of breaks."""
        breaks = (place for place, word in enumerate(self.words) if word == BREAK)
        return frozenset({*self.beginnings, *breaks, len(self.items)})

    @cached_property
    def proper(self) -> frozenset[str]:
        """The capitalised words that begin no sentence; none if the whole text is in capitals."""
        if self.text.isupper():
            return frozenset()
        pairs = zip((BREAK, *self.words), self.items, strict=False)
        return frozenset(each.word for last, each in pairs if each.capital and last != BREAK)

    @cached_property
    def is_transcript(self) -> bool:
        """Whether the text has neither capitals nor pauses, as a speech recogniser writes it."""
        return self.text.islower() and all(c.isalnum() or c in " '’" for c in self.text)

    def span(self, start: int, end: int) -> str:
        """The text of the tokens `[start, end)` as it was written."""
        if start >= end:
            return ""
        return self.text[self.items[start].start : self.items[end - 1].end]

    def without_breaks(self) -> "Tokens":
        """These tokens with pauses instead of the breaks between sentences."""
        breaks = {place for place, word in enumerate(self.words) if word == BREAK}
        paused = replace(self, pauses=tuple(breaks.union(self.pauses)))
        return paused.only(sorted({*range(len(self.items))} - breaks))

    def only(self, kept: Sequence[int]) -> "Tokens":
        """The tokens at some places in order; a pause moves to the next that is kept."""
        pauses = {bisect_left(kept, pause) for pause in self.pauses} - {0, len(kept)}
        items = tuple(self.items[place] for place in kept)
        return replace(self, items=items, pauses=tuple(sorted(pauses)))

    def part(self, start: int, end: int) -> "Tokens":
        """The tokens `[start, end)` as an utterance of their own, without breaks at its end."""
        asks = self.asks and end == len(self.items)
        while end > start and self.items[end - 1].word == BREAK:
            end -= 1
            asks = "?" in self.span(end, end + 1)
        pauses = tuple(pause - start for pause in self.pauses if start < pause < end)
        return replace(self, items=self.items[start:end], asks=asks, pauses=pauses)


def tokenize(text: str, contractions: Mapping[str, tuple[str, ...]]) -> Tokens:
    """Split the first `MAX_CHARACTERS` of a text into tokens, and contractions into their words."""
    text = unicodedata.normalize("NFC", text[:MAX_CHARACTERS]).translate(_APOSTROPHES)
    items: list[Token] = []
    pauses: list[int] = []
    last = ""
    for found in _TOKEN.finditer(_LAYOUT.sub(_without_layout, text)):
        if found["silent"]:
            if not _PAUSES.isdisjoint(found["silent"]):
                pauses.append(len(items))
        elif found["stop"]:
            last = found["stop"]
            if items and items[-1].word != BREAK:
                items.append(Token(BREAK, found.start(), found.end()))
        else:
            last = ""
            pair = f"{items[-1].word} {found.group().lower()}" if items else ""
            if pair in contractions:  # "its" in "its for cutting"
                first = items.pop()
                items += [replace(first, word=word) for word in contractions[pair]]
            items += _words(found, contractions)
    while items and items[-1].word == BREAK:
        items.pop()
    within = tuple(pause for pause in pauses if pause <= len(items))
    return Tokens(text, tuple(items), "?" in last, within)


def _without_layout(found: re.Match[str]) -> str:
    if found["aside"] is not None:
        return f",{found['aside']},"
    return ("," if found["dash"] else " ") * len(found.group())


def _words(found: re.Match[str], contractions: Mapping[str, tuple[str, ...]]) -> Iterator[Token]:
    start, end, said = found.start(), found.end(), found.group()
    word, capital = said.lower(), said[:1].isupper()
    head, mark, tail = word.rpartition("'")
    short = mark + tail
    if word in contractions or not (head and (short == "'s" or short in contractions)):
        for part in contractions.get(word, (word,)):
            yield Token(part, start, end, capital)
        return
    middle = end - len(short)
    yield Token(head, start, middle, capital)
    for part in contractions.get(short, (short,)):
        yield Token(part, middle, end)
