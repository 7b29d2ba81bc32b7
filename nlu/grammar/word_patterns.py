"""Patterns of words: `when (you|we) [want to]` stands for four spellings.

A choice stands in round brackets, what may be left out in square ones, as in the paper's Table 3
and the JSpeech Grammar Format. A pattern becomes a graph that is walked word by word (an automaton
without silent moves, after Glushkov 1961): it is as long as the text, however many it stands for.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache, lru_cache
from itertools import chain, islice
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

from ...ontology.yaml_reader import YamlNode, read_yaml

ANY = "*"
_BREAK = ";"  # the token between sentences
_NEVERANY = frozenset({_BREAK, "not", "never", "no"})
SLOTS = {
    **dict.fromkeys(("THING", "OBJECT"), 5),
    **dict.fromkeys(("HEAD", "HEADING", "STATE", "FAILURE"), 9),
    "NAME": 7,
    "WORD": 1,
}
"""The slots of patterns, each with the most words that it may have."""

MAX_SPELLINGS = 4000

Steps: TypeAlias = "tuple[tuple[str, Steps] | int, ...]"
"""Where one may go from a place: a word and what may follow it, or the number of the end."""

Slots: TypeAlias = Mapping[str, tuple[int, int]]
"""The places of the words in each slot of a pattern."""

_TOO_MANY = f"stands for more than {MAX_SPELLINGS} spellings."
_NOTHING_LEFT = "expected at least one word that cannot be left out."
_PIECE = re.compile(r"[()\[\]|]|[^\s()\[\]|]+")
_INNER_SPACE = re.compile(r"(?<=[(\[|]) | (?=[)\]|])")
_BRACKET = re.compile(r"[()\[\]|]")
_WORD = re.compile(r"[^\s()\[\]|]+")
_CLOSING = {"(": ")", "[": "]"}
_OPENING = {")": "(", "]": "["}


class PatternError(ValueError):
    """A pattern is not as it should be; the message is one sentence."""


def words_of(text: str) -> list[str]:
    """All words that a pattern has, in any spelling."""
    return _WORD.findall(text)


def compile_pattern(text: str, end: int = 0) -> Steps:
    """The graph of a pattern, with `end` after each spelling; `PatternError` without a bracket."""
    return _graph(_PIECE.findall(text), text, end)


def _graph(pieces: Sequence[str], text: str, end: int) -> Steps:
    # From right to left, so that what follows a word is known when the word is met.
    here: Steps = (end,)
    within: list[tuple[str, Steps, list[Steps]]] = [("", here, [])]
    for piece in reversed(pieces):
        if piece in _OPENING:
            within.append((piece, here, []))
        elif piece == "|":
            within[-1][2].append(here)
            here = within[-1][1]
        elif piece in _CLOSING:
            closing, after, choices = within.pop()
            if closing != _CLOSING[piece]:
                raise _missing(_CLOSING[piece], text)
            here = _either([*choices, here]) + (after if piece == "[" else ())
        else:
            here = ((piece, here),)
    closing, _, choices = within.pop()
    if closing:
        raise _missing(_OPENING[closing], text)
    return _either([*choices, here])


def _either(choices: Sequence[Steps]) -> Steps:
    return tuple(chain.from_iterable(reversed(choices)))


def expand(steps: Steps) -> Iterator[tuple[str, ...]]:
    """All spellings of a graph, in the order of the choices; some of them may be the same."""
    for step in steps:
        if isinstance(step, int):
            yield ()
        else:
            for rest in expand(step[1]):
                yield step[0], *rest


def match_pattern(
    steps: Steps, words: Sequence[str], start: int, slots: Slots = MappingProxyType({})
) -> Iterator[tuple[int, Slots]]:
    """Where a pattern may end that begins at a place, with the places of its slots.

    `*` in a pattern is any one word, but none that denies.
    """
    for step in steps:
        if isinstance(step, int):
            yield start, slots
        elif step[0] in SLOTS:
            for end in range(start + 1, min(len(words), start + SLOTS[step[0]]) + 1):
                if words[end - 1] == _BREAK:
                    break
                yield from match_pattern(step[1], words, end, {**slots, step[0]: (start, end)})
        elif start < len(words):
            word = words[start]
            if step[0] == word or (step[0] == ANY and word not in _NEVERANY):
                yield from match_pattern(step[1], words, start + 1, slots)


def spellings(field: YamlNode) -> list[tuple[str, ...]]:
    """All that a pattern stands for, each as its words; `DataError` for over `MAX_SPELLINGS`."""
    found = list(islice(expand(compile_pattern(read_words(field))), MAX_SPELLINGS + 1))
    if len(found) > MAX_SPELLINGS:
        raise field.fail(_TOO_MANY)
    return list(dict.fromkeys(found))


def read_patterns(field: YamlNode) -> Steps:
    """The graph of a list of patterns; raises as `read_words`."""
    return tuple(chain.from_iterable(compile_pattern(read_words(i)) for i in field.listed()))


def read_phrases(field: YamlNode) -> frozenset[tuple[str, ...]]:
    """The spellings of a list of patterns; raises as `spellings`."""
    return frozenset(words for item in field.items() for words in spellings(item))


def read_words(field: YamlNode) -> str:
    """The text of a pattern without gaps; `DataError` if all of it may be left out, or is cut."""
    text = field.text()
    # Most are some words and nothing else.
    if _BRACKET.search(text):
        try:
            steps = compile_pattern(text)
        except PatternError as error:
            raise field.fail(str(error)) from error
        if 0 in steps:
            raise field.fail(_NOTHING_LEFT)
    return text


def is_gap(piece: str) -> bool:
    """Whether a piece of a pattern is a gap, like `{x:NP}`."""
    return piece.startswith("{")


def variants(field: YamlNode) -> list[tuple[str, ...]]:
    """All that a pattern with gaps stands for, as gaps and the patterns of words between them.

    Only choices that have a gap within are multiplied out: words stay together in one pattern.
    `DataError` where a bracket is missing, or for more than `MAX_SPELLINGS`.
    """
    text = field.text()
    try:
        choices = list(islice(expand(_graph(_whole_words(text), text, 0)), MAX_SPELLINGS + 1))
    except PatternError as error:
        raise field.fail(str(error)) from error
    if len(choices) > MAX_SPELLINGS:
        raise field.fail(_TOO_MANY)
    found = dict.fromkeys(chain.from_iterable(map(_joined, choices)))
    if () in found:
        raise field.fail(_NOTHING_LEFT)
    return list(found)


def _whole_words(text: str) -> list[str]:
    pieces: list[str] = []
    opened: list[int] = []
    for piece in _PIECE.findall(text):
        pieces.append(piece)
        if piece in _CLOSING:
            opened.append(len(pieces) - 1)
        elif opened and _OPENING.get(piece) == pieces[opened[-1]]:
            start = opened.pop()
            if not any(map(is_gap, pieces[start:])):
                pieces[start:] = [_INNER_SPACE.sub("", " ".join(pieces[start:]))]
    return pieces


def _joined(pieces: Sequence[str]) -> Iterator[tuple[str, ...]]:
    place = next((n for n, piece in enumerate(pieces) if not is_gap(piece)), len(pieces))
    end = next((n for n in range(place, len(pieces)) if is_gap(pieces[n])), len(pieces))
    if place == end:
        yield tuple(pieces)
        return
    words = " ".join(pieces[place:end])
    is_optional = all(piece[0] in _CLOSING for piece in pieces[place:end])
    for rest in _joined(pieces[end:]):
        yield *pieces[:place], words, *rest
        if is_optional and 0 in compile_pattern(words):
            yield *pieces[:place], *rest


def _missing(bracket: str, text: str) -> PatternError:
    return PatternError(f'expected "{bracket}" once more in "{text}".')


Phrase = tuple[str, ...]
_Step: TypeAlias = tuple[str, Steps]


class WordLists:
    """What one file lists, each key read when it is first asked for.

    A list has patterns, or phrases, which are spelled out; a mapping has what patterns stand for,
    with the patterns. `DataError` where a key is missing or its value is not as expected.
    """

    def __init__(self, file: YamlNode) -> None:
        self.file = file
        self.phrases = cache(self._phrases)  #: returns the single words and phrases of a key
        self._by_first_word = cache(self._steps_by_first_word)

    def of_group(self, key: str, words: Phrase, start: int = 0) -> Iterator[tuple[str, int, Slots]]:
        """Yield what the patterns of a key stand for that begin at a place, with end and slots."""
        known = self._by_first_word(key)
        for name, step in known.get(words[start] if start < len(words) else "", known[""]):
            for end, slots in match_pattern((step,), words, start):
                yield name, end, slots

    def wholes(self, key: str, words: Phrase, start: int = 0) -> Iterator[tuple[str, Slots]]:
        """Yield what the patterns of a key stand for that are all words from a place on."""
        found = self.of_group(key, words, start)
        return ((name, slots) for name, end, slots in found if end == len(words))

    def end(self, key: str, words: Phrase, start: int = 0) -> int:
        """The end of the longest pattern of a key that begins at a place; the place without one."""
        return max((end for _, end, _ in self.of_group(key, words, start)), default=start)

    def is_all(self, key: str, words: Phrase, start: int = 0) -> bool:
        """Whether a pattern of a key is all of some words from a place on."""
        return any(True for _ in self.wholes(key, words, start))

    def names(self, key: str) -> Sequence[str]:
        """What the patterns of a key stand for, in the order of the file."""
        return tuple(self._field(key).entries())

    def has(self, key: str, *words: str) -> bool:
        """Whether some words are a phrase of a key."""
        return words in self.phrases(key)

    def words(self, key: str) -> frozenset[str]:
        """The words of all phrases of a key."""
        return frozenset(chain.from_iterable(self.phrases(key)))

    def _field(self, key: str) -> YamlNode:
        return self.file.entries(required=(key,))[key]

    def _phrases(self, key: str) -> frozenset[Phrase]:
        return read_phrases(self._field(key))

    def _steps_by_first_word(self, key: str) -> Mapping[str, Sequence[tuple[str, _Step]]]:
        field = self._field(key)
        groups = field.entries() if isinstance(field.value, dict) else {"": field}
        steps = [
            (name, step)
            for name, patterns in groups.items()
            for step in read_patterns(patterns)
            if isinstance(step, tuple)
        ]
        return {
            word: [each for each in steps if each[1][0] in {word, ANY, *SLOTS}]
            for word in {"", *(step[0] for _, step in steps)}
        }


def places_of(phrase: Phrase, words: Sequence[str]) -> Iterator[int]:
    """Yield where a phrase begins in some words."""
    length = len(phrase)
    return (n for n in range(len(words) - length + 1) if tuple(words[n : n + length]) == phrase)


@lru_cache(maxsize=16)
def load_word_lists(path: Path) -> WordLists:
    """Return what a file lists; `DataError` where it is no YAML."""
    return WordLists(read_yaml(path))
