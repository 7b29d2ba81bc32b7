"""The invariants of a base: what may stand at each node of each graph.

A node is read back as a value, and what Hilt would have written of that value is compared with what
is there. What follows from the others, in the derived graph, is compared with all. A whole base
also has the utterance from which each rule comes, everything that its statements lead to, and the
numbers and hashes that describe it; a file need not.

`hilt validate` checks all nodes and `hilt update` those that an update touches, by the same laws.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from datetime import datetime
from decimal import Decimal
from typing import Any, TypeAlias, cast

from ..ontology import vocabulary
from ..ontology.errors import ValidationError
from ..ontology.vocabulary import NAMED_KINDS, Iri, iri, is_ontology, shortened, split, term
from . import history
from .episodes import EPISODES, episode_quads, read_episode
from .interval import Interval
from .knowledge_base import DERIVATION, FORMAT, FORMAT_VERSION, base_format
from .learned import ACTIONS, LEXICON, PHRASES, TAUGHT_ACTIONS, TOLD, WORDS, LearnedMapping
from .rdf import rule_mapping
from .rdf.domain import DOMAIN, DOMAIN_HASH, content_hash
from .rdf.record_mapping import group_pairs
from .rdf.rule_mapping import ACTIVE, BELIEFS, DERIVED, DERIVED_FROM, LABEL, STATUS, TYPE
from .rdf.terms import BASE_GRAPH, BASE_NODE, Properties, Quad, Term, is_blank, lexical
from .rule import check_speaker
from .stores.base import ReadableStore, Store, described_nodes
from .writer import speaker_quads, trust_quads

BASE_GRAPHS = frozenset(iri("graph", name) for name in vocabulary.GRAPH_NAMES)
_OF_NODES = frozenset((TYPE, LABEL, *(term(name) for name in ("does", "under", "heeds"))))
_OF_BASE = frozenset((TYPE, FORMAT_VERSION, history.SEQUENCE, DOMAIN_HASH, DERIVATION))
_REFERRED = {"utterance": history.HISTORY, "rule": BELIEFS}  # kinds of nodes that must be there
_COUNT = "SELECT (COUNT(*) AS ?count) { GRAPH ?graph { ?node ?key ?value } }"
_STEP = 10_000  # statements between two calls of the progress
_Reader: TypeAlias = Callable[[ReadableStore, Iri, Properties], Iterable[Quad]]
_MAY_LACK = tuple(vocabulary.PREFIXES[kind] for kind in _REFERRED)


@dataclass(frozen=True, order=True)
class ValidationFinding:
    """One thing that is wrong: what was expected, and what was found where that helps.

    `node` is what it is about, `key` the property that is wrong (empty for more than one), as
    prefixed names. `line` is the 1-based line at which a file describes the node; 0 if not known.
    """

    node: str
    problem: str
    key: str = field(default="", compare=False)
    line: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return f"{self.node}: {self.problem}"

    def as_json(self) -> dict[str, object]:
        """As `hilt validate --json` prints it."""
        where = {"node": self.node, "property": self.key or None, "line": self.line or None}
        return {**where, "problem": self.problem}


def check_invariants(
    store: Store, *, whole: bool = False, progress: Callable[[int, int], None] | None = None
) -> Iterator[ValidationFinding]:
    """What breaks the laws, or belongs to nothing; of a `whole` base also what is missing.

    `progress` is told now and then how many statements are done, and of how many.
    """
    laws, done, told = Invariants(store, whole=whole), 0, 0
    ((total,),) = store.select(_COUNT) if progress else ((0,),)
    for graph in sorted(BASE_GRAPHS):
        for node, properties in described_nodes(store, graph):
            yield from laws.check(node, graph, properties)
            done += len(properties)
            if progress and done - told >= _STEP:
                told = done
                progress(done, cast(int, total))
    yield from laws.check_derived()
    if whole:
        yield from _base_findings(store)


class Invariants:
    """The laws, applied to the nodes of a store one by one."""

    def __init__(self, store: ReadableStore, *, whole: bool) -> None:
        self._derived = set[Quad]()  # what follows from the nodes so far
        self._store = store
        self._whole = whole
        self._claimed = set[Quad]()  # what should follow
        self._all_readable = True

    def check(self, node: Iri, graph: Iri, properties: Properties) -> Iterator[ValidationFinding]:
        """Yield what is wrong with a node of a graph, given its properties."""
        if is_ontology(graph):
            return
        try:
            expected = written(self._store, node, graph, properties)
        except ValidationError as error:
            self._all_readable = False
            yield from (ValidationFinding(shortened(node), one) for one in error.findings)
            return
        self._derived.update(quad for quad in expected if quad.graph == DERIVED)
        actual = {Quad(node, key, value, graph) for key, value in properties}
        if graph == DERIVED:
            self._claimed |= actual
            return
        for quad in actual:
            if is_name(quad) and graph == BELIEFS and not self._whole:
                continue  # files of format 1 have names there
            known = expected.get(quad)
            types = {type(one.object) for one in (quad, known or quad)}
            is_lawful = len(types) == 1 or types == {int, Decimal}
            if not is_lawful or not (known or _stands_alone(quad)):
                yield _finding(quad, "belongs to nothing known.")
        if self._whole:
            own = {quad for quad in expected if quad.graph == graph}
            yield from (_finding(quad, "is missing.") for quad in own - actual)
            yield from self._dangling(actual)

    def check_derived(self) -> Iterator[ValidationFinding]:
        """Yield what follows from nothing, when all nodes have been checked."""
        # What perhaps follows from something unreadable is no matter of its own.
        for quad in self._claimed - self._derived if self._all_readable else ():
            if not is_name(quad):  # of what no rule speaks of any more
                yield _finding(quad, "belongs to nothing known.")
        for quad in self._derived - self._claimed if self._whole else ():
            yield _finding(quad, "is missing, and follows. Run: hilt validate --repair")

    def _dangling(self, statements: Iterable[Quad]) -> Iterator[ValidationFinding]:
        for quad in statements:
            value = quad.object
            if isinstance(value, Iri) and value.startswith(_MAY_LACK):
                is_source = quad.predicate == DERIVED_FROM and quad.graph == BELIEFS
                wanted = (history.ASSERTS, quad.subject) if is_source else (TYPE, None)
                if not any(self._store.quads(value, *wanted, _REFERRED[split(value)[0]])):
                    yield _finding(quad, "does not assert it." if is_source else "is not there.")


def written(store: ReadableStore, node: Iri, graph: Iri, said: Properties) -> dict[Quad, Quad]:
    """What Hilt would have written of a node with these properties, in its graph.

    A ValidationError says that they make no value. Each statement stands under itself, because
    literals are equal by value and may differ in their datatype.
    """
    refuse_blank_nodes((node, *(value for _, value in said)))
    if (read := _READERS.get((graph, split(node)[0]))) is None or not said:
        return {}
    try:
        return {quad: quad for quad in read(store, node, said)}
    except ValidationError:
        raise
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise ValidationError([f"It cannot be read: {error}"]) from error


def refuse_blank_nodes(terms: Iterable[Term | None]) -> None:
    """Raise a ValidationError where one of the terms is a blank node."""
    if any(map(is_blank, terms)):
        raise ValidationError(["A base has no blank nodes; give each a name."])


def _rule(_: ReadableStore, node: Iri, properties: Properties) -> Iterator[Quad]:
    rule = rule_mapping.read_rule(properties)
    if rule_mapping.rule_iri(rule.id) != node:
        raise ValidationError([f"Its content makes it {rule.id.replace('/', ':')}."])
    if not isinstance(cast(object, rule.time), datetime | None):
        raise ValidationError(["Its prov:generatedAtTime is no xsd:dateTime with a time zone."])
    return rule_mapping.rule_quads(rule)


def _utterance(_: ReadableStore, node: Iri, properties: Properties) -> Iterator[Quad]:
    utterance = history.read_utterance(properties)
    if node != history.utterance_iri(utterance.sequence):
        raise ValidationError([f"Its sequence number is {utterance.sequence}."])
    return history.utterance_quads(utterance)


def _speaker(_: ReadableStore, node: Iri, properties: Properties) -> Iterable[Quad]:
    name, found = split(node)[1], group_pairs(properties)
    check_speaker(name)
    lower, upper = (cast("list[float]", found[key]) for key in history.TRUST)
    if not lower + upper:
        return speaker_quads(name, BELIEFS)
    if len(lower) != 1 or len(upper) != 1:
        raise ValidationError(["Trust is one hilt:trustLower and one hilt:trustUpper."])
    return trust_quads(name, Interval(*lower, *upper).rounded())


def _learned(mapping: LearnedMapping[Any]) -> "_Reader":
    told = {mapping.fields[name].predicate: mapping.fields[name] for name in TOLD}

    def read(_: ReadableStore, node: Iri, properties: Properties) -> Iterator[Quad]:
        # What was learned again, or merged, has several utterances.
        record = mapping.read(group_pairs(dict(properties).items()))
        if mapping.node(record) != node:
            raise ValidationError([f"Its content makes it {shortened(mapping.node(record))}."])
        for quad in mapping.learned_quads(record):
            if quad.predicate != STATUS and quad.subject == node:
                yield quad
        is_stated = any(key == STATUS for key, _ in properties)
        for key, value in properties if is_stated else [*properties, ACTIVE]:
            if key in told and isinstance(value, told[key].kind):
                told[key].decode(value)
                yield Quad(node, key, value, mapping.graph)
            elif key == STATUS and value in _STATUSES:
                yield Quad(node, key, value, mapping.graph)

    return read


def _episode(store: ReadableStore, node: Iri, _: Properties) -> Iterator[Quad]:
    kind, name = split(node)
    about = name if kind == "episode" else name.rpartition(".")[0]
    episode = read_episode(store, iri("episode", about))
    return (quad for quad in episode_quads(episode) if quad.subject == node)


_STATUSES = {term(status) for status in ("active", "retracted")}
_READERS: dict[tuple[Iri, str], _Reader] = {
    (BELIEFS, "rule"): _rule,
    (BELIEFS, "speaker"): _speaker,
    (history.HISTORY, "utterance"): _utterance,
    (history.HISTORY, "speaker"): lambda _, node, __: speaker_quads(
        split(node)[1], history.HISTORY
    ),
    (LEXICON, "word"): _learned(WORDS),
    (LEXICON, "phrase"): _learned(PHRASES),
    (ACTIONS, "taught"): _learned(TAUGHT_ACTIONS),
    **{(EPISODES, kind): _episode for kind in vocabulary.EPISODE_KINDS},
}


def _base_findings(store: ReadableStore) -> Iterator[ValidationFinding]:
    name = shortened(BASE_GRAPH)
    if base_format(store) != FORMAT:
        yield ValidationFinding(name, f"The format of the base is not {FORMAT}.")
    number = _highest(store.quads(BASE_NODE, history.SEQUENCE, None, BASE_GRAPH))
    last = _highest(store.quads(None, history.SEQUENCE, None, history.HISTORY))
    if number < last:
        problem = f"hilt:sequence is {number}, but there is an utterance:{last}."
        yield ValidationFinding(name, problem, "hilt:sequence")
    hashes = [quad.object for quad in store.quads(BASE_NODE, DOMAIN_HASH, None, BASE_GRAPH)]
    if hashes and hashes != [content_hash(store.quads(None, None, None, DOMAIN))]:
        problem = "It is not as Hilt wrote it. Open the base with `hilt chat`."
        yield ValidationFinding(shortened(DOMAIN), problem)
    yield from trust_findings(store)


def _highest(numbers: Iterable[Quad]) -> int:
    return max((quad.object for quad in numbers if isinstance(quad.object, int)), default=0)


def trust_findings(store: ReadableStore) -> Iterator[ValidationFinding]:
    """Yield a finding when nobody is trusted."""
    bounds = (quad.object for quad in store.quads(None, history.TRUST_UPPER, None, BELIEFS))
    if not any(bound != 0 for bound in bounds):
        problem = "Nobody is trusted, so nothing can be learned; say hilt trust NAME 1."
        yield ValidationFinding(shortened(BASE_GRAPH), problem)


def _stands_alone(quad: Quad) -> bool:
    """What is not read back: the domain has a hash, and trees of actions are written only."""
    if quad.graph == BASE_GRAPH:
        return quad.subject == BASE_NODE and quad.predicate in _OF_BASE
    is_tree = split(quad.subject)[0] in NAMED_KINDS and quad.predicate in _OF_NODES
    return quad.graph == DOMAIN or (quad.graph == ACTIONS and is_tree)


def is_name(quad: Quad) -> bool:
    """Whether a statement says the class or the label of something that rules speak of."""
    return split(quad.subject)[0] in NAMED_KINDS and quad.predicate in {TYPE, LABEL}


def _finding(quad: Quad, problem: str) -> ValidationFinding:
    value = quad.object
    shown = shortened(value) if isinstance(value, Iri) else f'"{lexical(value)[0][:60]}"'
    said = f"{shortened(quad.predicate)} {shown} {problem}"
    return ValidationFinding(shortened(quad.subject), said, shortened(quad.predicate))
