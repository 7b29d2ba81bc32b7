"""Checks on offers: a meaning may be offered only if it loses nothing that was said.

People say yes to what looks right. So a negation, a condition, an exception, a degree, a doer, a
source or a time that the words show and the meaning does not rules the meaning out, as does half a
sentence. Doers, sources, times and modality are features, on which the licence decides; the words
for the other checks are data (`offers.yaml`).
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ..grammar.word_patterns import Phrase, WordLists, places_of
from ..lexicon.tokenizer import BREAK, Tokens
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

LESS_LIKELY = frozenset({"names", "completeness", "sign", "degree", "doubt", "licence"})
"""What may only seem to be lost, so that a meaning that loses it is less likely, but possible."""

_DENYING = ("negative", "implied_negation", "weak_negation", "exception")
_SIGNS = (*OPERATORS, "by", "before_part")
_ANYBODY, _UNSURE = frozenset({"generic", "people"}), frozenset({"weak", "perhaps"})
_NOW = frozenset({"now"})
_TELLING = frozenset({"attitude", "belief", "source", "condition", "exception"})
_OF_PLACE = frozenset({"how", "see", "source", "about", "why", "why_not"})
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

    def lost(self, meaning: Meaning, mentions: Mentions, asides: Sequence[Span]) -> tuple[str, ...]:
        """Return what a meaning would lose of an utterance beside some asides."""
        kept: Mapping[str, Callable[[], bool]] = {
            "completeness": lambda: self._is_complete(meaning, mentions.tokens),
            "sign": lambda: self._keeps_sign(meaning, mentions, asides),
            "scope": lambda: self._keeps_scope(meaning, mentions),
            "degree": lambda: self._keeps_degree(meaning, mentions),
            "exception": lambda: not self.spoken("exception", mentions),
            "doubt": lambda: self._is_meant(meaning, mentions),
            "condition": lambda: self._keeps_condition(meaning, mentions),
            "recipient": lambda: self._keeps_recipient(meaning, mentions),
            "question": lambda: self._keeps_question(meaning, mentions),
            "licence": lambda: self._is_licensed(meaning, mentions, asides),
        }
        return tuple(name for name, keeps in kept.items() if not keeps())

    def _is_licensed(self, meaning: Meaning, mentions: Mentions, asides: Sequence[Span]) -> bool:
        features = self.clause_features(mentions, asides)
        if isinstance(meaning, SimpleCommand) and features.main.get("tense", _NOW) - _NOW:
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

    def denies(self, words: Sequence[str]) -> bool:
        """Whether words deny something, limit it by an exception, or say what comes close."""
        return any(self._has(kind, words) for kind in _DENYING)

    def is_apart(self, words: Sequence[str]) -> bool:
        """Whether a sentence takes back or limits nothing that another one says."""
        return not self.limits(words) and _TELLING.isdisjoint(self.reader.of_words(words))

    def frames(self, words: Sequence[str]) -> bool:
        """Whether a sentence makes what follows it doubtful, somebody else's, or a condition."""
        is_doubtful = self._has("doubtful", words) or self._has("condition", words)
        return is_doubtful or not _TELLING.isdisjoint(self.reader.of_words(words))

    def limits(self, words: Sequence[str]) -> bool:
        """Whether words deny or doubt something, or set a condition."""
        return any(self._has(kind, words) for kind in (*_DENYING, "doubtful", "condition"))

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

    def _is_complete(self, meaning: Meaning, tokens: Tokens) -> bool:
        doubled = (n for n, (one, two) in enumerate(pairwise(tokens.words), 1) if one == two)
        is_cut = not isinstance(meaning, Question) and self._is_cut(tokens.words)
        return not is_cut and all(place in tokens.pauses for place in doubled)

    def _is_cut(self, words: Phrase) -> bool:
        last = words[-1:]  # "what you hold it by" is whole
        is_stranded = self.words.has("by", *last) and self._has("relative", words)
        return self.words.has("unfinished", *last) and not is_stranded

    def _keeps_sign(self, meaning: Meaning, mentions: Mentions, asides: Sequence[Span]) -> bool:
        words, is_why = mentions.tokens.words, getattr(meaning, "ask", "why") in {"why", "why_not"}
        if not is_why:
            return True
        own = [span for span in asides if self.is_clause_of_its_own(words[slice(*span)])]
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
        found = [*denied, *(never[:1] if is_told else ())]
        # Negations in several clauses agree, "nobody, I mean nobody"; in one they cancel out.
        by_piece = [sum(start <= n < end for n in found) for start, end in mentions.pieces]
        count = max(by_piece, default=0)
        signs = int(is_negative(meaning))
        named = [m.start for m in mentions.names if m.name in _names_in(meaning)]
        last = next((s for s in mentions.tokens.sentences if s[1] > max(named, default=0)), (0, 0))
        if signs and named and not any(last[0] <= n < last[1] for n in found):
            return False  # "it's not for that. It's for cutting"
        return count == signs or (count == signs + 1 and meanings.only_revises(meaning))

    def _keeps_question(self, meaning: Meaning, mentions: Mentions) -> bool:
        if isinstance(meaning, Question):
            return meaning.ask in _OF_PLACE or not self._has("place_asked", mentions.tokens.words)
        return not mentions.tokens.asks or not isinstance(meaning, Statement)

    def _keeps_recipient(self, meaning: Meaning, mentions: Mentions) -> bool:
        if isinstance(meaning, SimpleCommand) and self._is_to_others(meaning, mentions):
            return False
        if not isinstance(meaning, Command) or not self._has("recipient", mentions.tokens.words):
            return True
        return meaning.recipient in mentions.by_role.get("person", {})

    def _is_to_others(self, meaning: SimpleCommand, mentions: Mentions) -> bool:
        """Whether an utterance begins with the name of somebody else: "Anna, pass me the mug"."""
        names = [m for m in mentions.names if m.start == 0 and m.is_unknown]
        things = {str(leaf) for key, leaf in leaves(meaning.as_json()) if key != "recipient"}
        return 1 in mentions.tokens.pauses and any(m.name not in things for m in names)

    def _keeps_scope(self, meaning: Meaning, mentions: Mentions) -> bool:
        rules = meaning.rules if isinstance(meaning, Statement) else ()
        denied = {_said_of(rule) for rule in rules if rule.denies}
        named = [m for m in mentions.names if m.name in set(map(_said_of, rules))]
        places = list(self._places("negative", mentions.tokens.words))
        if len(rules) < 2:  # "grab it by the rim and never grab it by the rim"
            said = [m.start for m in named]
            return not denied or not said or not min(said) < min(places, default=0) < max(said)
        after = (next((m.name for m in named if m.start > place), None) for place in places)
        return denied.issuperset(filter(None, after))

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
        if isinstance(meaning, meanings.NormStatement):
            said -= {(1.0, 1.0)}  # "you are always allowed to"
        return all(is_negative(meaning) and upper < meanings.LIKELY for _, upper in said)

    def _is_meant(self, meaning: Meaning, mentions: Mentions) -> bool:
        """Whether no word puts it in doubt or somewhere else."""
        if isinstance(meaning, Question):
            return True
        usual: Iterable[int] = ()
        if isinstance(meaning, Statement):
            usual = self._places("usual_place", mentions.tokens.words)
        is_now = isinstance(meaning, SimpleCommand) and not meaning.negated
        is_placed = not is_now and not set(self.spoken("placed", mentions)) <= set(usual)
        return not is_placed and not self.spoken("doubtful", mentions)

    def _keeps_condition(self, meaning: Meaning, mentions: Mentions) -> bool:
        is_now = isinstance(meaning, SimpleCommand) and not meaning.negated
        if isinstance(meaning, SimpleCommand):
            return not self.spoken("supposing" if is_now else "condition", mentions)
        names, is_asked = _names_in(meaning), isinstance(meaning, Question)
        spoken = [each.start for each in mentions.names if each.name in names]
        anything = [each.start for each in mentions.names]  # "if you had to choose" names nothing
        return all(
            any(place < other < end for other in spoken)
            or (is_asked and not any(start <= other < end for other in anything))
            for place in self.spoken("condition", mentions)
            for start, end in mentions.pieces
            if start <= place < end
        )

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
