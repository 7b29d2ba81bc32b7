"""The rule changes of each utterance, and the difference between two bases."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ..ontology.errors import NotFoundError, ValidationError
from ..ontology.vocabulary import Iri
from .history import HISTORY, IMPORT, KIND, Utterance, utterance_iri
from .interval import Interval
from .learned import LearnedWord
from .rdf import rule_mapping
from .reader import RuleReader
from .rule import Atom, Rule

_RULE_NAME = re.compile(r"(?:rule[/:])?([0-9a-f]{4,16})")
_TOO_SHORT = re.compile(r"(?:rule[/:])?[0-9a-f]{0,3}")  # could be the number of an utterance


@dataclass(frozen=True)
class UtteranceChanges:
    """An utterance with the rules that it changed, as they are now."""

    utterance: Utterance
    told: tuple[Rule, ...]
    retracted: tuple[Rule, ...]
    superseded: tuple[Rule, ...]

    def as_json(self) -> dict[str, object]:
        """One line of `hilt watch --json`."""
        rules = {name: getattr(self, name) for name in ("told", "retracted", "superseded")}
        listed = {name: [rule.as_json() for rule in some] for name, some in rules.items()}
        return {**self.utterance.as_json(), "rules": listed}


@dataclass(frozen=True)
class AlteredRule:
    """A rule of a speaker before and after its interval or status changed."""

    before: Rule
    after: Rule

    def as_json(self) -> dict[str, object]:
        """Both versions, with their status."""
        versions = {"before": self.before, "after": self.after}
        return {key: {**rule.as_json(), "status": rule.status} for key, rule in versions.items()}


@dataclass(frozen=True)
class BaseDifference:
    """The difference between the active rules, trust and words of two bases.

    Attributes:
        removed, added: rules that are active in the first only, in the second only.
        altered: rules that both have, with another interval or status.
        trust: speaker, trust in the first, trust in the second; None where it is not set.
        words_removed, words_added: learned words that only one of them has.
    """

    removed: tuple[Rule, ...]
    added: tuple[Rule, ...]
    altered: tuple[AlteredRule, ...]
    trust: tuple[tuple[str, Interval | None, Interval | None], ...]
    words_removed: tuple[LearnedWord, ...]
    words_added: tuple[LearnedWord, ...]

    @property
    def is_empty(self) -> bool:
        """Whether the bases agree."""
        return not any(vars(self).values())

    def as_json(self) -> dict[str, object]:
        """The document of `hilt diff --json`."""
        found: dict[str, object] = {
            name: [each.as_json() for each in getattr(self, name)]
            for name in ("removed", "added", "altered", "words_removed", "words_added")
        }
        found["trust"] = [
            {"speaker": who, "before": _bounds(before), "after": _bounds(after)}
            for who, before, after in self.trust
        ]
        return found


def rule_changes(
    base: RuleReader, *, since: int = 0, speaker: str | None = None, object: str | None = None
) -> Iterator[UtteranceChanges]:
    """The utterances after a number, with the rules that each changed.

    Only those of a speaker, and those that changed a rule about an object, where these are given.
    """
    for utterance in base.history(since=since):
        if speaker is not None and utterance.speaker.casefold() != speaker.casefold():
            continue
        changed = (utterance.asserts, utterance.retracts, utterance.supersedes)
        told, retracted, superseded = (tuple(map(base.rule, ids)) for ids in changed)
        touched = (rule.features for rule in told + retracted + superseded)
        if object is None or any(Atom("object", object) in features for features in touched):
            yield UtteranceChanges(utterance, told, retracted, superseded)


def compare_bases(before: RuleReader, after: RuleReader) -> BaseDifference:
    """The difference between what two bases hold now, whatever their histories."""
    active = [(rule_mapping.STATUS, rule_mapping.status_iri("active"))]
    left, right = before.nodes_with(active), after.nodes_with(active)
    removed, added = _read(before, left - right), _read(after, right - left)
    # Rules that the other base has with another status.
    altered = [AlteredRule(rule, other) for rule in removed for other in _known(after, rule)]
    altered += [AlteredRule(other, rule) for rule in added for other in _known(before, rule)]
    altered += _with_other_interval(_without(removed, altered), _without(added, altered))
    words_removed = _words_only_in(before, after)
    words_added = _words_only_in(after, before)
    removed, added = _without(removed, altered), _without(added, altered)
    trust = tuple(_trust(before, after))
    return BaseDifference(removed, added, tuple(altered), trust, words_removed, words_added)


def find_rule(base: RuleReader, name: str) -> Rule:
    """The rule that a person names: by its id, or by the first digits of it.

    There may be none (UnknownNameError) or several (ValidationError).
    """
    if _TOO_SHORT.fullmatch(name):
        raise ValidationError([f'"{name}" is too short for a rule: expected 4 digits of its id.'])
    digits = _RULE_NAME.fullmatch(name)
    if digits is None or len(digits[1]) == len("0123456789abcdef"):
        return base.rule(f"rule/{digits[1]}" if digits else name)
    start = rule_mapping.rule_iri(f"rule/{digits[1]}")
    found = [node for node in base.nodes_with([]) if node.startswith(start)]
    if not found:
        return base.rule(f"rule/{digits[1]}")  # which says what there is
    if len(found) > 1:
        listed = ", ".join(sorted(map(rule_mapping.rule_id, found)))
        raise ValidationError([f'"{name}" names several rules: {listed}.'])
    return base.rule(rule_mapping.rule_id(found[0]))


def last_taught_rules(base: RuleReader, speaker: str) -> list[Rule]:
    """The rules of the last utterance of a speaker that asserted a rule which is still active.

    An UnknownNameError lists other speakers when this one has no active rule.
    """
    others = set[str]()
    for number in range(base.sequence, 0, -1):
        kinds = base.store.quads(utterance_iri(number), KIND, None, HISTORY)
        if all(quad.object == IMPORT for quad in kinds):  # a file; it may assert very many rules
            continue
        utterance = base.utterance(number)
        rules = [base.rule(one) for one in utterance.asserts]
        active = [
            rule
            for rule in rules
            if rule.status == "active" and rule.utterance == utterance.sequence
        ]
        if found := [rule for rule in active if rule.speaker == speaker]:
            return found
        others |= {rule.speaker for rule in active}
    raise NotFoundError("sentence with a rule that holds by", speaker, others)


def _read(base: RuleReader, nodes: set[Iri]) -> list[Rule]:
    return sorted(base.read_rules((node, base.properties(node)) for node in nodes), key=_content)


def _known(base: RuleReader, rule: Rule) -> list[Rule]:
    node = rule_mapping.rule_iri(rule.id)
    return base.read_rules([(node, found)]) if (found := base.properties(node)) else []


def _with_other_interval(removed: Iterable[Rule], added: Iterable[Rule]) -> list[AlteredRule]:
    free = {_content(rule): rule for rule in removed}
    pairs = [(free.pop(_content(rule), None), rule) for rule in added]
    return [AlteredRule(before, after) for before, after in pairs if before]


def _content(rule: Rule) -> tuple[str, ...]:
    left = (" ".join(sorted(map(str, atoms))) for atoms in (rule.features, rule.contexts))
    return (*left, rule.functor, str(rule.argument), rule.speaker)


def _without(rules: Iterable[Rule], altered: list[AlteredRule]) -> tuple[Rule, ...]:
    gone = {rule.id for each in altered for rule in (each.before, each.after)}
    return tuple(rule for rule in rules if rule.id not in gone)


def _words_only_in(base: RuleReader, other: RuleReader) -> tuple[LearnedWord, ...]:
    known = {(word.atom, word.speaker) for word in other.words()}
    return tuple(word for word in base.words() if (word.atom, word.speaker) not in known)


def _trust(
    before: RuleReader, after: RuleReader
) -> Iterator[tuple[str, Interval | None, Interval | None]]:
    for speaker in sorted({*before.speakers(), *after.speakers()}):
        one, other = before.trust(speaker), after.trust(speaker)
        if one != other:
            yield speaker, one, other


def _bounds(interval: Interval | None) -> list[float] | None:
    return [interval.lower, interval.upper] if interval else None
