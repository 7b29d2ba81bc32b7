"""Rules as lines of N-Quads, written from what many of them share.

What rules have in common (`SharedLines`) and what they are about (`FeatureLines`) is worked out
once; each further rule costs its name and the joining of its lines. The statements are those of
`rule_mapping.rule_quads`; a test compares them.
"""

from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import NamedTuple

from ...ontology.vocabulary import PREFIXES, Iri
from ..history import ASSERTS, HISTORY
from ..interval import DIGITS, Interval
from ..rdf import rule_mapping
from ..rdf.rule_mapping import ANY, BELIEFS, DERIVED, FEATURE, GENERATED_AT, LOWER, OWN, UPPER
from ..rdf.terms import DECIMAL, Quad, Term, as_sparql
from ..rule import Atom, Rule, Status
from ..stores.base import is_first

_MAX_KNOWN = 2**18  # lines of each kind that are remembered
_MAX_HELD = 2**20  # characters that are passed on at once
_RULES, _UTTERANCES = PREFIXES["rule"], PREFIXES["utterance"]
_END, _HISTORY_END, _DERIVED_END = (f" {as_sparql(g)} .\n" for g in (BELIEFS, HISTORY, DERIVED))
_LOWER, _UPPER, _TIME, _RULE, _ASSERTS = (
    f" {as_sparql(key)} " for key in (LOWER, UPPER, GENERATED_AT, rule_mapping.RULE, ASSERTS)
)
_BOUND_END = f'"^^<{DECIMAL}>{_END}'
_TRUE = Interval(1.0, 1.0)  # of a rule that asserts, so that it has edges


class SharedLines(NamedTuple):
    """The lines of rules that differ in their features, bounds, source and time.

    `ends` are those of a rule and `edges` those of the edges from a single feature, without their
    subject; `relation` are about the relation of these edges. `labels` type and name what the rules
    speak of. `node` is the action-tree node, as it is written.
    """

    ends: tuple[str, ...]
    node: str
    edges: tuple[str, ...]
    labels: str
    relation: str


class FeatureLines(NamedTuple):
    """Lines of features: without the subject, their IRIs, and what types and names them."""

    ends: tuple[str, ...]
    nodes: tuple[str, ...]
    labels: str


class NQuadsWriter:
    """Writes rules and other statements as N-Quads; edges and labels come at least once."""

    def __init__(self) -> None:
        self._edges: set[object] = set()  # features, with lines of edges
        self._labelled: set[object] = set()  # lines
        self._name = lru_cache(_MAX_KNOWN)(as_sparql)
        self._shared = lru_cache(_MAX_KNOWN)(_shared)
        self._feature_lines = lru_cache(_MAX_KNOWN)(_feature_lines)
        self._held: list[str] = []
        self._size = 0

    def write_rule(self, rule: Rule) -> None:
        """Write all statements of a rule but for its source."""
        shared = self._shared(rule.contexts, rule.functor, rule.argument, rule.speaker, rule.status)
        features, node = self._feature_lines(rule.features), f"<{_RULES}{rule.id[5:]}>"
        lines = node.join(
            (
                *("", *shared.ends, *features.ends),
                f'{_LOWER}"{rule.interval.lower:.{DIGITS}f}{_BOUND_END}',
                f'{_UPPER}"{rule.interval.upper:.{DIGITS}f}{_BOUND_END}',
            )
        )
        asserts, relation = rule.asserts, ""
        is_single = len(rule.features) == 1  # several are conditions of each other's edges
        if rule.time:
            lines += f"{node}{_TIME}{self._name(rule.time)}{_END}"
        if rule.status == "active":
            lines += f"{shared.node}{_RULE}{node}{_DERIVED_END}"
            edges = (rule.features, shared.edges)
            if asserts and shared.edges and is_first(edges, self._edges, _MAX_KNOWN):
                if is_single:
                    lines += "".join([features.nodes[0] + edge for edge in shared.edges])
                else:
                    lines += _lines(rule_mapping.edges(rule))
        if asserts:
            relation = shared.relation if is_single else _lines(rule_mapping.relation_quads(rule))
        named = (relation, features.labels, shared.labels)
        new = [some for some in named if is_first(some, self._labelled, _MAX_KNOWN)]
        self._write(lines + "".join(new))

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
        name = self._name
        for subject, key, value, graph in quads:
            end = name(value) if isinstance(value, Iri) else as_sparql(value)
            self._write(f"{name(subject)} {name(key)} {end} {name(graph or BELIEFS)} .\n")

    def taken(self, least: int = _MAX_HELD) -> Iterator[bytes]:
        """Give what was written since the last time, when it has at least so many characters."""
        if self._size >= least:
            yield "".join(self._held).encode()
            self._held.clear()
            self._size = 0

    def _write(self, text: str) -> None:
        self._held.append(text)
        self._size += len(text)


def _shared(
    contexts: frozenset[Atom], functor: str, argument: Atom | None, speaker: str, status: Status
) -> SharedLines:
    one = Rule(frozenset([ANY]), contexts, functor, argument, _TRUE, speaker, status=status)
    labels = rule_mapping.atom_label_quads({*one.contexts, one.argument})
    return SharedLines(
        tuple(_end(q) for q in rule_mapping.property_quads(one) if q.predicate not in OWN),
        as_sparql(rule_mapping.node_edge(one).subject),
        tuple(map(_end, rule_mapping.edges(one))),
        _lines([*labels, *rule_mapping.node_label_quads(one)]),
        _lines(rule_mapping.relation_quads(one)),
    )


def _feature_lines(atoms: frozenset[Atom]) -> FeatureLines:
    nodes = tuple(as_sparql(rule_mapping.atom_iri(atom)) for atom in sorted(atoms))
    ends = tuple(f" {as_sparql(FEATURE)} {node}{_END}" for node in nodes)
    return FeatureLines(ends, nodes, _lines(rule_mapping.atom_label_quads(atoms)))


def _end(quad: Quad) -> str:
    end = _DERIVED_END if quad.graph == DERIVED else _END
    return f" {as_sparql(quad.predicate)} {as_sparql(quad.object)}{end}"


def _lines(quads: Iterable[Quad]) -> str:
    return "".join([as_sparql(quad.subject) + _end(quad) for quad in quads])
