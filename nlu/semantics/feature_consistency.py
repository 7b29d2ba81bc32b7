"""Features of the spellings of a word file: a pattern has at most one value of each feature.

"(you|they) hold it" says in one spelling that the robot does it and in another that others do. What
an entry may become would then depend on which of its words were said. A file that lets a feature
vary all the same (`varies: [agent]`) relies on its being read off the words of each sentence.
"""

from collections.abc import Iterator, Mapping
from itertools import chain, combinations, islice
from pathlib import Path

from ...ontology.yaml_reader import YamlNode, read_yaml
from ..grammar.word_lists import Phrase
from ..grammar.word_patterns import compile_pattern, expand
from .clause_features import FeatureReader

MAX_COMPARED = 20_000  # spellings of one pattern that are compared


def check_spellings(path: Path, reader: FeatureReader) -> None:
    """Check that no pattern mixes two values of a feature; `DataError` says which, and where."""
    parts = read_yaml(path).entries()
    varying = parts["varies"].texts(choices=reader.values) if "varies" in parts else ()
    for pattern in _patterns(parts):
        for feature, found in _features(pattern, reader).items():
            pairs = combinations(found.items(), 2) if feature not in varying else ()
            for (other, other_spelling), (one, spelling) in pairs:
                if one - other and other - one:
                    raise pattern.fail(
                        f'"{pattern.text()}" mixes two values of {feature}: {_shown(one - other)} '
                        f'in "{" ".join(spelling)}" and {_shown(other - one)} in '
                        f'"{" ".join(other_spelling)}". Write a pattern for each.'
                    )


def _patterns(parts: Mapping[str, YamlNode]) -> Iterator[YamlNode]:
    for key in ("words", "constructions"):
        for item in parts[key].items() if key in parts else ():
            yield from item.entries(required=("says",))["says"].listed()
    for key in ("classes", "discourse_markers"):
        groups = parts[key].entries().values() if key in parts else ()
        yield from chain.from_iterable(group.listed() for group in groups)


def _features(pattern: YamlNode, reader: FeatureReader) -> dict[str, dict[frozenset[str], Phrase]]:
    found: dict[str, dict[frozenset[str], Phrase]] = {}
    spellings = list(islice(expand(compile_pattern(pattern.text())), MAX_COMPARED + 1))
    if len(spellings) > MAX_COMPARED:
        raise pattern.fail(f"stands for more than {MAX_COMPARED} spellings.")
    for words in spellings:
        for feature, values in reader.of_words(words).items():
            found.setdefault(feature, {}).setdefault(values, words)
    return found


def _shown(values: frozenset[str]) -> str:
    return " and ".join(sorted(values))
