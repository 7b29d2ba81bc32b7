"""The pause of the garbage collector."""

import gc
from collections.abc import Callable, Iterator

import pytest

from hilt.ontology.garbage_collection import paused_garbage_collection


@pytest.fixture(autouse=True)
def enabled_afterwards() -> Iterator[None]:
    """Enable the collector after each test."""
    yield
    gc.enable()


@pytest.mark.parametrize("switch", [gc.enable, gc.disable])
def test_collector_is_off_within_the_pause_and_then_as_before(switch: Callable[[], None]):
    """A collector that was off before stays off."""
    switch()
    before = gc.isenabled()

    with paused_garbage_collection():
        within = gc.isenabled()

    assert not within
    assert gc.isenabled() == before


def test_error_ends_the_pause():
    """The collector is on again after an exception."""
    with pytest.raises(ZeroDivisionError), paused_garbage_collection():
        1 / 0  # noqa: B018

    assert gc.isenabled()
