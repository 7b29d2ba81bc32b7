# SPDX-License-Identifier: Apache-2.0
"""The knowledge base: a store that holds beliefs, their history, the domain and episodes.

`KnowledgeBase.open` makes or opens one. A base says in its graph `base` in which format it was
written, so that what a later Hilt writes is never misread by an earlier one.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, cast

from ..ontology.errors import QueryError, StoreError
from ..ontology.vocabulary import HILT, Iri, term
from .episodes import Episode, episode_quads, read_episodes
from .interval import CERTAIN
from .migration import FORMAT, format_of, migrate, version_quad
from .rdf.rule_mapping import TYPE
from .rdf.terms import Quad
from .reader import BASE_GRAPH, BASE_NODE
from .rule import DEFAULT_SPEAKER
from .sparql.limits import Limits
from .sparql.named_queries import named_query
from .sparql.results import BooleanResult, Found, Solutions, Statements
from .sparql.safety import refuse_outside
from .sparql.text import bind, form
from .stores.base import Bindings, Store, open_store
from .writer import RuleWriter, to_milliseconds, trust_quads

if TYPE_CHECKING:
    from ..ontology.actions import Actions
    from ..ontology.objects import ObjectType


class KnowledgeBase(RuleWriter):
    """A knowledge base, in memory or in a folder; close it, or use it in a `with` block.

    >>> with KnowledgeBase.open("memory:") as kb:
    ...     kb.trust("sam"), kb.rules(), kb.sequence
    (Interval(1.0, 1.0), [], 0)
    """

    def __init__(self, store: Store, *, clock: Callable[[], datetime] | None = None) -> None:
        """Use an open store; an empty one becomes a base.

        Args:
            store: the store, which is closed with the base.
            clock: gives the time of what is said; the system's by default.

        Raises:
            StoreError: the store holds something else, or was written by a later Hilt.
                What an earlier one wrote is brought to the format of today.
        """
        super().__init__(store, clock=clock)
        with store.writing():
            self._check_format()

    @classmethod
    def open(cls, location: str | Path, *, read_only: bool = False) -> KnowledgeBase:
        """Open a base, or make a new one.

        Args:
            location: `memory:`, a folder, or the address of a SPARQL endpoint.
            read_only: refuse to write; the base must exist. A folder that another process
                has open is read as it is now.

        Raises:
            StoreError: it cannot be opened; says why and what to do.
        """
        store = open_store(location, read_only=read_only)
        try:
            return cls(store)
        except BaseException:
            store.close()
            raise

    def close(self) -> None:
        """Release the base; it cannot be used any more."""
        self.store.close()

    def __enter__(self) -> KnowledgeBase:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<KnowledgeBase {self.store.location}>"

    # Questions in SPARQL

    def query(
        self, text: str, bindings: Bindings | None = None, *, limits: Limits | None = None
    ) -> Found:
        """Ask anything in SPARQL; the prefixes of the vocabulary are declared already.

        Outside `GRAPH` a query sees all graphs as one.

        Args:
            text: a SELECT, ASK, CONSTRUCT or DESCRIBE query. It reads this base only.
            bindings: values for its variables.
            limits: time and memory, after which it is stopped; none by default, for queries
                that are known to end.

        Returns:
            The rows, the answer of an ASK, or the statements of a CONSTRUCT or DESCRIBE.

        Raises:
            QueryError: the query is wrong, reaches outside, or was stopped.
        """
        bound = self._prepared(text, bindings)
        if limits and form(bound):
            return self.store.run(bound, limits)
        match form(bound):
            case "SELECT":
                return self.store.select(bound)
            case "ASK":
                return BooleanResult(self.store.ask(bound))
            case "CONSTRUCT" | "DESCRIBE":
                return Statements.of(self.store.construct(bound))
            case _:
                raise QueryError("Expected a SELECT, ASK, CONSTRUCT or DESCRIBE query.")

    def select(self, text: str, bindings: Bindings | None = None) -> Solutions:
        """The rows of a SELECT query; as `query` otherwise."""
        return self.store.select(self._prepared(text, bindings))

    def ask(self, text: str, bindings: Bindings | None = None) -> bool:
        """The answer of an ASK query; as `query` otherwise."""
        return self.store.ask(self._prepared(text, bindings))

    def construct(self, text: str, bindings: Bindings | None = None) -> list[Quad]:
        """The statements of a CONSTRUCT or DESCRIBE query; as `query` otherwise."""
        return self.store.construct(self._prepared(text, bindings))

    def answer(self, name: str, /, *, limits: Limits | None = None, **arguments: str) -> Solutions:
        """The answer to a named question.

        >>> KnowledgeBase.open("memory:").answer("best-for", affordance="cutting").variables
        ('affordance', 'object', 'lower', 'upper', 'speaker', 'rule')

        Args:
            name: of the query, as "best-for".
            limits: as for `query`.
            arguments: values for its parameters, as texts.

        Raises:
            UnknownNameError: there is no such query or parameter.
            QueryError: an argument is no value of its kind.
        """
        query = named_query(name)
        return cast(Solutions, self.query(query.text, query.bindings(arguments), limits=limits))

    def count(self) -> dict[str, int]:
        """How many things of each class there are, as {"ActionRule": 2, "Utterance": 3}."""
        rows = self.store.select(named_query("counts").text)
        named = ((cast(Iri, kind).removeprefix(HILT), cast(int, number)) for kind, number in rows)
        return dict(named)

    # The domain, and what was done

    def load_domain(
        self,
        objects: Mapping[str, ObjectType],
        actions: Actions,
        classes: Mapping[str, str | None] | None = None,
    ) -> bool:
        """Write the household domain, unless this very one is there already.

        Args:
            objects: object types by name.
            actions: the action trees.
            classes: class of objects -> the class above it, or None.

        Returns:
            Whether anything was written.
        """
        from .rdf.domain import DOMAIN, DOMAIN_HASH, content_hash, domain_quads

        new = domain_quads(objects, actions, classes)
        mark = Quad(BASE_NODE, DOMAIN_HASH, content_hash(new), BASE_GRAPH)
        with self.store.writing():
            before = list(self.store.quads(BASE_NODE, DOMAIN_HASH, None, BASE_GRAPH))
            if before == [mark]:
                return False
            gone = {*before, *self.store.quads(None, None, None, DOMAIN)} - set(new)
            self.store.apply(insert=[*new, mark], delete=gone)
        return True

    def record_episode(self, episode: Episode) -> Episode:
        """Keep what was done about a command, as belonging to the last utterance.

        Returns:
            The episode with its id, utterance and time.
        """
        with self.store.writing():
            number, moment = self.sequence, to_milliseconds(self.clock())
            mark = hashlib.sha256(f"{moment}{episode.document}".encode()).hexdigest()[:8]
            recorded = replace(
                episode, id=f"{number}-{mark}", utterance=number or None, time=moment
            )
            self.store.apply(insert=episode_quads(recorded))
        return recorded

    def episodes(self) -> Iterator[Episode]:
        """What was done, the oldest first."""
        return read_episodes(self.store)

    # How it is made

    def _prepared(self, text: str, bindings: Bindings | None) -> str:
        refuse_outside(text)
        return bind(text, bindings or {})

    def _check_format(self) -> None:
        found = format_of(self.store)
        if found is None:
            self._found()
        elif found != FORMAT:
            migrate(self.store, found)

    def _found(self) -> None:
        """Make an empty store a base: its format, and whom it trusts from the start."""
        if any(self.store.quads()):
            raise StoreError(
                f'"{self.store.location}" holds other data and no knowledge base of Hilt.'
            )
        self.store.apply(
            insert=[
                Quad(BASE_NODE, TYPE, term("Base"), BASE_GRAPH),
                version_quad(FORMAT),
                *trust_quads(DEFAULT_SPEAKER, CERTAIN),
            ]
        )
