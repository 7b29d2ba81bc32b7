"""Rules as lines of N-Quads, written from what many of them share.

What rules have in common (`RuleTemplate`) and what they are about (`FeatureLines`) is worked out
and checked once; each further rule costs its name, its interval and the joining of its lines. The
statements are those of `rule_mapping.rule_quads`; a test compares them.

`FastRuleReader` does the same for the rules of a file. Most large files are exports, in which every
rule stands as Hilt writes it. A rule that stands there in another form, or breaks a law, is left to
`rule_mapping.read_rule`, which also says what is wrong.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime
from decimal import Decimal
from functools import lru_cache
from typing import NamedTuple, TypeAlias, cast

from ...ontology.errors import HiltError, IntervalError, ValidationError
from ...ontology.vocabulary import PREFIXES, Iri, split
from ..history import ASSERTS, HISTORY
from ..interval import DIGITS, Interval
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS, DERIVED_FROM, FEATURE, GENERATED_AT, LOWER, RULE, UPPER
from ..rdf.terms import DECIMAL, Quad, Term, as_sparql
from ..rule import Atom, Rule, Status, atoms_text, id_from_content
from .nquads_reader import MAX_KNOWN, RuleBlock, make_room, remember

Pair: TypeAlias = "tuple[Iri, Term]"  # a predicate and an object

_MAX_HELD = 2**20  # characters that are passed on at once
_MAX_REPEATED = 4  # characters of a bound that is likely to come again: 0.95
_RULES, _UTTERANCES = PREFIXES["rule"], PREFIXES["utterance"]
_END, _HISTORY_END = (f" {as_sparql(graph)} .\n" for graph in (BELIEFS, HISTORY))
_LOWER, _UPPER, _TIME, _RULE, _ASSERTS = (
    f" {as_sparql(key)} " for key in (LOWER, UPPER, GENERATED_AT, RULE, ASSERTS)
)
_BOUND_END = f'"^^<{DECIMAL}>{_END}'
_BOUND = re.compile(
    f"({as_sparql(LOWER)}|{as_sparql(UPPER)}) "
    rf'"([01](?:\.[0-9]{{1,{DIGITS}}})?)"\^\^<{DECIMAL}>(?: {as_sparql(BELIEFS)})? \.'
)
_OWN = (FEATURE, LOWER, UPPER, DERIVED_FROM, GENERATED_AT)  # not of the template
_SHARED = "shared"  # stands for all other predicates
_ANY = Atom("object", "any")  # stands for the features of a rule
_TRUE = Interval(1.0, 1.0)  # of a rule that asserts, so that it has edges


class RuleTemplate(NamedTuple):
    """What rules share that differ in their features, bounds, source and time.

    Attributes:
        rule: one of them, about any object.
        contexts: as they stand in the content that gives a rule its name.
        conclusion: likewise.
        ends: the lines of a rule without their subject.
        node: the action-tree node, as it is written.
        edge: the line of a plain edge without its subject; empty where there is none.
        labels: the lines that type and name what the rules speak of.
    """

    rule: Rule
    contexts: str
    conclusion: str
    ends: tuple[str, ...]
    node: str
    edge: str
    labels: str


class FeatureLines(NamedTuple):
    """The features of a rule as text.

    They are `spelled` as in the content that gives a rule its name; `ends` are their lines without
    the subject, `nodes` their IRIs, and `labels` the lines that type and name them.
    """

    atoms: frozenset[Atom]
    spelled: str
    ends: tuple[str, ...]
    nodes: tuple[str, ...]
    labels: str


class SerializedRule(NamedTuple):
    """A rule as text.

    Attributes:
        number: its id as a number.
        utterance: number of the utterance in the file that it comes from; None without one.
        time: when it was first believed; None where nothing is said.
        lower: its belief, in [0, 1], with all digits.
        upper: its plausibility.
        asserts: whether it speaks for its conclusion.
        lines: its own statements but for its source.
        template: what it shares with others.
        features: what it is about.
    """

    number: int
    utterance: int | None
    time: datetime | None
    lower: str
    upper: str
    asserts: bool
    lines: str
    template: RuleTemplate
    features: FeatureLines

    @property
    def rule(self) -> Rule:
        """The rule as a value."""
        one, interval = self.template.rule, Interval(float(self.lower), float(self.upper))
        return Rule(
            *(self.features.atoms, one.contexts, one.functor, one.argument, interval),
            *(one.speaker, self.utterance, self.time, one.status),
        )


class RuleSerializer:
    """Makes text of rules."""

    def __init__(self) -> None:
        self.features = lru_cache(MAX_KNOWN)(_feature_lines)
        self._template = lru_cache(MAX_KNOWN)(_template)
        self._time_line = lru_cache(MAX_KNOWN)(_time_line)

    def serialize(self, rule: Rule) -> SerializedRule:
        """Return a rule as text."""
        interval = rule.interval
        return self.assemble(
            *(self.template(rule), self.features(rule.features)),
            *(f"{interval.lower:.{DIGITS}f}", f"{interval.upper:.{DIGITS}f}"),
            time=rule.time,
            utterance=rule.utterance,
        )

    def assemble(
        self,
        template: RuleTemplate,
        features: FeatureLines,
        lower: str,
        upper: str,
        *,
        time: datetime | None = None,
        utterance: int | None = None,
    ) -> SerializedRule:
        """Return a rule of its parts; the bounds have all their fractional digits.

        Raises:
            ValidationError: it has neither features nor contexts.
            IntervalError: its bounds are no interval.
        """
        belief, plausibility = float(lower), float(upper)
        if not 0.0 <= belief <= plausibility <= 1.0:
            raise IntervalError(belief, plausibility)
        rule, contexts, conclusion, ends, *_ = template
        if not (features.atoms or rule.contexts):
            raise ValidationError(["A rule needs at least one feature or context."])
        name = id_from_content(
            *(rule.speaker, features.spelled, contexts, conclusion, f"{lower} {upper}")
        ).removeprefix("rule/")
        lines = (
            *("", *ends, *features.ends, *(self._time_line(time) if time else ())),
            f'{_LOWER}"{lower}{_BOUND_END}',
            f'{_UPPER}"{upper}{_BOUND_END}',
        )
        return SerializedRule(
            *(int(name, 16), utterance, time, lower, upper),
            round(belief + plausibility, DIGITS) > 1.0,
            *(f"<{_RULES}{name}>".join(lines), template, features),
        )

    def template(self, rule: Rule) -> RuleTemplate:
        """Return what a rule shares with others."""
        return self._template(rule.contexts, rule.functor, rule.argument, rule.speaker, rule.status)


class FastRuleReader:
    """Reads the rules of a file that stand there as Hilt writes them."""

    def __init__(self) -> None:
        self._serializer = RuleSerializer()
        self._templates: dict[tuple[str, ...], RuleTemplate] = {}
        self._features: dict[tuple[str, ...], FeatureLines] = {}
        self._known: dict[str, tuple[str, Term]] = {}

    def read(self, block: RuleBlock) -> SerializedRule | None:
        """Return the rule of a block; None where it has to be read in full."""
        try:
            rule = self._read(block)
        except (HiltError, KeyError, ValueError):
            return None
        return rule if f"{block.node}" == f"{_RULES}{rule.number:016x}" else None

    def _read(self, block: RuleBlock) -> SerializedRule:
        shared, features, own = list[str](), list[str](), dict[str, Term]()
        known = self._known
        for tail in block.tails:
            key, value = known.get(tail) or self._read_line(tail, block)
            if key is _SHARED:
                shared.append(tail)
            elif key is FEATURE:
                features.append(tail)
            elif key in own:
                raise ValueError(tail)
            else:
                own[key] = value
        return self._serializer.assemble(
            *(self._template(tuple(shared), block), self._feature_lines(tuple(features), block)),
            *(cast(str, own[LOWER]), cast(str, own[UPPER])),
            time=cast("datetime | None", own.get(GENERATED_AT)),
            utterance=cast("int | None", own.get(DERIVED_FROM)),
        )

    def _read_line(self, tail: str, block: RuleBlock) -> tuple[str, Term]:
        """The predicate of a line, and its object as far as it is needed."""
        if bound := _BOUND.fullmatch(tail):
            key = LOWER if bound[1] == f"<{LOWER}>" else UPPER
            found = key, f"{float(bound[2]):.{DIGITS}f}"
            if len(bound[2]) > _MAX_REPEATED:
                return found
        else:
            found = _own_or_shared(block.quad(tail))
        return remember(self._known, tail, found)

    def _template(self, tails: tuple[str, ...], block: RuleBlock) -> RuleTemplate:
        known = self._templates.get(tails)
        if known is None:
            pairs = [block.quad(tail)[1:3] for tail in tails]
            own = ((FEATURE, rule_mapping.atom_iri(_ANY)), (LOWER, Decimal(1)), (UPPER, Decimal(1)))
            rule = rule_mapping.read_rule([*pairs, *own])
            written = [q for q in rule_mapping.property_quads(rule) if q.predicate not in _OWN]
            _check_equal(pairs, written)
            known = remember(self._templates, tails, self._serializer.template(rule))
        return known

    def _feature_lines(self, tails: tuple[str, ...], block: RuleBlock) -> FeatureLines:
        known = self._features.get(tails)
        if known is None:
            pairs = [block.quad(tail)[1:3] for tail in tails]
            atoms = {
                rule_mapping.atom_from_iri(value) for _, value in pairs if isinstance(value, Iri)
            }
            _check_equal(
                pairs, [Quad(Iri(""), FEATURE, rule_mapping.atom_iri(atom)) for atom in atoms]
            )
            known = remember(self._features, tails, self._serializer.features(frozenset(atoms)))
        return known


class NQuadsWriter:
    """Writes rules and other statements as N-Quads; edges and labels come at least once."""

    def __init__(self) -> None:
        self._edges: set[tuple[str, str]] = set()
        self._labelled: set[str] = set()
        self._name = lru_cache(MAX_KNOWN)(as_sparql)
        self._held: list[str] = []
        self._size = 0

    def write_rule(self, rule: SerializedRule) -> None:
        """Write all statements of a rule but for its source."""
        template, features, lines = rule.template, rule.features, rule.lines
        if template.rule.status == "active":
            lines += f"{template.node}{_RULE}<{_RULES}{rule.number:016x}>{_END}"
            if rule.asserts and template.edge and self._is_first(features.spelled, template.edge):
                lines += "".join([node + template.edge for node in features.nodes])
        if features.labels not in self._labelled or template.labels not in self._labelled:
            make_room(self._labelled)
            self._labelled.update((features.labels, template.labels))
            lines += features.labels + template.labels
        self._write(lines)

    def write_property(self, numbers: Iterable[int], key: Iri, value: Term) -> None:
        """Write a property that rules have in common, given the numbers of the rules."""
        end = f"> {as_sparql(key)} {as_sparql(value)}{_END}"
        self._write("".join([f"<{_RULES}{number:016x}{end}" for number in numbers]))

    def write_assertions(self, utterance: int, numbers: Iterable[int]) -> None:
        """Write which rules an utterance asserts."""
        start = f"<{_UTTERANCES}{utterance}>{_ASSERTS}<{_RULES}"
        self._write("".join([f"{start}{number:016x}>{_HISTORY_END}" for number in numbers]))

    def write_quads(self, quads: Iterable[Quad]) -> None:
        """Write other statements."""
        for subject, key, value, graph in quads:
            end = self._name(value) if isinstance(value, Iri) else as_sparql(value)
            self._write(
                f"{self._name(subject)} {self._name(key)} {end} {self._name(graph or BELIEFS)} .\n"
            )

    def taken(self, least: int = _MAX_HELD) -> Iterator[bytes]:
        """Give what was written since the last time, when it has at least so many characters."""
        if self._size >= least:
            yield "".join(self._held).encode()
            self._held.clear()
            self._size = 0

    def _is_first(self, features: str, edge: str) -> bool:
        if (features, edge) in self._edges:
            return False
        make_room(self._edges)
        self._edges.add((features, edge))
        return True

    def _write(self, text: str) -> None:
        self._held.append(text)
        self._size += len(text)


def _template(
    contexts: frozenset[Atom], functor: str, argument: Atom | None, speaker: str, status: Status
) -> RuleTemplate:
    one = Rule(*(frozenset([_ANY]), contexts, functor, argument, _TRUE, speaker), status=status)
    edges = rule_mapping.plain_edges(one)
    atoms = one.contexts | ({one.argument} if one.argument else frozenset())
    return RuleTemplate(
        *(one, atoms_text(one.contexts), one.conclusion),
        tuple(_end(q) for q in rule_mapping.property_quads(one) if q.predicate not in _OWN),
        as_sparql(rule_mapping.node_edge(one).subject),
        _end(edges[0]) if edges else "",
        _lines([*rule_mapping.atom_label_quads(atoms), *rule_mapping.node_label_quads(one)]),
    )


def _time_line(time: datetime) -> tuple[str, ...]:
    return (f"{_TIME}{as_sparql(time)}{_END}",)


def _feature_lines(atoms: frozenset[Atom]) -> FeatureLines:
    nodes = tuple(as_sparql(rule_mapping.atom_iri(atom)) for atom in sorted(atoms))
    ends = tuple(f" {as_sparql(FEATURE)} {node}{_END}" for node in nodes)
    return FeatureLines(
        atoms, atoms_text(atoms), ends, nodes, _lines(rule_mapping.atom_label_quads(atoms))
    )


def _end(quad: Quad) -> str:
    """The line of a statement without its subject."""
    return f" {as_sparql(quad.predicate)} {as_sparql(quad.object)}{_END}"


def _lines(quads: Iterable[Quad]) -> str:
    return "".join([as_sparql(quad.subject) + _end(quad) for quad in quads])


def _own_or_shared(quad: Quad) -> tuple[str, Term]:
    """The predicate of a statement where it is a rule's own, and its object."""
    _, key, value, graph = quad
    if graph != BELIEFS or key in {LOWER, UPPER}:  # a bound, and not as Hilt writes it
        raise ValueError(quad)
    if key == DERIVED_FROM:
        return DERIVED_FROM, _utterance(value)
    if key == GENERATED_AT and not isinstance(value, datetime):
        raise ValueError(quad)
    return next((own for own in _OWN if own == key), _SHARED), value


def _check_equal(pairs: Sequence[Pair], written: Sequence[Quad]) -> None:
    """Refuse statements that differ from what Hilt writes."""
    if sorted(pairs, key=str) != sorted(((q.predicate, q.object) for q in written), key=str):
        raise ValueError(pairs)


def _utterance(node: Term) -> int:
    kind, name = split(node) if isinstance(node, Iri) else ("", "")
    if kind != "utterance" or not name.isdecimal():
        raise ValueError(node)
    return int(name)
