"""Clauses: which words of a derivation belong to the main clause and which to its condition.

Every leaf that is a function word, a verb or a turn of phrase gives the features of the words in
its span, whatever entry took them. What a sentence names has features, too: whether a new noun is
a part of what it is said of, or something that can be handled at all.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..grammar.categories import AtomicCategory
from ..grammar.word_patterns import places_of
from ..lexicon.lexicon import Entry
from ..lexicon.tokenizer import Tokens
from ..lexicon.unknown_words import new_recipients
from ..lexicon.vocabulary import NewWord
from ..semantics.clause_features import CONDITION, MAIN, FeatureReader, UtteranceFeatures
from ..semantics.meaning import (
    ActionRule,
    Command,
    FunctionalRule,
    KindStatement,
    Meaning,
    NormStatement,
    Statement,
    ToolCommand,
)
from .chart import Derivation, lexical_entries
from .understanding import Reading


def features_of(reader: FeatureReader, reading: Reading, tokens: Tokens) -> UtteranceFeatures:
    """Return the features of a sentence, with those of the new nouns in its meaning."""
    derivation, meaning = reading.derivation, reading.meaning
    words = list(_words(reader, derivation, tokens.words, MAIN))
    found = reader.features(words, tokens.removed)
    named = dict(features_of_names(reader, tokens.words, meaning, reading.new_words))
    source = meaning.source if isinstance(meaning, (Statement, KindStatement)) else None
    if source:
        new = {entry.name for entry in lexical_entries(derivation) if entry.role == "person"}
        before = _before(tokens.words, source, 1)
        if not reader.is_person(source, before, is_new=source in new):
            named["source"] = frozenset({"other"})
    if isinstance(meaning, Command) and _may_be_place(reader, derivation, tokens.words):
        named["recipient"] = frozenset({"place"})
    return replace(found, main={**found.main, **named}) if named else found


def _words(
    reader: FeatureReader, derivation: Derivation, words: Sequence[str], clause: str
) -> Iterator[tuple[str, str]]:
    category = str(derivation.category)
    if category in reader.categories["condition"]:
        clause = CONDITION
    rule = derivation.rule
    if isinstance(rule, Entry):
        is_name = rule.name and isinstance(rule.category, AtomicCategory)
        if is_name or category in reader.categories["name"]:
            clause = ""
        for word in words[derivation.start : derivation.end]:
            yield word, clause
    for part in derivation.parts:
        yield from _words(reader, part, words, clause)


def features_of_names(
    reader: FeatureReader, words: Sequence[str], meaning: Meaning, new_words: Sequence[NewWord]
) -> Iterator[tuple[str, frozenset[str]]]:
    """Yield the features `part`, `thing` and `use` of what a meaning names."""
    new = {word.role: word for word in new_words}
    if isinstance(meaning, Statement):
        said_of = {word.word: word.said for word in new_words if word.role == "part"}
        parts = {rule.part for rule in meaning.rules if isinstance(rule, ActionRule)}
        is_known = "object" not in new
        found = {_part(reader, words, p, said_of.get(p), is_known=is_known) for p in parts} - {""}
        if found:
            yield "part", frozenset(found)
        objects = {rule.object for rule in meaning.rules}
        is_determined = words[0] in reader.words["determiners"]
        if any(
            reader.is_abstract(word.said, word.word)
            and word.word in objects
            # "A match is used for lighting" is about what the noun names.
            and not (is_determined and _place(words, word.said) == 1)
            for word in new_words
        ):
            yield "thing", frozenset({"abstract"})
        elif "object" in new and "affordance" in new:
            yield "thing", frozenset({"new"})
        uses = (rule for rule in meaning.rules if isinstance(rule, FunctionalRule))
        if any(rule.material and rule.affordance in reader.words["acts"] for rule in uses):
            yield "use", frozenset({"act"})
    elif isinstance(meaning, NormStatement):
        if "place" in new and not reader.is_place(new["place"].word):
            yield "place", frozenset({"new"})
    elif isinstance(meaning, (Command, ToolCommand)) and "object" in new:
        said = new["object"]
        before = _before(words, said.said, 3)
        if reader.is_abstract(said.said, said.word):
            yield "thing", frozenset({"abstract"})
        elif "your" in before:
            yield "thing", frozenset({"own"})
        elif reader.words["determiners"].isdisjoint(before):
            yield "thing", frozenset({"bare"})


def _may_be_place(reader: FeatureReader, derivation: Derivation, words: Sequence[str]) -> bool:
    entries = lexical_entries(derivation)
    goals, carrying = reader.categories["goal"], reader.words["carrying"]
    is_goal = any(str(entry.category) in goals for entry in entries)
    return is_goal and bool(new_recipients(entries)) and not carrying.isdisjoint(words)


def _part(
    reader: FeatureReader, words: Sequence[str], part: str, new: str | None, *, is_known: bool
) -> str:
    said = new or part
    before = _before(words, said, 3)
    if before and before[-1] in reader.words["owners"]:
        return "own"
    if new is None or reader.is_part(said, part):
        return ""
    if reader.is_abstract(said, part) or reader.is_elsewhere(said, part):
        return "new"
    if not reader.words["part_words"].isdisjoint((*before, *_after(words, said))):
        return ""
    return "new" if is_known or reader.words["holding_words"].isdisjoint(before) else "unsure"


def _before(words: Sequence[str], said: str, count: int) -> Sequence[str]:
    place = _place(words, said)
    return words[max(0, place - count) : place] if place is not None else ()


def _after(words: Sequence[str], said: str) -> Sequence[str]:
    place, length = _place(words, said), len(said.split(" "))
    return words[place + length :][:1] if place is not None else ()


def _place(words: Sequence[str], said: str) -> int | None:
    return next(places_of(tuple(said.split(" ")), words), None)
