# SPDX-License-Identifier: Apache-2.0
"""The collector rests while a language is built or an utterance understood, and goes on after."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from hilt.nlu.building import building, without_collecting


@pytest.fixture(autouse=True)
def collecting() -> Iterator[None]:
    """The collector runs before and after."""
    gc.enable()
    yield
    gc.enable()


@pytest.mark.parametrize("quiet", [without_collecting, building])
def test_nothing_is_collected_within(quiet: object) -> None:
    """And the result is the same."""
    assert callable(quiet)

    assert quiet(gc.isenabled)() is False
    assert gc.isenabled()


def test_what_somebody_else_switched_off_stays_off() -> None:
    """A program may have its own reasons."""
    gc.disable()

    without_collecting(list)()

    assert not gc.isenabled()


def test_an_error_switches_it_on_again() -> None:
    """However the function ends."""
    with pytest.raises(ZeroDivisionError):
        without_collecting(lambda: 1 // 0)()

    assert gc.isenabled()
