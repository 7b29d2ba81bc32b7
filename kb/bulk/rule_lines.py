# SPDX-License-Identifier: Apache-2.0
"""Rules as lines of N-Quads, stamped out of what many of them share: for millions of rules.

What rules have in common (`RuleTemplate`), and what they are about (`FeatureLines`), is worked out
and checked once; of each rule, only its interval, its name and the joining of its lines are left.
The statements are exactly those of `rule_mapping.statements`; a test compares them.
"""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from typing import Any, NamedTuple

from ...ontology.errors import IntervalError, ValidationError
from ...ontology.vocabulary import PREFIXES
from ..interval import DIGITS, Interval
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import DECIMAL, Quad, as_sparql
from ..rule import Atom, Rule, Status, atoms_text, id_from_content

MAX_KNOWN = 100_000  # of each kind that are remembered
_RULES = PREFIXES["rule"]
_END = f" {as_sparql(BELIEFS)} .\n"
_LOWER, _UPPER, _TIME, _RULE = (
    f" {as_sparql(key)} "
    for key in (
        rule_mapping.LOWER,
        rule_mapping.UPPER,
        rule_mapping.GENERATED_AT,
        rule_mapping.RULE,
    )
)
_BOUND_END = f'"^^<{DECIMAL}>{_END}'
# What a rule does not share with those of its frame.
OWN = frozenset(
    (
        rule_mapping.FEATURE,
        rule_mapping.LOWER,
        rule_mapping.UPPER,
        rule_mapping.DERIVED_FROM,
        rule_mapping.GENERATED_AT,
    )
)
_MORE_OF_IT = Interval(1.0, 1.0)  # it asserts, so that its edge is found
_ANY = frozenset([Atom("object", "any")])  # stands for what is seen


class RuleTemplate(NamedTuple):
    """What rules share that differ in their features, bounds, source and time.

    Attributes:
        rule: one of them, about any object.
        contexts: as they stand in the content that gives a rule its name.
        conclusion: likewise.
        ends: of its lines, behind the name of the rule.
        node: how the action-tree node is written.
        edge: how a plain edge goes on behind its feature; empty where there is none.
        mentions: the lines that name what it speaks of.
    """

    rule: Rule
    contexts: str
    conclusion: str
    ends: tuple[str, ...]
    node: str
    edge: str
    mentions: str


class FeatureLines(NamedTuple):
    """The features of a rule.

    Attributes:
        atoms: they.
        spelled: as they stand in the content that gives a rule its name.
        ends: of their lines, behind the name of the rule.
        nodes: how they are written.
        mentions: the lines that name them.
    """

    atoms: frozenset[Atom]
    spelled: str
    ends: tuple[str, ...]
    nodes: tuple[str, ...]
    mentions: str


class SerializedRule(NamedTuple):
    """A rule as text.

    Attributes:
        number: that its name is made of.
        utterance: number of the utterance in the file that it comes from; None without one.
        time: when it was first believed; None where nothing is said.
        lower: its belief, in [0, 1], as it is written.
        upper: its plausibility.
        asserts: whether it speaks for its conclusion.
        lines: its statements but for that of its source.
        frame: what it shares with others.
        seen: its features.
    """

    number: int
    utterance: int | None
    time: datetime | None
    lower: str
    upper: str
    asserts: bool
    lines: str
    frame: RuleTemplate
    seen: FeatureLines

    @property
    def id(self) -> str:
        """Its name."""
        return f"rule/{self.number:016x}"

    @property
    def speaker(self) -> str:
        """Who told it."""
        return self.frame.rule.speaker

    @property
    def status(self) -> Status:
        """Whether it is believed."""
        return self.frame.rule.status

    @property
    def rule(self) -> Rule:
        """It as a rule."""
        one, interval = self.frame.rule, Interval(float(self.lower), float(self.upper))
        return Rule(
            *(self.seen.atoms, one.contexts, one.functor, one.argument, interval, one.speaker),
            *(self.utterance, self.time, one.status),
        )


class RuleSerializer:
    """Makes rules into text."""

    def __init__(self) -> None:
        self._frames: dict[object, RuleTemplate] = {}
        self._seen: dict[frozenset[Atom], FeatureLines] = {}
        self._times: dict[datetime, tuple[str, ...]] = {}

    def of(self, rule: Rule) -> SerializedRule:
        """A rule as text."""
        interval = rule.interval
        return self.star(
            *(self.frame(rule), self.seen(rule.features)),
            *(f"{interval.lower:.{DIGITS}f}", f"{interval.upper:.{DIGITS}f}"),
            time=rule.time,
            utterance=rule.utterance,
        )

    def star(
        self,
        frame: RuleTemplate,
        seen: FeatureLines,
        lower: str,
        upper: str,
        *,
        time: datetime | None = None,
        utterance: int | None = None,
    ) -> SerializedRule:
        """A rule of what it is made of; its bounds with all their fractional digits.

        Raises:
            ValidationError: it speaks of nothing.
            IntervalError: its bounds are no interval.
        """
        belief, plausibility = float(lower), float(upper)
        if not 0.0 <= belief <= plausibility <= 1.0:
            raise IntervalError(belief, plausibility)
        rule, _, conclusion, ends, *_ = frame
        if not (seen.atoms or rule.contexts):
            raise ValidationError(["A rule needs at least one feature or context."])
        name = id_from_content(
            *(rule.speaker, seen.spelled, frame.contexts, conclusion, f"{lower} {upper}")
        ).removeprefix("rule/")
        said = (
            *("", *ends, *seen.ends, *(self._since(time) if time else ())),
            f'{_LOWER}"{lower}{_BOUND_END}',
            f'{_UPPER}"{upper}{_BOUND_END}',
        )
        return SerializedRule(
            *(int(name, 16), utterance, time, lower, upper),
            round(belief + plausibility, DIGITS) > 1.0,
            *(f"<{_RULES}{name}>".join(said), frame, seen),
        )

    def frame(self, rule: Rule) -> RuleTemplate:
        """What a rule shares with others."""
        key = (rule.contexts, rule.functor, rule.argument, rule.speaker, rule.status)
        known = self._frames.get(key)
        if known is None:
            make_room(self._frames)
            known = self._frames[key] = frame_of(rule)
        return known

    def seen(self, atoms: frozenset[Atom]) -> FeatureLines:
        """Features as text."""
        known = self._seen.get(atoms)
        if known is None:
            make_room(self._seen)
            known = self._seen[atoms] = seen_of(atoms)
        return known

    def _since(self, time: datetime) -> tuple[str, ...]:
        """The end of the line that says when a rule was first believed."""
        known = self._times.get(time)
        if known is None:
            make_room(self._times)
            known = self._times[time] = (f"{_TIME}{as_sparql(time)}{_END}",)
        return known


class Printer:
    """Writes stars with all that stands in the graph because of them."""

    def __init__(self) -> None:
        self._edges: set[tuple[str, str]] = set()
        self._mentioned: set[str] = set()

    def lines(self, star: SerializedRule) -> str:
        """All lines of a rule but that of its utterance; names and edges come once at least."""
        frame, seen, said = star.frame, star.seen, star.lines
        if frame.rule.status == "active":
            said += f"{frame.node}{_RULE}<{_RULES}{star.number:016x}>{_END}"
            if star.asserts and frame.edge and self._is_first(seen.spelled, frame.edge):
                said += "".join([node + frame.edge for node in seen.nodes])
        if seen.mentions not in self._mentioned or frame.mentions not in self._mentioned:
            make_room(self._mentioned)
            self._mentioned.update((seen.mentions, frame.mentions))
            said += seen.mentions + frame.mentions
        return said

    def _is_first(self, seen: str, edge: str) -> bool:
        if (seen, edge) in self._edges:
            return False
        make_room(self._edges)
        self._edges.add((seen, edge))
        return True


def frame_of(rule: Rule) -> RuleTemplate:
    """What a rule shares with others."""
    one = Rule(
        *(_ANY, rule.contexts, rule.functor, rule.argument, _MORE_OF_IT, rule.speaker),
        status=rule.status,
    )
    edges = rule_mapping.plain_edges(one)
    named = one.contexts | ({one.argument} if one.argument else frozenset())
    return RuleTemplate(
        *(one, atoms_text(one.contexts), one.conclusion),
        tuple(end(quad) for quad in rule_mapping.property_quads(one) if quad.predicate not in OWN),
        as_sparql(rule_mapping.node_edge(one).subject),
        end(edges[0]) if edges else "",
        _lines([*rule_mapping.atom_label_quads(named), *rule_mapping.node_label_quads(one)]),
    )


def seen_of(atoms: frozenset[Atom]) -> FeatureLines:
    """Features as text."""
    nodes = tuple(as_sparql(rule_mapping.atom_iri(atom)) for atom in sorted(atoms))
    ends = tuple(f" {as_sparql(rule_mapping.FEATURE)} {node}{_END}" for node in nodes)
    return FeatureLines(
        atoms, atoms_text(atoms), ends, nodes, _lines(rule_mapping.atom_label_quads(atoms))
    )


def end(quad: Quad) -> str:
    """The line of a statement behind its subject."""
    return f" {as_sparql(quad.predicate)} {as_sparql(quad.object)}{_END}"


def make_room(known: dict[Any, Any] | set[Any]) -> None:
    """Forget all that is remembered, where that is too much."""
    if len(known) >= MAX_KNOWN:
        known.clear()


def _lines(quads: Iterable[Quad]) -> str:
    return "".join([as_sparql(quad.subject) + end(quad) for quad in quads])
