"""Claims about the right to write to an endpoint that several processes share."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.rdf.terms import Quad
from hilt.kb.stores import remote, write_lease
from hilt.kb.stores.remote import RemoteStore
from hilt.kb.stores.write_lease import WRITERS
from hilt.ontology.errors import StoreError
from hilt.ontology.vocabulary import Iri, iri

from ..endpoints import InMemoryEndpoint

S, P = (Iri(f"urn:{name}") for name in "sp")
BELIEFS, HISTORY = iri("graph", "beliefs"), iri("graph", "history")
OLD = {Quad(S, P, number, graph) for number in range(7) for graph in (BELIEFS, HISTORY)}
NEW = {Quad(S, P, number, graph) for number in range(5, 25) for graph in (BELIEFS, HISTORY)}


@pytest.fixture(autouse=True, scope="module")
def small_and_quick() -> Iterator[None]:
    """Few statements are many here, and nothing is under way when a claim ends."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(write_lease, "GRACE_S", 0.0)
        patch.setattr(remote, "BATCH", 10)
        patch.setattr(remote, "POSTED", 30)
        yield


def number(value: int) -> Quad:
    """A statement with a value."""
    return Quad(S, P, value, BELIEFS)


def die(store: RemoteStore, endpoint: InMemoryEndpoint) -> None:
    """Let the process of a store end, and its lease."""
    store._lease.abandon()
    endpoint.stop_after = None
    endpoint.pass_time()


def contents(endpoint: InMemoryEndpoint) -> set[Quad]:
    """All statements of the base, and nothing else, at the endpoint."""
    store = endpoint.open()
    found = set(store.quads())
    assert len(endpoint.store) == len(found), "something is left over"
    return found


def test_right_to_write_is_given_back():
    """What is written is there, and no claim."""
    endpoint = InMemoryEndpoint()
    store = endpoint.open()

    store.apply(insert=[number(1)])
    with store.writing(), store.writing():
        store.apply(insert=[number(2)], delete=[number(1)])

    assert contents(endpoint) == {number(2)}


def test_one_process_writes_at_a_time():
    """Three that count up together reach the sum."""
    endpoint = InMemoryEndpoint()
    endpoint.open().apply(insert=[number(0)])

    def count() -> None:
        store = endpoint.open()
        for _ in range(10):
            with store.writing():
                (now,) = store.quads(S, P, None, BELIEFS)
                store.apply(delete=[now], insert=[number(int(str(now.object)) + 1)])

    threads = [threading.Thread(target=count) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert contents(endpoint) == {number(30)}


def test_process_that_lives_is_waited_for_and_named(monkeypatch: pytest.MonkeyPatch):
    """It renews its claim; who waits too long is told who writes."""
    monkeypatch.setattr(write_lease, "LEASE_S", 0.6)
    monkeypatch.setattr(write_lease, "WAIT_S", 1.0)
    endpoint = InMemoryEndpoint()
    store, other = endpoint.open(), endpoint.open()

    with store.writing():
        with pytest.raises(StoreError, match=r"is being written by process \d+ on "):
            other.apply(insert=[number(1)])
        store.apply(insert=[number(2)])

    assert contents(endpoint) == {number(2)}


def test_dead_process_is_not_waited_for_long():
    """Its claim ends, and what it writes afterwards does not count."""
    endpoint = InMemoryEndpoint()
    stalled, other = endpoint.open(), endpoint.open()

    def stall() -> None:
        with stalled.writing():
            claim = stalled._lease.node
            die(stalled, endpoint)
            other.apply(insert=[number(1)])
            stalled._lease.node = claim
            stalled.apply(insert=[number(2)])

    with pytest.raises(StoreError, match="lost the right to write"):
        stall()

    assert contents(endpoint) == {number(1)}


@pytest.mark.parametrize("replaces", [False, True])
@pytest.mark.parametrize("graphs", [None, "http://h/store"])
@pytest.mark.parametrize("server", ["", "Virtuoso"])
def test_large_write_is_whole_wherever_it_stops(replaces: bool, graphs: str | None, server: str):
    """After any number of requests; the next process finds the old base or the new one."""
    found = list[bool]()
    while not found or not all(found[-3:]):
        endpoint = InMemoryEndpoint(server)
        endpoint.open().apply(insert=OLD)
        store = endpoint.open(graphs=graphs)
        with suppress(StoreError), store.writing():
            endpoint.stop_after = len(found) + 1
            store.replace(NEW) if replaces else store.apply(insert=NEW, delete=OLD)
        die(store, endpoint)
        there = contents(endpoint)
        assert there in (OLD, NEW)
        found.append(there == NEW)

    assert found == sorted(found) and not found[0]


@settings(max_examples=15)
@given(stops=st.lists(st.integers(1, 20), max_size=4))
def test_what_is_left_is_completed_by_whoever_lives(stops: list[int]):
    """Those who complete it may die, too."""
    endpoint = InMemoryEndpoint("Virtuoso")
    endpoint.open().apply(insert=OLD)
    for stop in [*stops, None]:
        store = endpoint.open()
        endpoint.stop_after = stop
        with suppress(StoreError):
            store.apply(insert=NEW, delete=OLD)
        die(store, endpoint)

    assert contents(endpoint) == NEW


def test_reader_completes_what_was_decided():
    """As soon as it opens the base, though it writes nothing of its own."""
    whole, endpoint = InMemoryEndpoint(), InMemoryEndpoint()
    whole.open().apply(insert=NEW)
    store = endpoint.open()
    endpoint.stop_after = 1 + next(n for n, one in enumerate(whole.updates) if "isDecided" in one)
    with pytest.raises(StoreError, match="cannot be reached"):
        store.apply(insert=NEW)
    die(store, endpoint)

    assert set(endpoint.open(read_only=True).quads()) == NEW


def test_claims_are_no_part_of_the_base():
    """No query sees the graph that holds them."""
    endpoint = InMemoryEndpoint()
    store = endpoint.open()

    with store.writing():
        assert [one.is_live for one in store._lease.claims()] == [True]
        assert list(store.quads()) == list(store.quads(graph=WRITERS)) == []
