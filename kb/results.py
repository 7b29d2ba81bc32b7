# SPDX-License-Identifier: Apache-2.0
"""What a query found, and how it is printed: SPARQL 1.1 Query Results JSON."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from .terms import STRING, Iri, Quad, Term, lexical

BLANK = "_:"  # how the name of a blank node begins


@dataclass(frozen=True)
class Solutions:
    """The rows that a query found.

    Attributes:
        variables: names of the columns, without question mark.
        rows: one value a variable; None where it is unbound.
    """

    variables: tuple[str, ...]
    rows: tuple[tuple[Term | None, ...], ...]

    @classmethod
    def of_statements(cls, quads: Iterable[Quad]) -> Solutions:
        """The rows of a CONSTRUCT: one a statement."""
        return cls(("subject", "predicate", "object"), tuple(quad[:3] for quad in quads))

    def __iter__(self) -> Iterator[tuple[Term | None, ...]]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def as_json(self) -> dict[str, object]:
        """The document of the W3C recommendation."""
        return {
            "head": {"vars": list(self.variables)},
            "results": {"bindings": [self._binding(row) for row in self.rows]},
        }

    def _binding(self, row: tuple[Term | None, ...]) -> dict[str, dict[str, str]]:
        named = zip(self.variables, row, strict=True)
        return {name: _value(term) for name, term in named if term is not None}


@dataclass(frozen=True)
class Answer:
    """What an ASK query found."""

    value: bool

    def as_json(self) -> dict[str, object]:
        """The document of the W3C recommendation."""
        return {"head": {}, "boolean": self.value}


def _value(term: Term) -> dict[str, str]:
    if isinstance(term, Iri):
        if term.startswith(BLANK):
            return {"type": "bnode", "value": term.removeprefix(BLANK)}
        return {"type": "uri", "value": str(term)}
    text, datatype, language = lexical(term)
    written = {"type": "literal", "value": text}
    if language:
        return written | {"xml:lang": language}
    return written if datatype == STRING else written | {"datatype": datatype}
