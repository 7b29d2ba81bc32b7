"""Features of a clause: who does it, when, how surely, on whose word; read off its small words.

The meaning of a sentence leaves out most of its small words: "you might pass a knife by the blade"
and "you pass a knife by the blade" have one predicate form. `FeatureReader` reads the features off
the words of a derivation, whatever entry of the lexicon took them, so that no entry can lose one.
Words that name something have no features; words below a category of `conditions`, such as `ANT`,
belong to the condition. The words and their features are data (`features.yaml`).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, islice
from pathlib import Path
from typing import TypeAlias

from ...ontology.yaml_reader import YamlNode, read_yaml
from ..grammar.word_patterns import Phrase, compile_pattern, expand, spellings

Values: TypeAlias = Mapping[str, frozenset[str]]  # the values of each feature that a clause has
MAX_COMPARED = 20_000  # spellings of one pattern that are compared
HIDING = "nothing"  # the feature of phrases that hide the features of their words

MAIN, CONDITION, ASIDE = "main", "condition", "aside"

NAMED: Values = {
    "part": frozenset({"new", "unsure", "own"}),
    "thing": frozenset({"new", "own", "abstract", "bare"}),
    "use": frozenset({"act"}),
    "recipient": frozenset({"place"}),
    "place": frozenset({"new"}),
}
"""The features of what is named: a person's `own` part, a recipient that is a `place`, ..."""

_BESIDE_NOUNS = ("part_words", "holding_words", "owners", "determiners")
_SINGLE = "embedding acts carrying being containing definite asking interrogative"
_WORDS = (*_BESIDE_NOUNS, *_SINGLE.split())


@dataclass(frozen=True)
class UtteranceFeatures:
    """The features of an utterance by clause."""

    main: Values = field(default_factory=dict)  # of the main clause
    condition: Values = field(default_factory=dict)  # of the clause that says when, or what for
    aside: Values = field(default_factory=dict)  # of the phrases that add nothing

    def of(self, clause: str) -> Values:
        """The values of the features of one clause."""
        return {MAIN: self.main, CONDITION: self.condition, ASIDE: self.aside}[clause]

    def as_json(self) -> dict[str, object]:
        """The features of the main clause, and those of the others by the name of the clause."""
        others = {name: _plain(self.of(name)) for name in (CONDITION, ASIDE) if self.of(name)}
        return {**_plain(self.main), **others}


@dataclass(frozen=True)
class FeatureReader:
    """Reads features off words, by the tables of `features.yaml`, which says what they show.

    The phrases with features go by their first word, the longest first.
    """

    phrases: Mapping[str, Sequence[tuple[tuple[str, ...], Values]]]
    values: Values  # all values of each feature
    nouns: Values  # of each kind: parts, what is no part, and what cannot be handled
    defaults: Values  # the value of a feature that no words show, where it has one
    categories: Values  # of conditions, of people and things, and of goals
    words: Values
    endings: Mapping[str, tuple[str, ...]]  # of abstract nouns, of words for no person, of places

    def features(
        self, words: Sequence[tuple[str, str]], removed: Iterable[Sequence[str]]
    ) -> UtteranceFeatures:
        """Return the features of an utterance by its words and the phrases taken out of it.

        Each word comes with its clause, which is empty for a word that names something.
        """
        said = ([word if c == clause else "" for word, c in words] for clause in (MAIN, CONDITION))
        main, condition = (_joined(self._found(each)) for each in said)
        return self.with_asides(UtteranceFeatures(main, condition), removed)

    def of_words(self, words: Sequence[str]) -> Values:
        """The values of the features of some words, with the default of each that none shows."""
        return {**self.defaults, **_joined(self._found(words))}

    def has_feature(self, word: str) -> bool:
        """Whether a word alone has a feature, so that it is no part of a name."""
        return any(len(phrase) == 1 for phrase, _ in self.phrases.get(word, ()))

    def with_asides(
        self, features: UtteranceFeatures, phrases: Iterable[Sequence[str]]
    ) -> UtteranceFeatures:
        """Return features with those of further phrases that add nothing to the meaning."""
        found = [value for phrase in phrases for value in self._found(phrase)]
        return replace(features, aside=_joined([features.aside, *found]))

    def is_noun(self, word: str) -> bool:
        """Whether a word is a noun of English, if only one of a kind."""
        return any(word in nouns for nouns in self.nouns.values())

    def is_part(self, *words: str) -> bool:
        """Whether one of some nouns is commonly a part of a thing: "lid", "left handle"."""
        return not self.nouns["part"].isdisjoint({word.rpartition(" ")[2] for word in words})

    def is_elsewhere(self, *words: str) -> bool:
        """Whether one of some nouns names what is no part of an object: places, people, clothes."""
        return not self.nouns["elsewhere"].isdisjoint(words)

    def is_abstract(self, *words: str) -> bool:
        """Whether one of some nouns names nothing that can be taken."""
        return not self.nouns["abstract"].isdisjoint(words) or words[-1].endswith(
            self.endings["abstract"]
        )

    def is_person(self, name: str, before: Sequence[str], *, is_new: bool) -> bool:
        """Whether a word names a person after those `before`: not "my aunt", "experience"."""
        is_owned = not (self.words["determiners"] | self.words["owners"]).isdisjoint(before)
        is_thing = self.is_abstract(name) or name.endswith(self.endings["nameless"])
        return not self.has_feature(name) and not is_owned and not (is_new and is_thing)

    def _found(self, words: Sequence[str]) -> Iterator[Values]:
        place = 0
        while place < len(words):
            for phrase, values in self.phrases.get(words[place], ()):
                if tuple(words[place : place + len(phrase)]) == phrase:
                    yield values
                    place += len(phrase) - 1
                    break
            place += 1


def load_features(path: Path) -> FeatureReader:
    """Return the reader of a file; `DataError` also where a phrase has two values of a feature."""
    parts = read_yaml(path).entries(
        required=("features", "categories", "nouns", "endings", *_WORDS), optional=()
    )
    found: dict[tuple[str, ...], dict[str, frozenset[str]]] = {}
    values: dict[str, frozenset[str]] = {}
    defaults: dict[str, frozenset[str]] = {}
    for feature, group in parts["features"].entries().items():
        values[feature] = frozenset(group.entries())
        unmarked = {value for value, phrases in group.entries().items() if not phrases.items()}
        if unmarked:
            defaults[feature] = frozenset(unmarked)
        for value, phrases in group.entries().items():
            for item, phrase in ((i, phrase) for i in phrases.items() for phrase in spellings(i)):
                known = found.setdefault(phrase, {})
                if feature in known:
                    both = f"{', '.join(known[feature])} and {value}"
                    raise item.fail(f'"{item.text()}" has two values of {feature}: {both}.')
                known[feature] = frozenset({value})
    by_first: dict[str, list[tuple[tuple[str, ...], Values]]] = {}
    for phrase, each in sorted(found.items(), key=lambda pair: -len(pair[0])):
        by_first.setdefault(phrase[0], []).append((phrase, each))
    nouns = parts["nouns"].entries(required=("part", "elsewhere", "abstract"), optional=())
    categories = parts["categories"].entries(required=("condition", "name", "goal"), optional=())
    endings = parts["endings"].entries(required=("abstract", "nameless", "place"), optional=())
    return FeatureReader(
        by_first,
        {**values, **NAMED},
        {kind: _words(field) for kind, field in nouns.items()},
        defaults,
        {kind: frozenset(field.texts()) for kind, field in categories.items()},
        {key: _words(parts[key]) for key in _WORDS},
        {kind: field.texts() for kind, field in endings.items()},
    )


def _words(group: YamlNode) -> frozenset[str]:
    return frozenset(" ".join(phrase) for item in group.items() for phrase in spellings(item))


def _joined(found: Iterable[Values]) -> Values:
    joined: dict[str, frozenset[str]] = {}
    for values in found:
        for feature, value in values.items():
            joined[feature] = joined.get(feature, frozenset()) | value
    return joined


def _plain(values: Values) -> dict[str, object]:
    return {feature: sorted(value) for feature, value in sorted(values.items())}


def check_spellings(path: Path, reader: FeatureReader) -> None:
    """Check that no pattern mixes two values of a feature; `DataError` says which, and where."""
    parts = read_yaml(path).entries()
    varying = parts["varies"].texts(choices=reader.values) if "varies" in parts else ()
    items = [e for key in ("words", "constructions") if key in parts for e in parts[key].items()]
    said = [item.entries(required=("says",))["says"] for item in items]
    for key in ("classes", "discourse_markers"):
        said += parts[key].entries().values() if key in parts else ()
    for pattern in (pattern for each in said for pattern in each.listed()):
        for feature, found in _features(pattern, reader).items():
            pairs = combinations(found.items(), 2) if feature not in varying else ()
            for (other, other_spelling), (one, spelling) in pairs:
                first, second = (" and ".join(sorted(each)) for each in (one - other, other - one))
                if first and second:
                    raise pattern.fail(
                        f'"{pattern.text()}" mixes two values of {feature}: {first} '
                        f'in "{" ".join(spelling)}" and {second} in '
                        f'"{" ".join(other_spelling)}". Write a pattern for each.'
                    )


def _features(pattern: YamlNode, reader: FeatureReader) -> dict[str, dict[frozenset[str], Phrase]]:
    found: dict[str, dict[frozenset[str], Phrase]] = {}
    spellings = list(islice(expand(compile_pattern(pattern.text())), MAX_COMPARED + 1))
    if len(spellings) > MAX_COMPARED:
        raise pattern.fail(f"stands for more than {MAX_COMPARED} spellings.")
    for words in spellings:
        for feature, values in reader.of_words(words).items():
            found.setdefault(feature, {}).setdefault(values, words)
    return found
