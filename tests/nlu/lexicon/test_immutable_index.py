"""A mapping that grows without being copied, and whose versions stay as they were."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from hilt.nlu.lexicon.immutable_index import ImmutableIndex

Items = list[tuple[str, int]]

items = st.lists(st.tuples(st.sampled_from("abc"), st.integers(0, 3)), max_size=8)


def listed(index: ImmutableIndex[str, int]) -> dict[str, tuple[int, ...]]:
    """All items of an index by their keys."""
    return {key: index.all(key) for key in index}


def expected(given_items: Items) -> dict[str, tuple[int, ...]]:
    """What an index of these items lists."""
    found: dict[str, dict[int, None]] = {}
    for key, item in given_items:
        found.setdefault(key, {})[item] = None
    return {key: tuple(each) for key, each in found.items()}


@given(items, items, items)
def test_each_version_has_its_own_items(first: Items, second: Items, third: Items) -> None:
    """Two indices made from the same one share nothing but what it has."""
    index = ImmutableIndex(first)
    one, other = index.with_items(second), index.with_items(third)

    assert listed(index) == expected(first)
    assert listed(one) == expected(first + second)
    assert listed(other) == expected(first + third)


@given(items)
def test_a_key_is_mapped_to_its_first_item(given_items: Items) -> None:
    """As a mapping it has one item for each key."""
    assert ImmutableIndex(given_items) == dict(reversed(given_items))


@given(items, items)
def test_items_are_added_once(first: Items, second: Items) -> None:
    """To add what an index has already changes nothing."""
    index = ImmutableIndex(first + second)

    assert listed(index.with_items(first)) == listed(index)
