"""Shared index: an immutable mapping to which adding costs only what is added.

All versions of an index write to one log and see it up to their own size (a fully persistent
append-only list after Driscoll et al. 1989, without the version tree). Only what is added to a
version that is not the newest is preceded by a copy.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain
from typing import Generic, TypeVar

Key = TypeVar("Key")
Item = TypeVar("Item")


@dataclass
class _Log(Generic[Key, Item]):
    items: dict[Key, list[tuple[int, Item]]] = field(default_factory=dict)
    size: int = 0


class ImmutableIndex(Mapping[Key, Item]):
    """A mapping from each key to its first item, which also has the later ones."""

    def __init__(self, items: Iterable[tuple[Key, Item]] = ()) -> None:
        self._log: _Log[Key, Item] = _Log()
        self._size = 0
        self._append(items)

    def with_items(self, items: Iterable[tuple[Key, Item]]) -> ImmutableIndex[Key, Item]:
        """Return this index with further items; an item that a key has already is left out."""
        if self._log.size > self._size:  # another version has written to the log
            own = ((key, item) for key in self for item in self.all(key))
            return ImmutableIndex(chain(own, items))
        added = ImmutableIndex[Key, Item]()
        added._log, added._size = self._log, self._size
        added._append(items)
        return added

    def all(self, key: Key) -> tuple[Item, ...]:
        """All items of a key in the order in which they were added."""
        found = self._log.items.get(key, ())
        return tuple(item for number, item in found if number < self._size)

    def __getitem__(self, key: Key) -> Item:
        number, item = self._log.items[key][0]
        if number >= self._size:
            raise KeyError(key)
        return item

    def __iter__(self) -> Iterator[Key]:
        for key, found in self._log.items.items():
            if found[0][0] >= self._size:
                return  # keys are in the order of their first items
            yield key

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _append(self, items: Iterable[tuple[Key, Item]]) -> None:
        log = self._log
        for key, item in items:
            if key not in log.items or item not in self.all(key):
                log.items.setdefault(key, []).append((log.size, item))
                log.size = self._size = log.size + 1
