"""Answers to a question with numbered choices: "2", "the first one", "neither of them"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from ...ontology.yaml_reader import read_yaml
from ..grammar.word_patterns import read_phrases, spellings

Phrase = tuple[str, ...]


@dataclass(frozen=True)
class ChoiceWords:
    """The words that choose.

    Attributes:
        numbers: the words for the first choice, the second, and so on.
        last: words for the last choice.
        around: words beside a number that add nothing.
        none: answers that choose nothing.
    """

    numbers: Sequence[frozenset[Phrase]]
    last: frozenset[Phrase]
    around: frozenset[Phrase]
    none: frozenset[Phrase]

    def chosen(self, words: Sequence[str], count: int) -> int | None:
        """Return which of `count` choices words take, from 1 on: 0 for none, None for no answer."""
        if tuple(words) in self.none:
            return 0
        # "The first one", but also "one": it is a number only where there is no other.
        naming = [word for word in words if (word,) not in self.around] or list(words[-1:])
        if len(naming) != 1:
            return None
        named = (naming[0],)
        if count > 1 and named in self.last:
            return count
        numbers = (number for number, said in enumerate(self.numbers, start=1) if named in said)
        return next((number for number in numbers if number <= count), None)


@lru_cache(maxsize=4)
def load_choice_words(path: Path) -> ChoiceWords:
    """Return the words that choose; `DataError` says where the file is not as expected."""
    parts = read_yaml(path).entries(required=("checks", "choices"), optional=())["choices"]
    kinds = parts.entries(required=("numbers", "last", "around", "none"), optional=())
    return ChoiceWords(
        tuple(frozenset(spellings(item)) for item in kinds["numbers"].items()),
        *(read_phrases(kinds[kind]) for kind in ("last", "around", "none")),
    )
