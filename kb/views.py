"""Views of the rules: at an earlier time, according to one speaker, as changes, of two bases.

No rule is ever deleted, so the history can be replayed: the utterances until a moment assert,
retract and supersede rules in their order. In the view of one speaker only that speaker's
utterances count, and with full trust.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

from ..ontology.errors import DataError, NotFoundError, ValidationError
from ..ontology.vocabulary import Iri, split
from .history import HISTORY, IMPORT, KIND, Utterance, parse_trust, read_utterance, utterance_iri
from .interval import CERTAIN, Interval
from .learned import LearnedWord
from .rdf import rule_mapping
from .reader import RuleReader, atoms_named
from .rule import DEFAULT_SPEAKER, Atom, Rule
from .stores.base import described_nodes

_DATE = re.compile(r"\d{4}-\d{2}-\d{2}")
_RULE_NAME = re.compile(r"(?:rule[/:])?([0-9a-f]{0,16})")


@dataclass(frozen=True)
class RuleView:
    """The rules of some time or speaker, a source that never changes, in the order last said."""

    all: tuple[Rule, ...]
    sequence: int = 0

    def rules(
        self,
        *,
        object: str | None = None,
        affordance: str | None = None,
        context: str | None = None,
        part: str | None = None,
        speaker: str | None = None,
    ) -> list[Rule]:
        """The rules that match; arguments as for `RuleReader.rules`."""
        features, contexts = {*atoms_named(object=object)}, {*atoms_named(action=context)}
        arguments = {*atoms_named(affordance=affordance, part=part)}
        return [
            rule
            for rule in self.all
            if features <= rule.features
            and contexts <= rule.contexts
            and arguments <= {rule.argument}
            and speaker in (None, rule.speaker)
        ]

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """The rules at action-tree nodes, as `RuleReader.rules_at_nodes` gives them."""
        return sorted((rule for rule in self.all if rule.node in nodes), key=lambda one: one.id)


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
    """The difference between the active rules, trust and words of two bases."""

    #: removed, added: rules that are active in the first only, in the second only
    removed: tuple[Rule, ...]
    added: tuple[Rule, ...]
    altered: tuple[AlteredRule, ...]  #: rules that both have, with another interval or status
    #: speaker, trust in the first, trust in the second; None where it is not set
    trust: tuple[tuple[str, Interval | None, Interval | None], ...]
    #: words_removed, words_added: learned words that only one of them has
    words_removed: tuple[LearnedWord, ...]
    words_added: tuple[LearnedWord, ...]

    @property
    def is_empty(self) -> bool:
        """Whether the bases agree."""
        return not any(vars(self).values())

    def as_json(self) -> dict[str, object]:
        """The document of `hilt diff --json`."""
        names = ("removed", "added", "altered", "words_removed", "words_added")
        found = {name: [each.as_json() for each in getattr(self, name)] for name in names}
        bounds = ((who, was and [*was], now and [*now]) for who, was, now in self.trust)
        keys = ("speaker", "before", "after")
        return {**found, "trust": [dict(zip(keys, one, strict=True)) for one in bounds]}


def view(
    base: RuleReader, *, at: datetime | int | None = None, according_to: str | None = None
) -> RuleView:
    """The rules at an earlier time, or according to one speaker, or both.

    `at` is a moment, or the number of the last utterance that counts; now by default. Only the
    utterances of the speaker `according_to` count; everybody's by default. UnknownNameError if
    there is no such utterance, or no utterance of that speaker.
    """
    nodes = described_nodes(base.store, HISTORY)
    said = (read_utterance(some) for node, some in nodes if split(node)[0] == "utterance")
    events = sorted(said, key=lambda one: (one.time, one.sequence))
    counted = events
    if isinstance(at, int):
        last = max((one.sequence for one in events), default=0)
        if not 0 <= at <= last:
            raise NotFoundError("utterance", str(at), [f"0 to {last}"])
        counted = [one for one in events if one.sequence <= at]
    elif at is not None:
        counted = [one for one in events if one.time <= at]
    speakers = {one.speaker for one in events}
    is_known = according_to in {None, *speakers} or base.rules(speaker=according_to, status=None)
    if according_to and not is_known:
        raise NotFoundError("speaker", according_to, speakers)
    active, finally_active = _replayed(base, counted, according_to), _replayed(base, events, None)
    # A rule that is inactive now although no utterance of this base ended it came with a file or
    # another base, where it was retracted at an unknown time.
    found = [
        replace(rule, utterance=one.sequence, time=one.time, status="active", trust=1.0)
        for rule, one in ((base.rule(name), one) for name, one in active.items())
        if rule.status == "active" or rule.id not in finally_active
    ]
    if according_to is None:
        trust = _trust(base, {rule.speaker for rule in found}, events, counted)
        found = [replace(rule, trust=trust[rule.speaker]) for rule in found]
    return RuleView(tuple(sorted(found, key=lambda rule: (rule.utterance or 0, rule.id))))


def parse_moment(text: str) -> datetime | int:
    """The moment that a text names; DataError if it names none.

    >>> parse_moment("12")
    12
    >>> print(parse_moment("2026-11-21T09:30:00Z"))
    2026-11-21 09:30:00+00:00

    That is the number of an utterance, or an ISO date with or without a time. A date alone is the
    end of that day; a time without a zone is local.
    """
    stripped = text.strip()
    if stripped.isdecimal() and len(stripped) < len("20261121"):
        return int(stripped)
    try:
        moment = datetime.fromisoformat(stripped.replace("Z", "+00:00"))
    except ValueError as error:
        problem = "expected a date, as 2026-11-21 or 2026-11-21T09:30, or the number of an"
        raise DataError(f"{problem} utterance.", source=text) from error
    if _DATE.fullmatch(stripped):
        moment += timedelta(days=1, milliseconds=-1)
    return moment if moment.tzinfo else moment.astimezone()


def rule_changes(
    base: RuleReader, *, since: int = 0, speaker: str | None = None, object: str | None = None
) -> Iterator[UtteranceChanges]:
    """The utterances after a number (of a speaker, about an object), and the rules they changed."""
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
    left, right = (base.nodes_with([rule_mapping.ACTIVE]) for base in (before, after))
    removed, added = _rules_at(before, left - right), _rules_at(after, right - left)
    # Rules that the other base has with another status, and then those with another interval.
    was = {rule.id: rule for rule in _rules_at(before, right - left)}
    now = {rule.id: rule for rule in _rules_at(after, left - right)}
    altered = [AlteredRule(rule, now[rule.id]) for rule in removed if rule.id in now]
    altered += [AlteredRule(was[rule.id], rule) for rule in added if rule.id in was]
    removed = [rule for rule in removed if rule.id not in now]
    added = [rule for rule in added if rule.id not in was]
    free = {_content(rule): rule for rule in removed}
    pairs = [(free.pop(_content(rule), None), rule) for rule in added]
    altered += [AlteredRule(other, rule) for other, rule in pairs if other]
    gone = {rule.id for each in altered for rule in (each.before, each.after)}
    names = sorted({*before.speakers(), *after.speakers()})
    trust = ((name, before.trust(name), after.trust(name)) for name in names)
    return BaseDifference(
        tuple(rule for rule in removed if rule.id not in gone),
        tuple(rule for rule in added if rule.id not in gone),
        tuple(altered),
        tuple(one for one in trust if one[1] != one[2]),
        _words_only_in(before, after),
        _words_only_in(after, before),
    )


def find_rule(base: RuleReader, name: str) -> Rule:
    """The rule with an id, or its first digits; UnknownNameError or ValidationError if not one."""
    if (digits := _RULE_NAME.fullmatch(name)) is None:
        return base.rule(name)  # which says what there is
    if len(digits[1]) < 4:  # could be the number of an utterance
        raise ValidationError([f'"{name}" is too short for a rule: expected 4 digits of its id.'])
    rule_id, found = f"rule/{digits[1]}", list[str]()
    if len(digits[1]) < len("0123456789abcdef"):
        ids = map(rule_mapping.rule_id, base.nodes_with([]))
        found = [one for one in ids if one.startswith(rule_id)]
    if len(found) > 1:
        raise ValidationError([f'"{name}" names several rules: {", ".join(sorted(found))}.'])
    return base.rule(found[0] if found else rule_id)


def last_taught_rules(base: RuleReader, speaker: str) -> list[Rule]:
    """The rules that hold of the last utterance of a speaker with one; else UnknownNameError."""
    others = set[str]()
    for number in range(base.sequence, 0, -1):
        kinds = base.store.quads(utterance_iri(number), KIND, None, HISTORY)
        if all(quad.object == IMPORT for quad in kinds):  # a file; it may assert very many rules
            continue
        told = map(base.rule, base.utterance(number).asserts)
        active = [rule for rule in told if rule.status == "active" and rule.utterance == number]
        if found := [rule for rule in active if rule.speaker == speaker]:
            return found
        others |= {rule.speaker for rule in active}
    raise NotFoundError("sentence with a rule that holds by", speaker, others)


def _replayed(
    base: RuleReader, events: list[Utterance], according_to: str | None
) -> dict[str, Utterance]:
    active: dict[str, Utterance] = {}
    for one in events:
        if according_to is None or one.speaker == according_to:
            for ended in (*one.retracts, *one.supersedes):
                active.pop(ended, None)
        for asserted in one.asserts:
            if according_to is None or base.rule(asserted).speaker == according_to:
                active[asserted] = one
    return active


def _trust(
    base: RuleReader, speakers: set[str], events: list[Utterance], counted: list[Utterance]
) -> dict[str, float]:
    ever, then = (dict(filter(None, map(parse_trust, some))) for some in (events, counted))
    # Before somebody set it, the trust in all but one is 0; where nobody did, it is as now.
    start = {name: CERTAIN if name == DEFAULT_SPEAKER else Interval(0, 0) for name in ever}
    known = {**base.trust_by_speaker(), **start, **then}
    return {name: known[name].lower if name in known else 0.0 for name in speakers}


def _rules_at(base: RuleReader, nodes: Iterable[Iri]) -> list[Rule]:
    found = ((node, some) for node in nodes if (some := base.properties(node)))
    return sorted(base.read_rules(found), key=_content)


def _content(rule: Rule) -> tuple[str, ...]:
    left = (" ".join(sorted(map(str, atoms))) for atoms in (rule.features, rule.contexts))
    return (*left, rule.functor, str(rule.argument), rule.speaker)


def _words_only_in(base: RuleReader, other: RuleReader) -> tuple[LearnedWord, ...]:
    known = {(word.atom, word.speaker) for word in other.words()}
    return tuple(word for word in base.words() if (word.atom, word.speaker) not in known)
