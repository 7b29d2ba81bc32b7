"""The right to write to an endpoint, which the processes that share it take in turn.

Engines do not notice that two writes conflict, and some are atomic for one operation only. So who
wants to write adds a claim to a graph of its own and reads all claims back: if no other is there,
it has the right. Else it takes a number after those of the others and waits until every other claim
has a higher one, as in Lamport's bakery algorithm, for which it is enough that who reads sees what
was written before. Every write has the condition that the claim of its writer still counts.

A claim is renewed while its process lives. When it was not renewed for `LEASE_S`, by the clock of
the endpoint, its process counts as dead: the next writer ends the claim, so that nothing more can
be written under it, and completes or removes what was prepared.

What is too large for one operation is prepared in graphs that no query sees, two for each graph
that changes (what is deleted, what is inserted). The statement that it is decided is the moment
from which it counts; whoever claims the endpoint next completes it if its writer cannot.
"""

import os
import socket
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from typing import Any, cast
from uuid import uuid4

from ...ontology.errors import HiltError, StoreError
from ...ontology.vocabulary import Iri, iri, term
from ..rdf.record_mapping import group_pairs
from ..rdf.terms import Literal, Quad, Term, as_sparql, read_time
from ..sparql.query_text import delete_insert, with_prefixes
from ..sparql.results import SelectResult

LEASE_S = 5.0
DECIDED_LEASE_S = 30.0  # while engines make much visible, they keep other writes waiting
GRACE_S = 1.0  # within which a write that was under way when its claim ended is complete
WAIT_S = 60.0  # for other writers
PAUSE_S = 0.015  # between two looks, for each process that comes first
WRITERS = iri("graph", "writers")
CLAIMED_AT, CLAIMED_BY, NUMBER = term("claimedAt"), term("claimedBy"), term("number")
CHANGES, REPLACES, IS_DECIDED = term("changes"), term("replaces"), term("isDecided")
KINDS = ("old", "new")  # of what is prepared
_FIRST, _LAST = iri("graph", "history"), iri("graph", "base")  # of what is made visible

_READ = """SELECT ?claim ?property ?value ?now FROM NAMED graph:writers
WHERE { GRAPH graph:writers { ?claim ?property ?value } BIND(NOW() AS ?now) }"""
_CLAIM = """INSERT { GRAPH graph:writers { ?claim hilt:claimedAt ?now ; hilt:claimedBy ?holder } }
WHERE { VALUES (?claim ?holder) { (%s "%s") } BIND(NOW() AS ?now) }"""
_RENEW = """DELETE { GRAPH graph:writers { ?claim hilt:claimedAt ?at } }
INSERT { GRAPH graph:writers { ?claim hilt:claimedAt ?now } } WHERE { VALUES ?claim { %s }
  GRAPH graph:writers { ?claim hilt:claimedAt ?at } BIND(NOW() AS ?now) }"""
_COMPLETED = """DELETE { GRAPH graph:writers { ?claim hilt:isDecided ?is ; hilt:replaces ?graph } }
WHERE { VALUES ?claim { %s } GRAPH graph:writers { ?claim hilt:isDecided ?is
  OPTIONAL { ?claim hilt:replaces ?graph } } }"""
_END = "DELETE WHERE { GRAPH graph:writers { %s hilt:claimedAt ?at } }"
_REMOVE = "DELETE WHERE { GRAPH graph:writers { %s ?property ?value } }"


@dataclass(frozen=True)
class Claim:
    """A claim as the endpoint has it."""

    node: Iri
    holder: str = ""  #: the process that made it, for people
    #: its place in the order of the waiting; None for one that found no other
    number: int | None = None
    age_s: float | None = None  #: the time since it was made or renewed; None when it was ended
    changes: tuple[Iri, ...] = ()  #: graphs that what is prepared under it changes
    replaces: tuple[Iri, ...] = ()  #: those of them that lose all they had
    is_decided: bool = False  #: whether what is prepared is to be made visible

    @property
    def is_live(self) -> bool:
        """Whether its process counts as alive."""
        lease_s = DECIDED_LEASE_S if self.is_decided else LEASE_S
        return self.age_s is not None and self.age_s <= lease_s

    def comes_before(self, number: int | None, node: Iri) -> bool:
        """Whether a claim with another number, or none yet, must wait for this one."""
        has_lower = not (number and self.number) or (self.number, self.node) < (number, node)
        return self.is_live and has_lower

    def updates(self) -> list[str]:
        """Idempotent updates, in order, that show what is decided, and remove what is prepared."""
        found = list[str]()
        if self.is_decided:
            for one in sorted(self.changes, key=lambda one: (one == _LAST, one != _FIRST, one)):
                old, new = (prepared(self.node, kind, one) for kind in KINDS)
                deleted = one if one in self.replaces else old
                found.append(f"""DELETE {{ GRAPH <{one}> {{ ?a ?b ?c }} }}
INSERT {{ GRAPH <{one}> {{ ?x ?y ?z }} }}
WHERE {{ GRAPH graph:writers {{ <{self.node}> hilt:isDecided ?is }}
  {{ GRAPH <{deleted}> {{ ?a ?b ?c }} }} UNION {{ GRAPH <{new}> {{ ?x ?y ?z }} }} }}""")
            found.append(_COMPLETED % as_sparql(self.node))
        graphs = (prepared(self.node, kind, one) for one in self.changes for kind in KINDS)
        return found + [f"DROP SILENT GRAPH <{one}>" for one in graphs]


def prepared(claim: Iri, kind: str, graph: Iri) -> Iri:
    """The graph with what is to be deleted from another graph, or inserted into it (`KINDS`)."""
    return Iri(f"{claim}/{kind}?{graph}")


class WriteLease:
    """The claims of one process on an endpoint, and what ends those of dead processes.

    `read` gives the rows of a query, `write` sends one update operation, once, and `write_all`
    several, in order; as one unit if the endpoint can do that.
    """

    def __init__(
        self,
        location: str,
        read: Callable[[str], SelectResult],
        write: Callable[[str], None],
        write_all: Callable[[Sequence[str]], None],
    ) -> None:
        self._location, self._read = location, read
        self._write, self._write_all = write, write_all
        self._holder = f"process {os.getpid()} on {socket.gethostname()}"
        self._is_over = threading.Event()
        self.node: Iri | None = None  # of the claim that this process has

    def acquire(self) -> None:
        """Wait for the right to write, and complete or remove what dead writers left.

        StoreError if other processes had it for too long.
        """
        deadline, number = time.monotonic() + WAIT_S, None
        self.node, self._is_over = Iri(f"{WRITERS}/{uuid4().hex}"), threading.Event()
        self._renewal = threading.Thread(target=self._renew, daemon=True)
        self._renewal.start()
        self._update(_CLAIM, self.node, self._holder)
        while True:
            claims = self.claims()
            self.confirmed(claims)
            others = [one for one in claims if one.node != self.node]
            first = [one for one in others if one.comes_before(number, self.node)]
            if not first and self._are_ended([one for one in others if not one.is_live]):
                return
            if number is None:
                number = 1 + max((one.number or 0 for one in claims), default=0)
                self.mark((NUMBER, number))
                continue
            if first and time.monotonic() > deadline:
                raise StoreError(
                    f'The knowledge base "{self._location}" is being written by '
                    f"{first[0].holder}. Try again when that has ended."
                )
            time.sleep(PAUSE_S * len(first))

    def release(self) -> None:
        """Give the right to write back; if the endpoint cannot be reached, it ends by itself."""
        if node := self.abandon():
            with suppress(HiltError):
                self._update(_REMOVE, node)

    def abandon(self) -> Iri | None:
        """Leave this claim, whose node is returned, to the next process, which ends it."""
        node, self.node = self.node, None
        if node:
            self._is_over.set()
            self._renewal.join()
        return node

    def fenced(self, delete: Sequence[Quad], insert: Sequence[Quad]) -> str:
        """The operation that deletes and inserts statements if this claim still counts."""
        where = f"GRAPH <{WRITERS}> {{ <{self.node}> <{CLAIMED_AT}> ?at }}"
        return delete_insert(delete, insert, where=where)

    def mark(self, *properties: tuple[Iri, Term]) -> None:
        """Add properties to this claim if it still counts."""
        node = cast(Iri, self.node)
        self._write(self.fenced([], [Quad(node, *pair, WRITERS) for pair in properties]))

    def confirmed(self, claims: Iterable[Claim] | None = None) -> Claim:
        """This claim, which counted until now, so that all its writes are there.

        StoreError if it was ended by another process.
        """
        for one in self.claims() if claims is None else claims:
            if one.node == self.node and one.age_s is not None:
                return one
        problem = f'This process lost the right to write to "{self._location}",'
        reason = f"because it did not answer for more than {LEASE_S:.0f} s."
        raise StoreError(f"{problem} {reason} Look at the history, and repeat what is missing.")

    def claims(self) -> list[Claim]:
        """All claims, and what is left of those that were ended."""
        found = group_pairs((cast(Iri, row[0]), row[1:]) for row in self._read(_READ).rows)
        return [_claim(node, rows) for node, rows in found.items()]

    def _are_ended(self, dead: Sequence[Claim]) -> bool:
        ended = [one for one in dead if one.age_s is not None]
        for one in ended:
            self._update(_END, one.node)
        if ended:
            time.sleep(GRACE_S)
        nodes = {one.node for one in dead}
        left = [one for one in self.claims() if one.node in nodes] if nodes else []
        if any(one.age_s is not None for one in left):
            return False
        for one in left:
            if one.changes:
                self._write_all(one.updates())
            self._update(_REMOVE, one.node)
        return True

    def _update(self, operation: str, claim: Iri, *values: str) -> None:
        self._write(with_prefixes(operation % (as_sparql(claim), *values)))

    def _renew(self) -> None:
        node, is_over = cast(Iri, self.node), self._is_over
        while not is_over.wait(LEASE_S / 3):
            with suppress(HiltError):
                self._update(_RENEW, node)


def _claim(node: Iri, rows: Sequence[tuple[Any, ...]]) -> Claim:
    found = group_pairs(row[:2] for row in rows)
    ages = [(_moment(rows[0][2]) - _moment(at)).total_seconds() for at in found[CLAIMED_AT]]
    changes, replaces = (tuple(cast("list[Iri]", found[key])) for key in (CHANGES, REPLACES))
    return Claim(
        node,
        next((str(one) for one in found[CLAIMED_BY]), ""),
        next((cast(int, one) for one in found[NUMBER]), None),
        min(ages, default=None),
        changes,
        replaces,
        is_decided=bool(found[IS_DECIDED]),
    )


def _moment(value: Term) -> datetime:
    """The time of the endpoint's clock, which some engines give without a zone."""
    if isinstance(value, datetime):
        return value
    return read_time(f"{value.lexical}Z" if isinstance(value, Literal) else str(value))
