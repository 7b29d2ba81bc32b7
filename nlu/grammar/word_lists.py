"""Word lists: the patterns and phrases of one file of a language, by key.

In a pattern a word in capitals is a slot, as `SLOTS` of the patterns tell: THING for an object.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import chain
from pathlib import Path

from ...ontology.yaml_reader import read_yaml
from .word_patterns import ANY, SLOTS, Slots, Steps, match_pattern, read_patterns, read_phrases

Phrase = tuple[str, ...]


@dataclass(frozen=True)
class WordLists:
    """What one file lists.

    Attributes:
        patterns: by key what each pattern stands for, if anything, and its graph.
        phrases: single words and phrases by key.
    """

    patterns: Mapping[str, Sequence[tuple[str, Steps]]]
    phrases: Mapping[str, frozenset[Phrase]]

    def of_group(
        self, key: str, words: Sequence[str], start: int = 0
    ) -> Iterator[tuple[str, int, Slots]]:
        """Yield what the patterns of a key stand for that begin at a place, with end and slots."""
        known = self._by_first_word[key]
        first = words[start] if start < len(words) else ""
        for name, step in known.get(first, known[""]):
            for end, slots in match_pattern((step,), words, start):
                yield name, end, slots

    def matches(
        self, key: str, words: Sequence[str], start: int = 0
    ) -> Iterator[tuple[int, Slots]]:
        """Yield where a pattern of a key may end that begins at a place, with its slots."""
        return ((end, slots) for _, end, slots in self.of_group(key, words, start))

    def wholes(self, key: str, words: Sequence[str], start: int = 0) -> Iterator[tuple[str, Slots]]:
        """Yield what the patterns of a key stand for that are all words from a place on."""
        found = self.of_group(key, words, start)
        return ((name, slots) for name, end, slots in found if end == len(words))

    def end(self, key: str, words: Sequence[str], start: int = 0) -> int:
        """The end of the longest pattern of a key that begins at a place; the place without one."""
        return max((end for end, _ in self.matches(key, words, start)), default=start)

    def is_all(self, key: str, words: Sequence[str], start: int = 0) -> bool:
        """Whether a pattern of a key is all of some words from a place on."""
        return any(True for _ in self.wholes(key, words, start))

    def names(self, key: str) -> Sequence[str]:
        """What the patterns of a key stand for, in the order of the file."""
        return tuple(dict.fromkeys(name for name, _ in self.patterns[key]))

    def has(self, key: str, *words: str) -> bool:
        """Whether some words are a phrase of a key."""
        return words in self.phrases[key]

    def words(self, key: str) -> frozenset[str]:
        """The words of all phrases of a key."""
        return frozenset(chain.from_iterable(self.phrases[key]))

    @cached_property
    def _by_first_word(self) -> Mapping[str, Mapping[str, Sequence[tuple[str, tuple[str, Steps]]]]]:
        found: dict[str, dict[str, list[tuple[str, tuple[str, Steps]]]]] = {}
        for key, patterns in self.patterns.items():
            steps = [
                (n, step) for n, graph in patterns for step in graph if isinstance(step, tuple)
            ]
            found[key] = {
                word: [each for each in steps if each[1][0] in {word, ANY, *SLOTS}]
                for word in {"", *(step[0] for _, step in steps)}
            }
        return found


def places_of(phrase: Phrase, words: Sequence[str]) -> Iterator[int]:
    """Yield where a phrase begins in some words."""
    length = len(phrase)
    return (n for n in range(len(words) - length + 1) if tuple(words[n : n + length]) == phrase)


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
    named = {key: parts[key].entries() for key in groups} | {k: {"": parts[k]} for k in patterns}
    return WordLists(
        {
            key: [(name, graph) for name, field in of.items() for graph in read_patterns(field)]
            for key, of in named.items()
        },
        {key: read_phrases(parts[key]) for key in phrases},
    )
