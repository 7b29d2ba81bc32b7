"""How words sound: their phones, by the CMU Pronouncing Dictionary that comes with PocketSphinx."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.util import find_spec
from itertools import combinations
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ...ontology.errors import extra_required
from ...ontology.yaml_reader import read_text, read_yaml

Phones = tuple[str, ...]

_FILE = Path(__file__).with_name("phones.yaml")
_DICTIONARY = "model/en-us/cmudict-en-us.dict"
_VARIANT = re.compile(r"\(\d+\)$")


@dataclass(frozen=True)
class Pronunciation:
    """How words sound, and which phones are near each other.

    Attributes:
        words: the pronunciations of each word of the dictionary, the usual one first.
        letters: the phones of letters, for a word that the dictionary lacks.
        near: the pairs of phones that are easily taken for each other.
        vowels, endings: the phones that are vowels, or may be the end of an inflected word.
        articles: the words that hardly carry meaning.
    """

    words: Mapping[str, Sequence[Phones]]
    letters: Mapping[str, Phones]
    near: frozenset[tuple[str, str]]
    vowels: frozenset[str]
    endings: frozenset[str]
    articles: frozenset[str]

    def of_word(self, word: str) -> Sequence[Phones]:
        """Return the pronunciations of a word, the usual one first; by its letters if unknown."""
        known = self.words.get(word.lower())
        spelled = (self.letters[each] for each in self._spelling.findall(word.lower()))
        return known or [tuple(phone for phones in spelled for phone in phones)]

    def weights(self, phones: Phones, is_article: bool) -> list[float]:
        """Return how much each phone of a word counts: an article and an ending half."""
        ends = len(phones) > 1 and phones[-1] in self.endings
        whole = 0.5 if is_article else 1.0
        return [*[whole] * (len(phones) - 1), 0.5 if ends else whole]

    def distances(self) -> npt.NDArray[np.float32]:
        """Return how far each phone is from each other one, in [0, 1]."""
        return np.array(
            [
                [self._distance(*pair) for pair in zip([one] * len(self.phones), self.phones)]
                for one in self.phones
            ],
            np.float32,
        )

    def _distance(self, one: str, other: str) -> float:
        if one == other:
            return 0.0
        if (one, other) in self.near:
            return 0.4
        return 0.7 if {one, other} <= self.vowels else 1.0

    @cached_property
    def phones(self) -> Sequence[str]:
        """All phones."""
        spelled = (phone for each in self.letters.values() for phone in each)
        return sorted({*spelled, *self.vowels, *(phone for phone, _ in self.near)})

    @cached_property
    def _spelling(self) -> re.Pattern[str]:
        return re.compile("|".join(sorted(self.letters, key=len, reverse=True)))


@lru_cache(maxsize=1)
def load_pronunciation() -> Pronunciation:
    """Return how English words sound; MissingExtraError without the dictionary."""
    fields = read_yaml(_FILE).entries(
        required=("vowels", "near", "endings", "articles", "letters"), optional=()
    )
    sets = {name: frozenset(fields[name].texts()) for name in ("vowels", "endings", "articles")}
    pairs = [pair for each in fields["near"].items() for pair in combinations(each.texts(), 2)]
    near = frozenset(pairs) | {(other, one) for one, other in pairs}
    letters = {
        name: tuple(str(each.value).split()) for name, each in fields["letters"].entries().items()
    }
    return Pronunciation(_dictionary(), letters, near, **sets)


def _dictionary() -> Mapping[str, Sequence[Phones]]:
    with extra_required("speech", "pocketsphinx"):
        found = find_spec("pocketsphinx")
        if found is None or found.origin is None:
            raise ImportError
    words: dict[str, list[Phones]] = defaultdict(list)
    for line in read_text(Path(found.origin).parent / _DICTIONARY).splitlines():
        word, *phones = line.split()
        words[_VARIANT.sub("", word)].append(tuple(phones))
    return words
