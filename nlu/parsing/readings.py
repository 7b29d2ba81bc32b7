"""Readings: which ones may be accepted by their new words, and the features of their clauses.

A statement may teach new words; a question may be about them, and an action may be requested on
what they name. "No, knives are for cutting" corrects something, "no knives are for pounding"
negates it, and only the pause tells. So a rule is accepted of "no knife" only as a negative one,
and of "..., no, for stirring" no two rules at once.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from ..grammar.categories import AtomicCategory
from ..grammar.combinators import BinaryRule
from ..grammar.word_patterns import places_of
from ..lexicon.lexicon import Entry
from ..lexicon.tokenizer import BREAK, Tokens
from ..lexicon.unknown_words import KnownWords, new_recipients
from ..lexicon.vocabulary import NewWord
from ..semantics import meaning as meanings
from ..semantics.clause_features import CONDITION, MAIN, FeatureReader, UtteranceFeatures
from ..semantics.meaning import Command, Meaning, Norm, NormStatement, Question, Rule, Statement
from .chart import Derivation, lexical_entries
from .understanding import Reading

MAX_NEW_NAMES = 2
"""A command or question names at most so many unknown objects and uses, a rule one more."""


@dataclass(frozen=True, repr=False)
class ReadingFilter:
    """The filter for the readings of one sentence."""

    known_words: KnownWords
    features: FeatureReader

    def accepted(self, readings: Sequence[Reading], tokens: Tokens) -> list[Reading]:
        """Return the readings of a whole sentence that may be accepted, in the same order."""
        words, pauses, known = tokens.words, tokens.pauses, self.known_words
        places = [place for place, word in enumerate(words) if word in known.builder.denying]
        after = [n + 1 for n in places if n + 1 < len(words) and n + 1 not in pauses]
        negated = any(known.may_be_a_thing(words[n]) for n in after)
        repaired = any(n in pauses or words[n - 1] == BREAK for n in places if n)
        commanded = any(isinstance(each.meaning, Command) for each in readings)
        return [
            each
            for each in readings
            if (not negated or _is_negative(each.meaning))
            and not (repaired and isinstance(each.meaning, Statement) and each.meaning.rules[1:])
            and not any(
                self.features.has_feature(part)
                for word in each.new_words
                for part in word.said.split(" ")
            )
            and not _is_torn(each.derivation, tokens)
            and (not each.new_words or self._may_introduce_words(each, tokens))
            and self._may_name_recipients(each, tokens, commanded=commanded)
        ]

    def _may_introduce_words(self, reading: Reading, tokens: Tokens) -> bool:
        words, meant, kind = reading.new_words, reading.meaning, reading.speech_act.name
        match meant.choices[0] if isinstance(meant, meanings.AskBack) and meant.choices else meant:
            case Statement(rules):
                are_too_many = len(words) > MAX_NEW_NAMES * len(rules) + 1
                said = {word.role: word.said for word in words}
                participle = self.known_words.origins(said.get("context", ""), "participle")
                names_agent = "part" in said and participle
                no_material = (self._may_be_no_material(rule, words) for rule in rules)
                things = [word for word in words if word.role == "object"]
                no_thing = (self._is_use(w, tokens) or self._acts(w, tokens, kind) for w in things)
                return not (are_too_many or names_agent or any(no_thing) or any(no_material))
            case meanings.KindStatement():
                return self._may_introduce_kinds(reading)
            case meanings.TopicStatement() | meanings.PartNaming():
                return self._are_things(words) or all(word.role == "part" for word in words)
            case NormStatement(norms):
                return self._may_introduce_in_norms(norms, words)
            case Question() | Command() | meanings.ToolCommand() as asked:
                is_act = not isinstance(asked, Question)
                # No action is done to people.
                are_people = is_act and tokens.proper.intersection(word.said for word in words)
                may_be_asked = (self._may_be_named(word, is_act=is_act) for word in words)
                return len(words) <= MAX_NEW_NAMES and not are_people and all(may_be_asked)
            case _:
                return False

    def _is_use(self, word: NewWord, tokens: Tokens) -> bool:
        is_bare = self.features.words["determiners"].isdisjoint(_before(tokens.words, word.said, 1))
        return is_bare and self.known_words.lexicon.is_name(word.said, ("K",))  # "and cutting"

    def _acts(self, word: NewWord, tokens: Tokens, kind: str) -> bool:
        said = tokens.words
        begins = word.said == said[0] and not self.known_words.origins(said[0], "plural")
        bare = self.features.words["determiners"].isdisjoint(_before(said, word.said, 1))
        acts = begins and self.features.words["being"].isdisjoint(said)  # "Anna can cut bread"
        acts &= kind != "FRAGMENT"  # "cream too"
        return bare and (acts or word.said in tokens.proper)

    def _are_things(self, words: Sequence[NewWord], most: int = 1) -> bool:
        is_abstract = self.features.is_abstract
        kinds = (word.role == "object" and not is_abstract(word.said, word.word) for word in words)
        return len(words) <= most and all(kinds)

    def _may_introduce_in_norms(self, norms: Sequence[Norm], words: Sequence[NewWord]) -> bool:
        if any(isinstance(norm.act, meanings.ToolCommand) for norm in norms):
            return False  # "you can't cut bread with a saw" is a rule on saws
        is_abstract, is_part = self.features.is_abstract, self.features.is_part
        parts = [word for word in words if word.role == "part" and is_part(word.said, word.word)]
        places = [word for word in words if word.role == "place"]
        things = [word for word in words if word not in (*parts, *places)]
        if parts and things and any(norm.norm == "permitted" for norm in norms):
            return False  # "you can lift a pot by the lid" may say how it is done
        if not all(self.known_words.is_surely_name(word.said) for word in things):
            return False  # "an empty bottle"
        are_places = not any(is_abstract(w.said, w.word) or is_part(w.word) for w in places)
        return are_places and self._are_things(things, most=2 if norms[0].before else 1)

    def _may_introduce_kinds(self, reading: Reading) -> bool:
        above = {
            part.arguments[1].said
            for part in reading.speech_act
            if part.name == "isA" and not part.arguments[0].name.endswith(part.arguments[1].name)
        }
        return all(
            word.role == "object"
            and word.word not in above
            and self.known_words.is_surely_name(word.said)
            and not self.features.is_abstract(word.said, word.word)
            for word in reading.new_words
        )

    def _may_be_named(self, word: NewWord, *, is_act: bool) -> bool:
        is_part = is_act and word.role == "part" and self.features.is_part(word.said)
        is_name = word.role in {"object", "affordance"}
        is_new = not (is_act or any(map(self.known_words.has, word.said.split(" "))))
        return is_part or (is_name and (is_new or self.known_words.is_surely_name(word.said)))

    def _may_name_recipients(self, reading: Reading, tokens: Tokens, *, commanded: bool) -> bool:
        """Whether those whom a reading takes for people may be given something."""
        people = new_recipients(lexical_entries(reading.derivation))
        if not people:
            return True
        if reading.new_words and not self.features.words["carrying"].isdisjoint(tokens.words):
            return False  # "send an email to my landlord"
        is_said_of_them = reading.speech_act.arguments[-1].name == "need"  # "the lock needs a key"
        kinds = (self.features.is_part, self.features.is_elsewhere, self.features.is_abstract)
        given = (Command, Statement) if commanded else (Command, NormStatement, Statement)
        is_norm = isinstance(reading.meaning, NormStatement) and not tokens.is_transcript
        near = (_before(tokens.words, p.word, 1) for p in people if p.word not in tokens.proper)
        if is_norm and any(map(self.features.words["determiners"].isdisjoint, filter(None, near))):
            return False  # "the knife is not for hair"
        return (
            isinstance(reading.meaning, given)
            and not is_said_of_them
            and not any(self.known_words.origins(person.said, "adverb") for person in people)
            and not any(is_kind(each.said.split()[-1]) for each in people for is_kind in kinds)
        )

    def _may_be_no_material(self, rule: Rule, words: Iterable[NewWord]) -> bool:
        if not isinstance(rule, meanings.FunctionalRule):
            return False
        said = {word.said for word in words if word.word == rule.material}
        return any(self.known_words.origins(each, "adverb") for each in said)


_OBJECTS = ("/NP", "/N", "/MS", "/MB")  # how the categories of verbs end that take an object


def _is_torn(derivation: Derivation, tokens: Tokens) -> bool:
    """Whether a gerund takes what follows a pause for its object: "for polishing, wine glasses"."""
    first = derivation.parts[0] if derivation.rule is BinaryRule.FORWARD else None
    if first and isinstance(first.rule, Entry) and first.end in tokens.pauses:
        is_gerund = tokens.words[first.end - 1].endswith("ing")
        return is_gerund and str(first.category).endswith(_OBJECTS)  # not "generally speaking"
    return any(_is_torn(part, tokens) for part in derivation.parts)


def _is_negative(meaning: Meaning) -> bool:
    if isinstance(meaning, meanings.SimpleCommand):
        return meaning.negated
    rules = meaning.rules if isinstance(meaning, Statement) else ()
    return all(rule.denies and not rule.revises for rule in rules)


def features_of(reader: FeatureReader, reading: Reading, tokens: Tokens) -> UtteranceFeatures:
    """Return the features of a sentence, with those of the new nouns in its meaning."""
    derivation, meaning = reading.derivation, reading.meaning
    entries = lexical_entries(derivation)
    found = reader.features(list(_words(reader, derivation, tokens.words, MAIN)), tokens.removed)
    named = dict(features_of_names(reader, tokens.words, meaning, reading.new_words))
    source = meaning.source if isinstance(meaning, (Statement, meanings.KindStatement)) else None
    if source:
        new = {entry.name for entry in entries if entry.role == "person"}
        if not reader.is_person(source, _before(tokens.words, source, 1), is_new=source in new):
            named["source"] = frozenset({"other"})
    is_goal = any(str(entry.category) in reader.categories["goal"] for entry in entries)
    is_carried = not reader.words["carrying"].isdisjoint(tokens.words)
    if isinstance(meaning, Command) and is_goal and is_carried and new_recipients(entries):
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
        parts = {rule.part for rule in meaning.rules if isinstance(rule, meanings.ActionRule)}
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
        elif any(w.role == "object" and _is_gerund_alone(reader, words, w.said) for w in new_words):
            yield "thing", frozenset({"bare"})
        elif "object" in new and "affordance" in new:
            yield "thing", frozenset({"new"})
        uses = [rule for rule in meaning.rules if isinstance(rule, meanings.FunctionalRule)]
        acts, by = reader.words["acts"], reader.words["holding_words"]
        is_tool = "part" in new and by.isdisjoint(_before(words, new["part"].said, 3))
        is_unsure = "context" in new and (is_tool or any(rule.denies for rule in meaning.rules))
        is_content = any(_is_content(reader, words, rule.material) for rule in uses)
        if is_unsure or is_content or any(r.material and r.affordance in acts for r in uses):
            yield "use", frozenset({"act"})
    elif isinstance(meaning, NormStatement):
        if "place" in new and not new["place"].word.endswith(reader.endings["place"]):
            yield "place", frozenset({"new"})
    elif isinstance(meaning, meanings.SimpleCommand) and "object" in new:
        said = new["object"]
        before = _before(words, said.said, 3)
        if reader.is_abstract(said.said, said.word):
            yield "thing", frozenset({"abstract"})
        elif "your" in before:
            yield "thing", frozenset({"own"})
        elif reader.words["determiners"].isdisjoint(before):
            yield "thing", frozenset({"bare"})


def _is_gerund_alone(reader: FeatureReader, words: Sequence[str], said: str) -> bool:
    # "Turning screws! And hold it by the shaft" answers what something is for.
    first = (*said.split(), BREAK)
    is_gerund = len(first) > 2 and first[0].endswith("ing")
    is_bare = reader.words["determiners"].isdisjoint(_before(words, said, 1))
    return is_gerund and is_bare and any(True for _ in places_of(first, words))


def _is_content(reader: FeatureReader, words: Sequence[str], material: str | None) -> bool:
    # "The box contains a hammer" says where the hammer is.
    said = {words[0], *_before(words, material, 1)} if material else set()
    contains = not reader.words["containing"].isdisjoint(words)
    return contains and not said.isdisjoint(reader.words["definite"])


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
    place, length = _place(words, said), len(said.split(" "))
    after = words[place + length :][:1] if place is not None else ()
    if not reader.words["part_words"].isdisjoint((*before, *after)):
        return ""
    return "new" if is_known or reader.words["holding_words"].isdisjoint(before) else "unsure"


def _before(words: Sequence[str], said: str, count: int) -> Sequence[str]:
    place = _place(words, said)
    return words[max(0, place - count) : place] if place is not None else ()


def _place(words: Sequence[str], said: str) -> int | None:
    return next(places_of(tuple(said.split(" ")), words), None)
