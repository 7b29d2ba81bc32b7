# SPDX-License-Identifier: Apache-2.0
"""Taking over what another base, or a file, knows: whole or not at all, and twice is once.

Rules have their names from their content, so the same rule is recognised. What the base already
knows about a rule (that it was retracted, say) stays. Utterances come after those of the base,
in their order; one that is there already, word for word and to the millisecond, is not repeated.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from ..ontology.vocabulary import Iri, iri
from .episodes import EPISODES
from .history import (
    HISTORY,
    SEQUENCE,
    TEXT,
    Utterance,
    import_utterance,
    utterance_iri,
    utterance_quads,
)
from .interval import Interval
from .knowledge_base import KnowledgeBase
from .learned_words import LEXICON
from .rdf import rule_mapping
from .rdf.domain import DOMAIN, DOMAIN_HASH
from .rdf.rule_mapping import BELIEFS
from .rdf.terms import Quad
from .reader import BASE_GRAPH, BASE_NODE, RuleReader
from .rule import Rule
from .validation import rule_nodes
from .writer import speaker_quads, to_milliseconds, trust_quads

MAX_LISTED = 20  # contradictions that a summary names


@dataclass(frozen=True)
class Merged:
    """What a merge brought.

    Attributes:
        new: rules that the base did not know.
        known: rules that it knew already.
        utterances: how many of the history were new.
        untrusted: speakers of new rules whom nobody trusts, so that their rules weigh nothing.
        statements: how many were read.
        conflicts: where a new rule contradicts one that the base believes.
    """

    new: tuple[Rule, ...]
    known: tuple[Rule, ...]
    utterances: int
    untrusted: tuple[str, ...]
    statements: int
    conflicts: tuple[MergeConflict, ...] = ()

    @property
    def summary(self) -> Summary:
        """It in numbers."""
        return Summary(
            len(self.new),
            len(self.known),
            len(self.conflicts),
            self.utterances,
            self.untrusted,
            self.conflicts[:MAX_LISTED],
        )


@dataclass(frozen=True)
class MergeConflict:
    """A new rule and a believed one that draw the same conclusion and cannot both be right.

    Attributes:
        new: the rule that came.
        believed: the rule that was there; their intervals have nothing in common.
    """

    new: Rule
    believed: Rule

    def as_json(self) -> dict[str, object]:
        """As `hilt import --json` prints it."""
        return {"new": self.new.as_json(), "believed": self.believed.as_json()}


@dataclass(frozen=True)
class Summary:
    """What came of an import, in numbers.

    Attributes:
        new: rules that the base did not know.
        known: rules that it knew already.
        conflicting: contradictions between a new rule and one that the base believes.
        utterances: how many of the history were new.
        untrusted: speakers of new rules whom nobody trusts, so that their rules weigh nothing.
        conflicts: the first of the contradictions, at most `MAX_LISTED`.
    """

    new: int
    known: int
    conflicting: int
    utterances: int
    untrusted: tuple[str, ...]
    conflicts: tuple[MergeConflict, ...] = ()

    def as_json(self) -> dict[str, object]:
        """As `hilt import --json` prints it."""
        return {
            "new": self.new,
            "known": self.known,
            "conflicting": self.conflicting,
            "utterances": self.utterances,
            "untrusted": list(self.untrusted),
            "conflicts": [conflict.as_json() for conflict in self.conflicts],
        }


@dataclass
class Plan:
    """What is to be written.

    Attributes:
        last: the number of the last utterance there will be.
        insert: statements to add.
        delete: statements to take away first.
        numbers: of the other's utterances, and which number each has here.
        new: rules that the base did not know.
        known: rules that it knew already.
    """

    last: int
    insert: list[Quad] = field(default_factory=list[Quad])
    delete: list[Quad] = field(default_factory=list[Quad])
    numbers: dict[int, int] = field(default_factory=dict[int, int])
    new: list[Rule] = field(default_factory=list[Rule])
    known: list[Rule] = field(default_factory=list[Rule])

    def add(self, utterance: Utterance) -> None:
        """Add one utterance under the number that it has."""
        self.insert += utterance_quads(utterance)
        self.insert += speaker_quads(utterance.speaker, HISTORY)


def merge(base: KnowledgeBase, other: RuleReader, *, source: str, dry_run: bool = False) -> Merged:
    """Take over what another base knows, as one unit.

    Args:
        base: what is written to.
        other: what is read; it must have been validated.
        source: its name, for the history.
        dry_run: only say what would come of it.
    """
    with base.store.writing():
        before = base.sequence
        plan = Plan(before)
        plan_trust(plan, base, other)
        plan_history(plan, base, other)
        _plan_rules(plan, base, other, source)
        plan_rest(plan, base, other)
        if plan.last > before:
            plan.delete += base.store.quads(BASE_NODE, SEQUENCE, None, BASE_GRAPH)
            plan.insert.append(Quad(BASE_NODE, SEQUENCE, plan.last, BASE_GRAPH))
        found = tuple(conflicts(base.reader, plan.new))
        if not dry_run:
            base.store.apply(insert=plan.insert, delete=plan.delete)
    trusted = {*base.speakers(), *other.speakers()}
    return Merged(
        tuple(plan.new),
        tuple(plan.known),
        len({new for new in plan.numbers.values() if new > before}),
        tuple(sorted({rule.speaker for rule in plan.new} - trusted)),
        sum(1 for _ in other.store.quads()),
        found,
    )


def conflicts(base: RuleReader, rules: Iterable[Rule]) -> Iterator[MergeConflict]:
    """Where rules contradict what a base believes: same premises and conclusion, other interval.

    Args:
        base: what is believed.
        rules: what is new to it.
    """
    by_node: dict[str, list[Rule]] = defaultdict(list)
    for rule in rules:
        if rule.status == "active":
            by_node[rule.node].append(rule)
    for node in sorted(by_node):
        believed: dict[object, list[Rule]] = defaultdict(list)
        for rule in base.rules_at_nodes([node]):
            believed[claim(rule)].append(rule)
        for rule in by_node[node]:
            for other in believed.get(claim(rule), ()):
                if rule.id != other.id and are_apart(rule.interval, other.interval):
                    yield MergeConflict(rule, other)


def claim(rule: Rule) -> tuple[object, ...]:
    """What a rule claims, apart from how sure it is and who says it."""
    return (rule.features, rule.contexts, rule.functor, rule.argument)


def are_apart(one: Interval, other: Interval) -> bool:
    """Whether two intervals have nothing in common."""
    return one.lower > other.upper or one.upper < other.lower


def plan_trust(plan: Plan, base: KnowledgeBase, other: RuleReader) -> None:
    """Adopt trust in whom the base says nothing about; a base just made adopts all."""
    is_fresh = base.sequence == 0
    for speaker in other.speakers():
        own, theirs = base.trust(speaker), other.trust(speaker)
        if theirs and theirs != own and (own is None or is_fresh):
            plan.delete += base.store.quads(iri("speaker", speaker), None, None, BELIEFS)
            plan.insert += trust_quads(speaker, theirs)


def plan_history(plan: Plan, base: KnowledgeBase, other: RuleReader) -> None:
    """Add the utterances that the base has not, after its own."""
    for utterance in sorted(_utterances(other), key=lambda one: one.sequence):
        there = _same_utterance(base.reader, utterance)
        if there:
            plan.numbers[utterance.sequence] = there
            continue
        plan.last = max(utterance.sequence, plan.last + 1)
        plan.numbers[utterance.sequence] = plan.last
        plan.add(replace(utterance, sequence=plan.last))


def _plan_rules(plan: Plan, base: KnowledgeBase, other: RuleReader, source: str) -> None:
    nameless: list[Rule] = []
    for node in rule_nodes(other.store):
        rule = other.read_rules([(node, other.properties(node))])[0]
        if base.reader.properties(node):
            plan.known.append(rule)
        elif rule.utterance in plan.numbers:
            plan.new.append(replace(rule, utterance=plan.numbers[rule.utterance]))
        else:
            nameless.append(rule)
    if nameless:
        ids = tuple(sorted(rule.id for rule in nameless))
        plan.last += 1
        utterance = import_utterance(source, plan.last, to_milliseconds(base.clock()), asserts=ids)
        plan.numbers[-1] = utterance.sequence  # it stands for no number of the other's
        plan.add(utterance)
        plan.new += [
            replace(rule, utterance=utterance.sequence, time=rule.time or utterance.time)
            for rule in nameless
        ]
    for rule in plan.new:
        plan.insert += rule_mapping.rule_quads(rule)


def plan_rest(plan: Plan, base: KnowledgeBase, other: RuleReader) -> None:
    """Episodes and words are added; the domain is taken over where the base has none."""
    renumbered = {utterance_iri(old): utterance_iri(new) for old, new in plan.numbers.items()}
    for graph in (EPISODES, LEXICON):
        plan.insert += (
            _renumbered(quad, renumbered) for quad in other.store.quads(None, None, None, graph)
        )
    if not any(base.store.quads(BASE_NODE, DOMAIN_HASH, None, BASE_GRAPH)):
        plan.insert += other.store.quads(None, None, None, DOMAIN)
        plan.insert += other.store.quads(BASE_NODE, DOMAIN_HASH, None, BASE_GRAPH)


def _utterances(other: RuleReader) -> Iterator[Utterance]:
    for quad in other.store.quads(None, SEQUENCE, None, HISTORY):
        if isinstance(quad.object, int):
            yield other.utterance(quad.object)


def _same_utterance(base: RuleReader, utterance: Utterance) -> int | None:
    """The number under which the base has this very utterance."""
    for quad in base.store.quads(None, TEXT, utterance.text, HISTORY):
        for number in base.store.quads(quad.subject, SEQUENCE, None, HISTORY):
            if isinstance(number.object, int):
                there = base.utterance(number.object)
                if replace(there, sequence=utterance.sequence) == utterance:
                    return there.sequence
    return None


def _renumbered(quad: Quad, renumbered: dict[Iri, Iri]) -> Quad:
    if isinstance(quad.object, Iri) and quad.object in renumbered:
        return quad._replace(object=renumbered[quad.object])
    return quad
