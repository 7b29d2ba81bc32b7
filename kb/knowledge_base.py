"""The knowledge base: rules, their history, the domain and episodes in one store.

`KnowledgeBase.open` creates or opens one. A base names its format, so that a base of a later
version of Hilt is never misread by an earlier one. A base of an earlier format is migrated when it
is opened for writing: each step is one SPARQL update, applied together with the new number, so a
base is always wholly in one format. At an endpoint that does not apply both at once the number
comes last, and the step is repeated. Steps are never changed after their release.

What follows from the rules, the history and the episodes is in a graph of its own, which every
write keeps up to date; it is made anew after a migration, and on request. A base names the version
of that graph last of all, so that one that was made in part is made again.
"""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, suppress
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, cast

from ..ontology.errors import QueryError, StoreError, ValidationError
from ..ontology.vocabulary import PREFIXES, Iri, term
from .episodes import EPISODES, Episode, episode_quads, observation_quads, read_episodes
from .history import HISTORY, read_utterance, utterance_quads
from .interval import CERTAIN
from .rdf.domain import DOMAIN, DOMAIN_HASH, content_hash, domain_quads
from .rdf.rule_mapping import BELIEFS, DERIVED, TYPE, read_rule, rule_quads
from .rdf.terms import BASE_GRAPH, BASE_NODE, Properties, Quad, Term, as_line, as_sparql
from .rule import DEFAULT_SPEAKER
from .sparql import query_text
from .sparql.named_queries import named_query
from .sparql.query_text import Bindings
from .sparql.results import QueryLimits, QueryResult, SelectResult
from .stores.base import EmbeddedStore, ReadableStore, Store, batched, described_nodes, is_first
from .stores.opening import open_store
from .writer import RuleWriter, to_milliseconds, trust_quads

if TYPE_CHECKING:
    from ..ontology.actions import Actions
    from ..ontology.objects import ObjectTypes

FORMAT = 2  # raised when earlier versions would misread what is written
FORMAT_VERSION = term("formatVersion")

_EPISODES = "SELECT (COUNT(*) AS ?n) WHERE { GRAPH graph:episodes { ?episode a hilt:Episode } }"

# In format 1 what follows from rules stood among the beliefs; it is derived anew.
_TO_2 = """
DELETE { GRAPH graph:beliefs { ?node ?key ?value } }
WHERE {
  VALUES ?key { hilt:rule hilt:usedFor hilt:graspedBy hilt:affords }
  GRAPH graph:beliefs { ?node ?key ?value }
} ;
DELETE { GRAPH graph:beliefs { ?node rdf:type ?class ; rdfs:label ?label } }
WHERE {
  VALUES ?class {
    hilt:Object hilt:Part hilt:Property hilt:Action hilt:Place hilt:Role hilt:Affordance
    hilt:Material hilt:Node hilt:Functor
  }
  GRAPH graph:beliefs { ?node rdf:type ?class ; rdfs:label ?label }
}"""

# Format -> the update to the next one. Add a step when FORMAT is raised.
STEPS: Mapping[int, str] = {1: _TO_2}

_VERSION = 1  # raised when something else follows than before
DERIVATION = term("derivation")
MARK = Quad(BASE_NODE, DERIVATION, _VERSION, BASE_GRAPH)  # the derived graph is complete
_BATCH = 1000  # statements
_MAX_SEEN = 100_000  # statements that are not written again


class KnowledgeBase(RuleWriter, AbstractContextManager["KnowledgeBase"]):
    """A knowledge base, in memory or in a folder; close it, or use it in a `with` block.

    `taxonomies` names the ontologies whose kinds count as those of the household do.

    >>> with KnowledgeBase.open("memory:") as kb:
    ...     kb.trust("sam"), kb.rules(), kb.sequence
    (Interval(1.0, 1.0), [], 0)
    """

    taxonomies: tuple[str, ...] = ()

    def __init__(self, store: Store, *, clock: Callable[[], datetime] | None = None) -> None:
        """Use an open store, which is closed with the base; an empty one becomes a base.

        A base of an earlier format is migrated. The clock gives the time of an utterance.
        StoreError if the store holds other data, or was written by a later version of Hilt.
        """
        super().__init__(store, clock=clock)
        self._recorded = 0
        if base_format(store) == FORMAT and any(store.quads(*MARK)):
            return  # without waiting for others who write
        with store.writing():
            if (found := base_format(store)) is None:
                if any(store.quads()):
                    raise StoreError(f'"{store.location}" holds other data, not a base of Hilt.')
                is_base = Quad(BASE_NODE, TYPE, term("Base"), BASE_GRAPH)
                trust = trust_quads(DEFAULT_SPEAKER, CERTAIN)
                store.apply(insert=[is_base, version_quad(FORMAT), MARK, *trust])
            elif found != FORMAT:
                migrate(store, found)
            if not any(store.quads(*MARK)):
                self.derive()

    @classmethod
    def open(cls, location: str | Path, *, read_only: bool = False) -> "KnowledgeBase":
        """Open a base, or create one; StoreError if it cannot be opened, with what to do.

        The location is `memory:`, a folder, or the address of a SPARQL endpoint. `read_only`
        refuses to write: the base must exist; a folder open elsewhere is read as it is now.
        """
        store = open_store(location, read_only=read_only)
        try:
            return cls(store)
        except BaseException:
            store.close()
            raise

    def close(self) -> None:
        """Close the store; the base cannot be used any more."""
        self.store.close()

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<KnowledgeBase {self.store.location}>"

    def query(
        self, text: str, bindings: "Bindings | None" = None, *, limits: QueryLimits | None = None
    ) -> QueryResult:
        """The result of a SPARQL query, in which the prefixes of the vocabulary are declared.

        The query (SELECT, ASK, CONSTRUCT or DESCRIBE) reads this base only, and outside `GRAPH` the
        union of all graphs. `bindings` are values for its variables; `limits` are time and memory
        after which it is stopped, none by default, for queries that are known to end. QueryError if
        the query is wrong, reads anything else, or was stopped.
        """
        if not query_text.query_form(bound := _prepared(text, bindings)):
            raise QueryError("Expected a SELECT, ASK, CONSTRUCT or DESCRIBE query.")
        with query_text.errors_as_typed(text, bound):
            return self.store.run(bound, limits)

    def select(self, text: str, bindings: "Bindings | None" = None) -> SelectResult:
        """The rows of a SELECT query; as `query` otherwise."""
        return self.store.select(_prepared(text, bindings))

    def answer(
        self, name: str, /, *, limits: QueryLimits | None = None, **arguments: str
    ) -> SelectResult:
        """The rows of a named query, whose parameters are given as texts; `limits` as for `query`.

        >>> KnowledgeBase.open("memory:").answer("best-for", affordance="cutting").variables[:3]
        ('affordance', 'object', 'features')

        UnknownNameError if there is no such query or parameter; QueryError for a wrong argument.
        """
        query = named_query(name)
        return cast(SelectResult, self.query(query.text, query.bindings(arguments), limits=limits))

    def load_domain(
        self,
        objects: "ObjectTypes",
        actions: "Actions",
        classes: Mapping[str, str | None] | None = None,
        people: Mapping[str, str] | None = None,
    ) -> bool:
        """Write the domain, with the kinds above `classes` and `people`; False if it is there."""
        new = domain_quads(objects, actions, classes, people)
        mark = Quad(BASE_NODE, DOMAIN_HASH, content_hash(new), BASE_GRAPH)
        before = list(self.store.quads(BASE_NODE, DOMAIN_HASH, None, BASE_GRAPH))
        if before == [mark]:
            return False
        with self.store.writing():
            before = self.store.quads(BASE_NODE, DOMAIN_HASH, None, BASE_GRAPH)
            old = {*before, *self.store.quads(None, None, None, DOMAIN)} - set(new)
            self.store.apply(insert=[*new, mark], delete=old)
        return True

    def record_episode(self, episode: Episode) -> Episode:
        """Store the execution of the last command; returns it with its id, utterance and time."""
        with self.store.writing():
            number, now = self.last_written, to_milliseconds(self.clock())
            mark = hashlib.sha256(f"{now}{episode.document}".encode()).hexdigest()[:8]
            recorded = replace(episode, id=f"{number}-{mark}", utterance=number or None, time=now)
            self.store.apply(insert=episode_quads(recorded))
            self._recorded += 1
        return recorded

    @property
    def episodes_recorded(self) -> object:
        """A number that changes with every episode, whoever records it."""
        return self.store.select(_EPISODES).rows[0][0] if self.is_shared else self._recorded

    def episodes(self) -> Iterator[Episode]:
        """The episodes, oldest first."""
        return read_episodes(self.store)

    def derive(self) -> None:
        """Make anew what follows from the rules, the history and the episodes."""
        store = self.store
        if store.read_only:
            raise StoreError(
                f'What follows from the rules of "{store.location}" is not complete. '
                "Open it once for writing: hilt validate --repair"
            )
        with store.writing():
            store.apply(delete=list(store.quads(BASE_NODE, DERIVATION, None, BASE_GRAPH)))
            store.update(f"CLEAR SILENT GRAPH {as_sparql(DERIVED)}")
            seen = set[object]()
            new = batched((q for q in derived_quads(store) if is_first(q, seen, _MAX_SEEN)), _BATCH)
            if isinstance(store, EmbeddedStore):
                store.load("".join(map(as_line, some)).encode() for some in new)
            else:
                for some in new:
                    store.apply(insert=some)
            store.apply(insert=[MARK])


def _prepared(text: str, bindings: "Bindings | None") -> str:
    query_text.refuse_external_access(text)
    return query_text.bind_variables(text, bindings or {})


def base_format(store: ReadableStore) -> Term | None:
    """The format in which a store was written; None when it holds no base."""
    found = store.quads(BASE_NODE, FORMAT_VERSION, None, BASE_GRAPH)
    return next((quad.object for quad in found), None)


def migrate(store: Store, old: Term, *, steps: Mapping[int, str] = STEPS, to: int = FORMAT) -> None:
    """Bring a base from its `old` format to a later one; the caller holds the write lock.

    A StoreError says that there is no step, or that the store is read-only.
    """
    if not isinstance(old, int) or old > to or any(n not in steps for n in range(old, to)):
        raise StoreError(
            f'The knowledge base "{store.location}" has format {old}; this Hilt reads format '
            f"{to}. Use the Hilt that wrote it to export it."
        )
    if old < to and store.read_only:
        raise StoreError(
            f'The knowledge base "{store.location}" has format {old}; open it once for writing '
            f"to bring it to format {to}."
        )
    for number in range(old, to):
        renumber = query_text.delete_insert([version_quad(number)], [version_quad(number + 1)])
        store.update(f"{steps[number]} ;\n{renumber}")


def version_quad(number: int) -> Quad:
    """The statement that names the format of a base."""
    return Quad(BASE_NODE, FORMAT_VERSION, number, BASE_GRAPH)


def derived_quads(store: Store, *graphs: Iri) -> Iterator[Quad]:
    """What follows from graphs of a store, by default all, where well formed; some of it twice."""
    for graph in graphs or _SOURCES:
        kind, read = _SOURCES[graph]
        for node, properties in described_nodes(store, graph):
            if node.startswith(PREFIXES.get(kind, "")):
                with suppress(ValidationError):
                    yield from (quad for quad in read(node, properties) if quad.graph == DERIVED)


# Graph -> the kind of its nodes from which something follows, and the statements of such a node.
_SOURCES: Mapping[Iri, tuple[str, Callable[[Iri, Properties], Iterable[Quad]]]] = {
    BELIEFS: ("rule", lambda _, found: rule_quads(read_rule(found))),
    HISTORY: ("utterance", lambda _, found: utterance_quads(read_utterance(found))),
    EPISODES: ("", observation_quads),
}
