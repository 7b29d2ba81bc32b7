# SPDX-License-Identifier: Apache-2.0
"""The questions that the base answers, each a commented `.rq` file that anybody can run.

The first comment line of a file is its question. A line `# ?name  kind  meaning` declares a
parameter: the kind says how an argument given as text becomes a term (a kind of individual such
as object, or text, integer, decimal, time). Unbound parameters ask for all.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from functools import lru_cache
from pathlib import Path
from urllib.parse import unquote

from ...ontology.errors import QueryError, UnknownNameError
from ...ontology.vocabulary import KINDS, PREFIXES, Iri, iri
from ..rdf.terms import Term, read_time
from .text import Bindings, variables

QUERIES_FOLDER = Path(__file__).parents[1] / "queries"

_NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")
_PARAMETER = re.compile(r"#\s*\?(\w+)\s+(\w+)\s+(.+)")


@dataclass(frozen=True)
class Parameter:
    """A variable of a named query that can be given a value.

    Attributes:
        name: the variable, without question mark.
        kind: how a text becomes its value.
        meaning: what it is, for the help.
    """

    name: str
    kind: str
    meaning: str

    def value(self, text: str) -> Term:
        """The term that an argument stands for.

        Raises:
            QueryError: the text is no value of this kind.
        """
        if self.kind in KINDS:
            # As tables show it, as ids are printed, as its whole address, or only its name.
            starts = (f"{self.kind}:", f"{self.kind}/", PREFIXES[self.kind])
            start = next((start for start in starts if text.startswith(start)), "")
            return _printed(self.kind, text.removeprefix(start)) if start else iri(self.kind, text)
        try:
            return _VALUES[self.kind](text)
        except (ValueError, InvalidOperation) as error:
            raise QueryError(f'"{text}" is no {self.kind}, as ?{self.name} must be.') from error


@dataclass(frozen=True)
class NamedQuery:
    """A question with its text.

    Attributes:
        name: as `hilt query NAME` calls it.
        question: one line that a person reads.
        parameters: by name, in the order of the file.
        text: the SPARQL.
    """

    name: str
    question: str
    parameters: Mapping[str, Parameter]
    text: str

    def bindings(self, arguments: Mapping[str, str | Sequence[str]]) -> Bindings:
        """Values for the variables, from arguments given as texts; several are alternatives.

        A query that has no name and declares no parameters takes values for any variable.

        Raises:
            UnknownNameError: there is no such parameter or variable.
            QueryError: an argument is no value of its kind.
        """
        return {
            name: [self._value(name, text) for text in _as_list(given)]
            for name, given in arguments.items()
        }

    def _value(self, name: str, text: str) -> Term:
        if self.parameters or self.name:
            if name not in self.parameters:
                raise UnknownNameError("parameter", name, self.parameters)
            return self.parameters[name].value(text)
        known = variables(self.text)
        if name not in known:
            raise UnknownNameError("variable", name, known)
        return parse_term(text)


@lru_cache(maxsize=64)
def named_query(name: str) -> NamedQuery:
    """The query of a name.

    Raises:
        UnknownNameError: there is none; lists those there are.
    """
    if name not in query_names():
        raise UnknownNameError("query", name, query_names())
    return read_query((QUERIES_FOLDER / f"{name}.rq").read_text(encoding="utf-8"), name)


def read_query(text: str, name: str = "") -> NamedQuery:
    """A query with the question and the parameters that its comments declare.

    Args:
        text: the SPARQL.
        name: what it is called; empty for one that somebody wrote just now.
    """
    comments = [line for line in text.splitlines() if line.startswith("#")]
    found = (_PARAMETER.fullmatch(line) for line in comments)
    parameters = {match[1]: Parameter(*match.groups()) for match in found if match}
    question = comments[0].removeprefix("#").strip() if comments else ""
    return NamedQuery(name, question, parameters, text)


def parse_term(text: str) -> Term:
    """The term that a person writes for a value whose kind nobody declared.

    >>> parse_term("object:wine glass"), parse_term("0.5"), parse_term("knife")
    (Iri('https://w3id.org/hilt/object/wine_glass'), Decimal('0.5'), 'knife')
    """
    kind, _, name = text.partition(":")
    if kind in KINDS and name:
        return _printed(kind, name)
    if kind in PREFIXES and name:
        return Iri(PREFIXES[kind] + name)
    if kind in {"http", "https", "urn"}:
        return Iri(text)
    if _NUMBER.fullmatch(text):
        return Decimal(text) if "." in text else int(text)
    return text


def query_names() -> tuple[str, ...]:
    """The names of all queries, sorted."""
    return tuple(sorted(path.stem for path in QUERIES_FOLDER.glob("*.rq")))


def node_iri(node: str) -> Iri:
    """The IRI of an action-tree node, from its key ("pass.graspObject")."""
    return iri("node", node)


def _printed(kind: str, local: str) -> Iri:
    """An individual from the last part of its IRI; spaces need not be escaped."""
    return iri(kind, unquote(local.replace("_", " ")))


def _as_list(given: str | Sequence[str]) -> Sequence[str]:
    return [given] if isinstance(given, str) else given


_VALUES = {
    "text": str,
    "integer": int,
    "decimal": Decimal,
    "time": read_time,
}
