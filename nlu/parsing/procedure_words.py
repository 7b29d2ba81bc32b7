"""The words of order, and the patterns of the heads and clauses of procedures.

In a pattern a word in capitals is a slot: HEAD for an action, HEADING for its gerund, THING for an
object, STATE and FAILURE for clauses, WORD for any one word.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from ...ontology.yaml_reader import read_yaml
from ..grammar.word_patterns import Steps, read_pattern
from ..lexicon.tokenizer import BREAK, Tokens

Slots = Mapping[str, tuple[int, int]]
"""The places of the words in each slot."""

_LENGTHS = {"HEAD": 9, "HEADING": 9, "THING": 5, "WORD": 1, "STATE": 9, "FAILURE": 9}
_TEXTS = ("links", "particles")
_PATTERNS = ("order", "behind", "heads", "asked", "tails", "again", "times", "another")
_CLAUSES = ("only_if", "unless", "if")
_ABOUT = ("how", "forget")
_GROUPS = ("states", "failures")


@dataclass(frozen=True)
class ProcedureWords:
    """The words of order and the patterns of a language.

    Attributes:
        patterns: by key.
        groups: the patterns of states and of failures, each by what it stands for.
        links: the words between the objects of an action.
        particles: the words that belong to a verb.
    """

    patterns: Mapping[str, tuple[Steps, ...]]
    groups: Mapping[str, Mapping[str, Steps]]
    links: frozenset[str]
    particles: frozenset[str]

    def matches(self, key: str, tokens: Tokens, start: int = 0) -> Iterator[tuple[int, Slots]]:
        """Yield where a pattern of a key may end that begins at a place, with its slots."""
        for steps in self.patterns[key]:
            yield from _ends(steps, tokens.words, start, {})

    def ends(self, key: str, tokens: Tokens, start: int = 0) -> list[int]:
        """Return where a pattern of a key may end that begins at a place."""
        return [end for end, _ in self.matches(key, tokens, start)]

    def whole(self, group: str, tokens: Tokens) -> Iterator[tuple[str, Slots]]:
        """Yield what the patterns of a group stand for that fit all words, with their slots."""
        for name, steps in self.groups[group].items():
            for end, slots in _ends(steps, tokens.words, 0, {}):
                if end == len(tokens.items):
                    yield name, slots

    def skip(self, tokens: Tokens, start: int) -> int:
        """Return the place after the breaks and the words of order at a place."""
        while start < len(tokens.items):
            ends = self.ends("order", tokens, start)
            if not ends and tokens.words[start] != BREAK:
                break
            start = max([*ends, start + 1])
        return start

    def starts(self, tokens: Tokens) -> list[int]:
        """Return the places where a clause may begin, and the one past the last, in order."""
        count = len(tokens.items)
        opening = ("order", *_CLAUSES)
        orders = {p for p in range(1, count) if any(self.ends(key, tokens, p) for key in opening)}
        breaks = {place for place in range(1, count) if tokens.words[place] == BREAK}
        return sorted({*tokens.pauses, *breaks, *orders, count} - {0})


def _ends(
    steps: Steps, words: Sequence[str], start: int, slots: Slots
) -> Iterator[tuple[int, Slots]]:
    for step in steps:
        if isinstance(step, int):
            yield start, slots
        elif step[0] in _LENGTHS:
            for end in range(start + 1, min(len(words), start + _LENGTHS[step[0]]) + 1):
                if BREAK not in words[start:end]:
                    yield from _ends(step[1], words, end, {**slots, step[0]: (start, end)})
        elif start < len(words) and words[start] == step[0]:
            yield from _ends(step[1], words, start + 1, slots)


@lru_cache
def load_procedure_words(path: Path) -> ProcedureWords:
    """Read the words of procedures; `DataError` says where the file is not as expected."""
    parts = read_yaml(path).entries(required=(*_TEXTS, *_PATTERNS, *_CLAUSES, *_ABOUT, *_GROUPS))
    patterns = {
        key: tuple(map(read_pattern, parts[key].listed()))
        for key in (*_PATTERNS, *_CLAUSES, *_ABOUT)
    }
    groups = {
        key: {name: read_pattern(each) for name, each in parts[key].entries().items()}
        for key in _GROUPS
    }
    links, particles = (frozenset(parts[key].texts()) for key in _TEXTS)
    return ProcedureWords(patterns, groups, links, particles)
