"""The import: rules and history are checked as they stream by, and written as one unit.

Each rule is checked on its own (its interval, its form, its name) and written as lines of N-Quads,
which the engine takes while they are made; only numbers are kept of it. The engine makes them
visible as one unit at the end, or drops all when something is wrong. What is not a rule
(utterances, words, episodes) is staged, checked and reconciled with the base.

The statements of one rule must stand together, as they do in every export.
"""

import io
from array import array
from collections import Counter, defaultdict, deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache, partial
from itertools import chain

from ...ontology.errors import DataError, ValidationError
from ...ontology.garbage_collection import paused_garbage_collection
from ...ontology.vocabulary import NAMED_KINDS, PREFIXES, Iri, is_ontology, shortened, split, term
from .. import validation
from ..history import ASSERTS, HISTORY, SEQUENCE, Utterance, import_utterance, utterance_iri
from ..invariants import check_invariants
from ..knowledge_base import KnowledgeBase
from ..rdf import rule_mapping, terms
from ..rdf.rule_mapping import BELIEFS, CONTEXT, DERIVED, FEATURE, LABEL, RULE_NODE
from ..rdf.terms import BASE_GRAPH, BASE_NODE, Quad, Statements, Term
from ..reader import RuleReader
from ..rule import Rule
from ..stores.base import EmbeddedStore, Store, batched
from ..stores.rdf_text import grouped, read_groups
from ..validation import ValidationFinding, raise_findings
from ..writer import to_milliseconds
from . import reconciliation
from .exporter import statements
from .reconciliation import AncillaryWrites, ImportConflict, ImportSummary
from .rule_nquads import NQuadsWriter

MAX_LISTED = 20  # conflicts, and rules of another status, that a summary names
MAX_REST = 3_000_000  # statements that belong to no rule and are held in memory
PER_UTTERANCE = 1000  # rules that one utterance of the history stands for
_MAX_APPLIED = 2**21  # bytes of lines that are written as an ordinary unit
_WRITTEN_AGAIN = frozenset((rule_mapping.TYPE, LABEL, rule_mapping.RULE, *rule_mapping.PLAIN_EDGES))

_RULES = PREFIXES["rule"]


def import_statements(
    base: KnowledgeBase,
    statements: Iterable[Statements],
    *,
    source: str,
    dry_run: bool = False,
    check: Callable[[Store], Iterable[ValidationFinding]] = validation.findings,
) -> ImportSummary:
    """Import the statements of an RDF text: whole or not at all, and twice is once.

    `source` names the file, in messages and the history. A `dry_run` only finds out what would
    change. `check` finds what is wrong with the statements that belong to no rule. DataError if the
    text cannot be read; says where. ValidationError if it breaks a law; the base is unchanged.
    """
    one = _Import(base, source, check)
    return one.run(one.read_rules(statements), dry_run=dry_run)


def import_rules(
    base: KnowledgeBase, rules: Iterable[Rule], *, source: str, dry_run: bool = False
) -> ImportSummary:
    """Import rules; as `import_statements`."""
    one = _Import(base, source, check_invariants)  # only rules are read, so no shape can be broken
    return one.run(rules, dry_run=dry_run)


def merge(base: KnowledgeBase, new: Store, *, source: str, dry_run: bool = False) -> ImportSummary:
    """Add to a base what another one knows, as one unit, by an import of its export.

    The source names the other base in the history; a dry run only finds out what would change.
    ValidationError if the other base breaks a law; nothing has changed.
    """
    with new.writing():  # so that all of it is of one moment
        read = grouped(statements(new), BELIEFS)
        return import_statements(base, read, source=source, dry_run=dry_run, check=check_invariants)


@dataclass
class _Import:
    """One import: what is kept of what was read, and what is written besides the rules."""

    base: KnowledgeBase
    source: str
    check: Callable[[Store], Iterable[ValidationFinding]]
    rest: list[Quad] = field(default_factory=list[Quad])  # what belongs to no rule
    asserted: "dict[int, array[int]]" = field(  # ids of rules by the number of an utterance
        default_factory=lambda: defaultdict(lambda: array("Q"))
    )
    new: dict[int, int] = field(default_factory=dict[int, int])  # rule -> utterance; 0 where none
    timeless: set[int] = field(default_factory=set[int])  # ids of new rules without a time
    known: int = 0
    conflicting: int = 0
    conflicts: list[ImportConflict] = field(default_factory=list[ImportConflict])
    kept: list[Rule] = field(default_factory=list[Rule])  # known ones of another status
    untrusted: set[str] = field(default_factory=set[str])  # of the speakers of new rules
    left: Counter[str] = field(default_factory=Counter[str])

    def run(self, rules: Iterable[Rule], *, dry_run: bool) -> ImportSummary:
        store = self.base.store
        with store.writing(), paused_garbage_collection():
            plan = AncillaryWrites(self.base.sequence, left=self.left)
            lines = self._lines(rules, plan)
            if dry_run:
                deque(lines, maxlen=0)
            else:
                _write(store, lines, plan, self.source)
        return ImportSummary(
            len(self.new),
            self.known,
            self.conflicting,
            len(plan.added),
            tuple(sorted(self.untrusted)),
            tuple(self.conflicts),
            tuple(self.kept),
            dict(sorted(self.left.items())),
        )

    def read_rules(self, statements: Iterable[Statements]) -> Iterator[Rule]:
        for group in statements:
            if isinstance(group, terms.ReifyingTriple):
                raise DataError(
                    "annotated edges (RDF 1.2) are read from small files only; take N-Quads or "
                    "CSV.",
                    source=self.source,
                )
            validation.check_graph(group.graph, source=self.source)
            if group.graph == DERIVED:
                continue  # it follows again from what is imported
            if group.node.startswith(_RULES) and not is_ontology(group.graph):
                yield _read_rule(group.node, group.pairs)
            else:
                self.rest += self._besides_rules(group)
            if len(self.rest) > MAX_REST:
                problem = f"has more than {MAX_REST} statements besides its rules;"
                advice = "import the rules alone (hilt export --rules), or restore a backup."
                raise DataError(f"{problem} {advice}", source=self.source)

    def _besides_rules(self, group: terms.StatementGroup) -> Iterator[Quad]:
        node, graph, pairs = group
        kind, name = split(node)
        # Edges and labels are written again with the rules.
        derived = _WRITTEN_AGAIN if graph == BELIEFS and kind in NAMED_KINDS else frozenset[Iri]()
        # Formats without graphs have utterances among the beliefs.
        is_utterance = kind == "utterance" and name.isdecimal() and graph in {HISTORY, BELIEFS}
        for key, value in pairs:
            if is_utterance and key == ASSERTS and (rule := RULE_NODE.fullmatch(str(value))):
                self.asserted[int(name)].append(int(rule[1], 16))
            elif key not in derived:
                yield Quad(node, key, value, graph)
            elif key == LABEL and value != name:
                self.left[f"rdfs:label in {shortened(graph)}"] += 1

    def _lines(self, rules: Iterable[Rule], plan: AncillaryWrites) -> Iterator[bytes]:
        writer = NQuadsWriter()
        for rule in self._new_rules(rules):
            writer.write_rule(rule)
            yield from writer.taken()
        with closing(validation.stage(self.rest, source=self.source)) as staging:
            self.rest.clear()
            raise_findings(self.check(staging))
            other = RuleReader(staging)
            reconciliation.plan_trust(plan, self.base, other)
            reconciliation.plan_history(plan, self.base, self._utterances(other))
            reconciliation.plan_rest(plan, self.base, other)
            yield from self._write_sources(plan, writer)
            self.untrusted.difference_update(self.base.speakers(), other.speakers())
        yield from writer.taken(0)

    def _new_rules(self, rules: Iterable[Rule]) -> Iterator[Rule]:
        believed = cache(partial(reconciliation.believed_rules, self.base))
        known: dict[Term, Term] = {}  # one object for all rules
        there = {
            int(split(quad.subject)[1], 16): known.setdefault(quad.object, quad.object)
            for quad in self.base.store.quads(None, rule_mapping.STATUS, None, BELIEFS)
        }
        for rule in rules:
            if (number := _number(rule.id)) in there:
                self.known += 1
                if there[number] != term(rule.status):
                    self.kept += [rule][: MAX_LISTED - len(self.kept)]
                continue
            if number in self.new:
                continue
            self.new[number] = rule.utterance or 0
            self.untrusted.add(rule.speaker)
            if rule.time is None:
                self.timeless.add(number)
            if there and rule.status == "active":
                same = believed(rule.node).get(reconciliation.claim(rule), ())
                found = reconciliation.conflicts_of(rule, same)
                self.conflicting += len(found)
                self.conflicts += found[: MAX_LISTED - len(self.conflicts)]
            yield rule

    def _utterances(self, other: RuleReader) -> Iterator[Utterance]:
        told = self._by_utterance()
        for quad in other.store.quads(None, SEQUENCE, None, HISTORY):
            if isinstance(quad.object, int):
                utterance = other.utterance(quad.object)
                numbers = {*self.asserted.get(quad.object, ()), *map(_number, utterance.asserts)}
                for unsaid in set(told[quad.object]) - numbers:
                    problem = f"does not assert the rule:{unsaid:016x} that comes from it."
                    raise ValidationError([f"utterance:{quad.object}: It {problem}"])
                ids = tuple(f"rule/{number:016x}" for number in sorted(numbers))
                yield replace(utterance, asserts=ids)

    def _write_sources(self, plan: AncillaryWrites, writer: NQuadsWriter) -> Iterator[bytes]:
        time = to_milliseconds(self.base.clock())
        left = [one for one, utterance in self.new.items() if utterance not in plan.numbers]
        for start in range(0, len(left), PER_UTTERANCE):
            some = left[start : start + PER_UTTERANCE]
            which = f", rules {start + 1} to {start + len(some)}" if some != left else ""
            plan.last += 1
            plan.add(import_utterance(self.source, plan.last, time, some=which))
            writer.write_assertions(plan.last, some)
            writer.write_property(some, rule_mapping.DERIVED_FROM, utterance_iri(plan.last))
            yield from writer.taken()
        for utterance in plan.added:
            writer.write_assertions(utterance.sequence, map(_number, utterance.asserts))
            yield from writer.taken()
        told = self._by_utterance()
        for number in told.keys() & plan.numbers.keys():
            node = utterance_iri(plan.numbers[number])
            writer.write_property(told[number], rule_mapping.DERIVED_FROM, node)
            yield from writer.taken()
        for numbers in batched(self.timeless, PER_UTTERANCE):
            writer.write_property(numbers, rule_mapping.GENERATED_AT, time)
            yield from writer.taken()
        if plan.last:
            plan.insert.append(Quad(BASE_NODE, SEQUENCE, plan.last, BASE_GRAPH))
        writer.write_quads(plan.insert)

    def _by_utterance(self) -> "dict[int, array[int]]":
        found: dict[int, array[int]] = defaultdict(lambda: array("Q"))
        for number, utterance in self.new.items():
            found[utterance].append(number)
        return found


def _read_rule(node: Iri, properties: terms.Properties) -> Rule:
    try:
        rule = rule_mapping.read_rule(properties)
        keys = tuple([key for key, _ in dict.fromkeys(properties)])
        argument = rule.argument.kind if rule.argument else ""
        if foreign := _foreign(keys, len(rule.features), len(rule.contexts), argument):
            raise ValidationError([f"{shortened(key)} is no part of a rule." for key in foreign])
        return rule
    except ValidationError as error:
        raise ValidationError([f"{shortened(node)}: {one}" for one in error.findings]) from error


@lru_cache(maxsize=2**10)
def _foreign(keys: tuple[Iri, ...], features: int, contexts: int, argument: str) -> Counter[Iri]:
    once = rule_mapping.KEYS.keys() - rule_mapping.ARGUMENTS
    known = Counter({**dict.fromkeys(once, 1), FEATURE: features, CONTEXT: contexts})
    known[rule_mapping.argument_property(argument)] = 1
    return Counter(keys) - known


def _write(store: Store, lines: Iterator[bytes], plan: AncillaryWrites, source: str) -> None:
    # The old sequence number never counts beside the new one, which is higher.
    before = set(store.quads(BASE_NODE, SEQUENCE, None, BASE_GRAPH))
    first, size = list[bytes](), 0
    for chunk in lines:
        first.append(chunk)
        size += len(chunk)
        if size > _MAX_APPLIED and isinstance(store, EmbeddedStore):
            store.load(chain(first, lines))
            first.clear()
    text = io.BytesIO(b"".join(first))
    read = terms.ungrouped(read_groups(text, format="nquads", source=source, default=BELIEFS))
    insert = [one for one in read if isinstance(one, Quad)]
    store.apply(insert=insert, delete={*plan.delete, *before} - {*plan.insert})


def _number(rule_id: str) -> int:
    return int(rule_id.removeprefix("rule/"), 16)
