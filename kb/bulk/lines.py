# SPDX-License-Identifier: Apache-2.0
"""Lines of N-Quads, written some at a time, and those that say where a million rules come from."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from typing import Protocol

from ...ontology.vocabulary import PREFIXES, Iri
from ..history import ASSERTS, HISTORY
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import Quad, as_sparql

_MAX_KNOWN = 200_000  # names that are remembered
_MAX_HELD = 2**20  # characters that are written at once
_RULES, _UTTERANCES = PREFIXES["rule"], PREFIXES["utterance"]
_END, _HISTORY_END = (f" {as_sparql(graph)} .\n" for graph in (BELIEFS, HISTORY))


def _keys(*names: Iri) -> tuple[str, ...]:
    return tuple(f" {as_sparql(name)} " for name in names)


_SOURCE, _TIME, _ASSERTS = _keys(rule_mapping.DERIVED_FROM, rule_mapping.GENERATED_AT, ASSERTS)


class LineSink(Protocol):
    """Where the lines go."""

    def write(self, chunk: bytes, /) -> object:
        """Take some whole lines."""
        ...


class LineWriter:
    """Writes rules and statements as lines; names that come again are written from memory."""

    def __init__(self, stream: LineSink) -> None:
        self._stream = stream
        self._names: dict[Iri, str] = {}
        self._held: list[str] = []
        self._size = 0

    def text(self, lines: str) -> None:
        """Lines as they are."""
        self._write(lines)

    def told(self, numbers: Iterable[int], utterance: int) -> None:
        """From which utterance some rules come, given by the numbers in their names."""
        end = f">{_SOURCE}<{_UTTERANCES}{utterance}>{_END}"
        self._write("".join([f"<{_RULES}{number:016x}{end}" for number in numbers]))

    def asserted(self, utterance: int, numbers: Iterable[int]) -> None:
        """Which rules an utterance asserts."""
        start = f"<{_UTTERANCES}{utterance}>{_ASSERTS}<{_RULES}"
        said = [f"{start}{number:016x}>{_HISTORY_END}" for number in numbers]
        self._write("".join(said))

    def believed(self, numbers: Iterable[int], moment: datetime) -> None:
        """Since when some rules are believed."""
        end = f">{_TIME}{as_sparql(moment)}{_END}"
        self._write("".join([f"<{_RULES}{number:016x}{end}" for number in numbers]))

    def quads(self, quads: Iterable[Quad]) -> None:
        """Other statements."""
        for subject, key, value, graph in quads:
            end = self._text(value) if isinstance(value, Iri) else as_sparql(value)
            self._write(
                f"{self._text(subject)} {self._text(key)} {end} {self._text(graph or BELIEFS)} .\n"
            )

    def _text(self, node: Iri) -> str:
        known = self._names.get(node)
        if known is None:
            if len(self._names) > _MAX_KNOWN:
                self._names.clear()
            known = self._names[node] = as_sparql(node)
        return known

    def flush(self) -> None:
        """Write what is still held."""
        self._stream.write("".join(self._held).encode())
        self._held.clear()
        self._size = 0

    def _write(self, text: str) -> None:
        self._held.append(text)
        self._size += len(text)
        if self._size > _MAX_HELD:
            self.flush()
