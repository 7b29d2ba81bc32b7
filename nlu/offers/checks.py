"""Checks on offers: a meaning may be offered only if it loses nothing that was said.

People say yes to what looks right. So a negation, a condition, an exception, a degree, a doer, a
source or a time that the words show and the meaning does not rules the meaning out, as does half a
sentence. Doers, sources, times and modality are features, on which the licence decides; the words
for the other checks are data (`offers.yaml`).
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ..grammar.word_patterns import Phrase, WordLists, places_of
from ..lexicon.tokenizer import BREAK
from ..lexicon.vocabulary import NewWord
from ..parsing.readings import features_of_names
from ..semantics import meaning as meanings
from ..semantics.clause_features import CONDITION, HIDING, MAIN, FeatureReader, UtteranceFeatures
from ..semantics.licence_table import ACCEPT, LicenceTable
from ..semantics.meaning import ActionRule, Command, Meaning, Question, SimpleCommand, Statement
from .meaning_shapes import leaves
from .mentions import Mentions, Span

OPERATORS = ("negative", "implied_negation", "weak_negation", "condition", "exception", "doubtful")
"""The lists of words on which a meaning may depend."""

_DENYING = ("negative", "implied_negation", "weak_negation", "exception")
_SIGNS = (*OPERATORS, "by", "before_part")
_QUOTES = frozenset('"“”„«»')
_ANYBODY, _UNSURE = frozenset({"generic", "people"}), frozenset({"weak", "perhaps"})
_HEARER, _NOW = frozenset({"addressee"}), frozenset({"now"})
_UNSAID = frozenset({(0.95, 1.0), (0.0, 0.05)})  # the degrees of rules that no word gives
_ASKED = 3  # words after the beginning of a phrase that asks for something


@dataclass(frozen=True)
class OfferChecks:
    """What an offer must keep of an utterance, by the words of each check in `offers.yaml`."""

    words: WordLists
    reader: FeatureReader
    licence: LicenceTable

    def weakened(self, meaning: Meaning, mentions: Mentions, asides: Sequence[Span]) -> Meaning:
        """Return a meaning as sure as the utterance says it."""
        return self.licence.weakened(meaning, self.clause_features(mentions, asides))

    def lost(self, meaning: Meaning, mentions: Mentions, asides: Sequence[Span]) -> str:
        """Return what a meaning would lose of an utterance beside some asides, empty if nothing."""
        kept: Mapping[str, Callable[[], bool]] = {
            "completeness": lambda: self._is_complete(meaning, mentions),
            "sign": lambda: self._keeps_sign(meaning, mentions, asides),
            "topic": lambda: self._keeps_topic(meaning, mentions),
            "scope": lambda: self._keeps_scope(meaning, mentions),
            "degree": lambda: self._keeps_degree(meaning, mentions),
            "condition": lambda: self._keeps_condition(meaning, mentions),
            "grip": lambda: self._keeps_grip(meaning, mentions),
            "recipient": lambda: self._keeps_recipient(meaning, mentions),
            "quotation": lambda: not _QUOTES.intersection(mentions.tokens.text),
            "question": lambda: not mentions.tokens.asks or not isinstance(meaning, Statement),
            "licence": lambda: self._is_licensed(meaning, mentions, asides),
        }
        return next((name for name, keeps in kept.items() if not keeps()), "")

    def _is_licensed(self, meaning: Meaning, mentions: Mentions, asides: Sequence[Span]) -> bool:
        features = self.clause_features(mentions, [*asides, *self._reasons(meaning, mentions)])
        if isinstance(meaning, SimpleCommand) and (
            features.main.get("tense", _NOW) - _NOW or self._is_done_by_others(meaning, mentions)
        ):
            return False
        words, said = mentions.tokens.words, {str(leaf) for _, leaf in leaves(meaning.as_json())}
        new = [
            NewWord(each.name, each.role, " ".join(words[each.start : each.end]))
            for each in mentions.names
            if each.is_new and each.role != "act" and each.name in said
            if each.role == "person" or each.name != getattr(meaning, "recipient", None)
        ]
        named = dict(features_of_names(self.reader, words, meaning, new))
        # Whether what people do is meant for the robot, too, is what the offer asks.
        rules = meaning.rules if isinstance(meaning, Statement) else ()
        is_weak = any(rule.confidence[0] <= meanings.LIKELY for rule in rules)
        asked = _ANYBODY | (_UNSURE if is_weak else set())
        main = {name: values - asked for name, values in features.main.items()}
        features = replace(features, main={**main, **named})
        return self.licence.outcome(meaning, features) == ACCEPT

    def _is_done_by_others(self, meaning: SimpleCommand, mentions: Mentions) -> bool:
        words = mentions.tokens.words
        acts = [m for m in mentions.names if m.role == "act" and m.name == meaning.goal]
        subjects = [self.reader.of_words(words[m.start - 1 : m.start]) for m in acts if m.start]
        return any(each.get("agent", _HEARER) != _HEARER for each in subjects)

    def denies(self, words: Sequence[str]) -> bool:
        """Whether words deny something, limit it by an exception, or say what comes close."""
        return any(self._has(kind, words) for kind in _DENYING)

    def clause_features(self, mentions: Mentions, asides: Sequence[Span]) -> UtteranceFeatures:
        """The features of the clauses of an utterance that names this."""
        words = mentions.tokens.words
        beside = {place for span in asides for place in range(*span)}
        main = [each for n, each in enumerate(self._clauses(mentions)) if n not in beside]
        return self.reader.features(main, [words[start:end] for start, end in asides])

    def signs(self, mentions: Mentions) -> frozenset[str]:
        """What the words of an utterance say of doer, time, source and sign."""
        words, features = mentions.tokens.words, self.clause_features(mentions, ())
        found = {kind for kind in _SIGNS if self._has(kind, words)}
        for clause in (MAIN, CONDITION):
            for feature, values in features.of(clause).items():
                found |= {f"{clause} {feature}={value}" for value in values}
        return frozenset(found | ({"cut"} if self._is_cut(words) else set()))

    def _is_complete(self, meaning: Meaning, mentions: Mentions) -> bool:
        words, pauses = mentions.tokens.words, mentions.tokens.pauses
        is_cut = not isinstance(meaning, Question) and self._is_cut(words)
        doubled = (n for n, (one, two) in enumerate(pairwise(words), start=1) if one == two)
        return not is_cut and all(place in pauses for place in doubled)

    def _is_cut(self, words: Phrase) -> bool:
        last = words[-1:]  # "what you hold it by" is whole
        is_stranded = self.words.has("by", *last) and self._has("relative", words)
        return self.words.has("unfinished", *last) and not is_stranded

    def _keeps_sign(self, meaning: Meaning, mentions: Mentions, asides: Sequence[Span]) -> bool:
        words, is_why = mentions.tokens.words, getattr(meaning, "ask", "why") in {"why", "why_not"}
        if not is_why:
            return True
        own = [span for span in asides if self.is_clause_of_its_own(words[slice(*span)])]
        own += self._reasons(meaning, mentions)
        own += [s for s in mentions.pieces if self.words.end("concession", words[slice(*s)])]
        beside = {place for span in own for place in range(*span)} | self._idle(mentions)
        implied = beside.issuperset(self.spoken("implied_negation", mentions))
        if meaning != meanings.Retraction() and not implied:
            return False
        if not beside.issuperset(self._places("weak_negation", words)):
            return False
        denied = set(self.spoken("negative", mentions)) - beside
        never = [end for _, end, (_, upper) in mentions.degrees if upper < meanings.LIKELY]
        if any({end, end + 1} & denied for end in never):
            return False  # "never don't"
        is_told = isinstance(meaning, (Statement, meanings.NormStatement)) or not denied
        count = len(denied) + bool(never and is_told)
        signs = int(is_negative(meaning))
        return count == signs or (count == signs + 1 and meanings.only_revises(meaning))

    def _reasons(self, meaning: Meaning, mentions: Mentions) -> Iterator[Span]:
        if not isinstance(meaning, Command):
            return
        words = mentions.tokens.words
        asked = {m.start for m in mentions.names if m.role == "act" and m.name == meaning.goal}
        uses = {m.start for m in mentions.names if m.role == "affordance" and not m.is_new}
        for start, end in self._clause_spans(mentions) if asked else ():
            is_own = self.is_clause_of_its_own(words[start:end])
            is_own = is_own or self._has("finite", words[start:end])
            is_reason = is_own or self.words.has("turning", *words[end : end + 1])
            if is_reason and (asked | uses).isdisjoint(range(start, end)):
                yield start, end

    def _clause_spans(self, mentions: Mentions) -> Iterator[Span]:
        words = mentions.tokens.words
        parting = self.words.phrases("turning") | self.words.phrases("because")
        for start, end in mentions.pieces:
            inner = [n for n in range(start + 1, end) if (words[n],) in parting]
            yield from pairwise((start, *inner, end))

    def _keeps_recipient(self, meaning: Meaning, mentions: Mentions) -> bool:
        if not isinstance(meaning, Command) or not self._has("recipient", mentions.tokens.words):
            return True
        return any(m.role == "person" and m.name == meaning.recipient for m in mentions.names)

    def _keeps_topic(self, meaning: Meaning, mentions: Mentions) -> bool:
        rules = meaning.rules if isinstance(meaning, Statement) else ()
        is_of_it = any(self.words.end("pronoun", mentions.tokens.words, n) > n for n in range(2))
        is_other = is_of_it and any(rule.object != mentions.it for rule in rules)
        return not is_other and not meanings.is_used_on_itself(meaning)

    def _keeps_scope(self, meaning: Meaning, mentions: Mentions) -> bool:
        if not isinstance(meaning, Statement) or len({rule.denies for rule in meaning.rules}) < 2:
            return True
        denied = {_said_of(rule) for rule in meaning.rules if rule.denies}
        named = [m for m in mentions.names if m.name in set(map(_said_of, meaning.rules))]
        return all(
            not after or after[0].name in denied
            for place in self._places("negative", mentions.tokens.words)
            for after in [[m for m in named if m.start > place]]
        )

    def is_clause_of_its_own(self, words: Sequence[str]) -> bool:
        """Whether a clause has a doer or gives a reason, and is no speech or thought."""
        is_clause = self._has("doer", words) or self.words.end("because", tuple(words)) > 0
        return is_clause and self.reader.words["embedding"].isdisjoint(words)

    def _idle(self, mentions: Mentions) -> set[int]:
        words = mentions.tokens.words
        found = {place for start, end, _ in mentions.degrees for place in range(start, end)}
        for start, word in enumerate(words):
            for phrase, values in self.reader.phrases.get(word, ()):
                if HIDING in values and words[start : start + len(phrase)] == phrase:
                    found.update(range(start, start + len(phrase)))
        return found

    def spoken(self, kind: str, mentions: Mentions) -> list[int]:
        """The places of words of a kind; of one that is an adverb at the end of a clause none."""
        words, last = mentions.tokens.words, {end - 1 for _, end in mentions.pieces}
        idle = self._idle(mentions) | {n for n in self._places("at_end", words) if n in last}
        idle |= {n + k for n in self._places("asked", words) for k in range(_ASKED)}
        return [place for place in self._places(kind, words) if place not in idle]

    def _keeps_degree(self, meaning: Meaning, mentions: Mentions) -> bool:
        said = {interval for _, _, interval in mentions.degrees}
        if isinstance(meaning, Statement):
            told = {rule.confidence for rule in meaning.rules}
            return not said or (said <= told and (len(told) == 1 or told - said <= _UNSAID))
        return all(is_negative(meaning) and upper < meanings.LIKELY for _, upper in said)

    def _keeps_condition(self, meaning: Meaning, mentions: Mentions) -> bool:
        is_doubted = not isinstance(meaning, Question) and self.spoken("doubtful", mentions)
        if is_doubted or self.spoken("exception", mentions):
            return False
        is_now = isinstance(meaning, SimpleCommand) and not meaning.negated
        if not is_now and self.spoken("until", mentions):
            return False
        if not (is_now or isinstance(meaning, Question)) and self.spoken("placed", mentions):
            return False
        if isinstance(meaning, SimpleCommand):
            kind = "supposing" if is_now else "condition"
            return all(self._asks(meaning, n, mentions) for n in self.spoken(kind, mentions))
        names = _names_in(meaning)
        spoken = [each.start for each in mentions.names if each.name in names]
        return all(
            any(place < other < end for other in spoken)
            for place in self.spoken("condition", mentions)
            for start, end in mentions.pieces
            if start <= place < end
        )

    def _asks(self, meaning: SimpleCommand, place: int, mentions: Mentions) -> bool:
        acts = [m.start for m in mentions.names if m.role == "act" and m.name == meaning.goal]
        between = range(place + 1, min(acts, default=0))
        words = [mentions.tokens.words[each] for each in between]
        return set(between).isdisjoint(mentions.tokens.pauses) and self._has("hearer", words)

    def _keeps_grip(self, meaning: Meaning, mentions: Mentions) -> bool:
        if not isinstance(meaning, Statement):
            return True
        words = mentions.tokens.words
        acts, named = (mentions.by_role.get(role, {}) for role in ("act", "part"))
        held = "grasp" in acts or self._has("gripping", words)
        parts = {rule.part for rule in meaning.rules if isinstance(rule, ActionRule)}
        for each in (each for part in parts for each in named.get(part, ())):
            said = words[max(0, each.start - 3) : each.start]
            is_part = not each.is_new or self.reader.is_part(each.name)
            is_held = held or self._has("by", said)
            if not is_held or not (is_part or self._has("before_part", said)):
                return False
        return True

    def _clauses(self, mentions: Mentions) -> Iterator[tuple[str, str]]:
        named = {n for m in mentions.known for n in range(m.start, m.end)}
        clause = MAIN
        for place, word in enumerate(mentions.tokens.words):
            if place in mentions.tokens.pauses or word == BREAK:
                clause = MAIN
            if self.words.has("condition", word):
                clause = CONDITION
            yield word, "" if place in named else clause

    def _has(self, kind: str, words: Sequence[str]) -> bool:
        return any(True for _ in self._places(kind, words))

    def _places(self, kind: str, words: Sequence[str]) -> Iterator[int]:
        return (place for phrase in self.words.phrases(kind) for place in places_of(phrase, words))


def is_negative(meaning: Meaning) -> bool:
    """Whether a meaning says that something is not so, not to be done or not to be taken."""
    match meaning:
        case Statement(rules):
            return any(rule.denies for rule in rules)
        case meanings.Retraction(rule):
            return rule is not None and rule.denies
        case Command() | meanings.ToolCommand():
            target = meaning.target if isinstance(meaning, Command) else meaning.tool
            return meaning.negated or target.not_used_for is not None
        case meanings.NormStatement(norms):
            return any(norm.norm == "forbidden" for norm in norms)
        case Question():
            return meaning.ask == "why_not"
        case _:
            return False


def _said_of(rule: meanings.Rule) -> str:
    return rule.part if isinstance(rule, ActionRule) else rule.affordance


def _names_in(meaning: Meaning) -> Collection[str]:
    match meaning:
        case Statement(rules):
            held = {r.part for r in rules if isinstance(r, ActionRule)}
            return held | {r.context if isinstance(r, ActionRule) else r.affordance for r in rules}
        case Question():
            return frozenset(filter(None, (meaning.affordance, meaning.context)))
        case meanings.NormStatement(norms):
            return frozenset(norm.act.goal for norm in norms)
        case _:
            return frozenset()
