"""Word lists: the patterns and phrases of one file of a language, by key.

In a pattern a word in capitals is a slot, as `SLOTS` of the patterns tell: THING for an object.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from pathlib import Path

from ...ontology.yaml_reader import read_yaml
from .word_patterns import Slots, Steps, match_pattern, read_patterns, read_phrases

Phrase = tuple[str, ...]


@dataclass(frozen=True)
class WordLists:
    """What one file lists.

    Attributes:
        patterns: patterns by key.
        groups: patterns by key, and by what they stand for.
        phrases: single words and phrases by key.
    """

    patterns: Mapping[str, tuple[Steps, ...]]
    groups: Mapping[str, Mapping[str, tuple[Steps, ...]]]
    phrases: Mapping[str, frozenset[Phrase]]

    def matches(
        self, key: str, words: Sequence[str], start: int = 0
    ) -> Iterator[tuple[int, Slots]]:
        """Yield where a pattern of a key may end that begins at a place, with its slots."""
        return (each for steps in self.patterns[key] for each in match_pattern(steps, words, start))

    def end(self, key: str, words: Sequence[str], start: int = 0) -> int:
        """The end of the longest pattern of a key that begins at a place; the place without one."""
        return max((end for end, _ in self.matches(key, words, start)), default=start)

    def is_all(self, key: str, words: Sequence[str], start: int = 0) -> bool:
        """Whether a pattern of a key is all of some words from a place on."""
        return any(end == len(words) for end, _ in self.matches(key, words, start))

    def of_group(
        self, group: str, words: Sequence[str], start: int = 0
    ) -> Iterator[tuple[str, int, Slots]]:
        """Yield what the patterns of a group stand for that begin at a place, as `matches`."""
        for name, patterns in self.groups[group].items():
            for steps in patterns:
                for end, slots in match_pattern(steps, words, start):
                    yield name, end, slots

    def has(self, key: str, *words: str) -> bool:
        """Whether some words are a phrase of a key."""
        return words in self.phrases[key]

    def words(self, key: str) -> frozenset[str]:
        """The words of all phrases of a key."""
        return frozenset(chain.from_iterable(self.phrases[key]))


@lru_cache(maxsize=16)
def load_word_lists(
    path: Path,
    *,
    patterns: tuple[str, ...] = (),
    groups: tuple[str, ...] = (),
    phrases: tuple[str, ...] = (),
) -> WordLists:
    """Return what a file lists under these keys; `DataError` says where it has others or errs."""
    parts = read_yaml(path).entries(required=(*patterns, *groups, *phrases), optional=())
    return WordLists(
        {key: read_patterns(parts[key]) for key in patterns},
        {
            key: {name: read_patterns(each) for name, each in parts[key].entries().items()}
            for key in groups
        },
        {key: read_phrases(parts[key]) for key in phrases},
    )
