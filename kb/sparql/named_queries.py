"""Named queries: commented `.rq` files with a question and declared parameters.

The first comment line of a file is its question. A line `# ?name  kind  meaning` declares a
parameter: the kind says how an argument given as text becomes a term (a kind of individual such
as object, or text, integer, decimal, time). An unbound parameter matches everything.
"""

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
from .query_text import Bindings, variables

QUERIES_FOLDER = Path(__file__).parents[1] / "queries"

_NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")
_PARAMETER = re.compile(r"#\s*\?(\w+)\s+(\w+)\s+(.+)")


@dataclass(frozen=True)
class QueryParameter:
    """A variable of a named query: its name without question mark, its kind, and its meaning."""

    name: str
    kind: str
    meaning: str

    def value(self, text: str) -> Term:
        """The term of an argument given as text; QueryError if it is no value of this kind."""
        if self.kind in KINDS:
            # As tables show it, as ids are printed, as an IRI, or only its name.
            starts = (f"{self.kind}:", f"{self.kind}/", PREFIXES[self.kind])
            start = next((start for start in starts if text.startswith(start)), "")
            local = text.removeprefix(start)
            return iri(self.kind, unquote(local.replace("_", " ")) if start else local)
        try:
            return _VALUES[self.kind](text)
        except (ValueError, InvalidOperation) as error:
            raise QueryError(f'"{text}" is no {self.kind}, as ?{self.name} must be.') from error


@dataclass(frozen=True)
class NamedQuery:
    """A query with its name in `hilt query NAME`, its question in one line, and its parameters."""

    name: str
    question: str
    parameters: Mapping[str, QueryParameter]
    text: str

    def bindings(self, arguments: Mapping[str, str | Sequence[str]]) -> Bindings:
        """The bindings of variables by arguments given as texts; several are alternatives.

        A query that has no name and declares no parameters accepts any of its variables. Others
        raise an UnknownNameError, and an argument that is no value of its kind a QueryError.
        """
        is_declared = bool(self.parameters or self.name)
        known = self.parameters if is_declared else variables(self.text)
        found: dict[str, list[Term]] = {}
        for name, given in arguments.items():
            if name not in known:
                raise UnknownNameError("parameter" if is_declared else "variable", name, known)
            read = self.parameters[name].value if is_declared else parse_term
            found[name] = [read(text) for text in ([given] if isinstance(given, str) else given)]
        return found


@lru_cache(maxsize=64)
def named_query(name: str) -> NamedQuery:
    """The query with a name; UnknownNameError, which lists the names, if there is none."""
    if name not in query_names():
        raise UnknownNameError("query", name, query_names())
    return read_query((QUERIES_FOLDER / f"{name}.rq").read_text(encoding="utf-8"), name)


def read_query(text: str, name: str = "") -> NamedQuery:
    """The query of a text, with the question and the parameters that its comments declare."""
    comments = [line for line in text.splitlines() if line.startswith("#")]
    found = (_PARAMETER.fullmatch(line) for line in comments)
    parameters = {match[1]: QueryParameter(*match.groups()) for match in found if match}
    question = comments[0].removeprefix("#").strip() if comments else ""
    return NamedQuery(name, question, parameters, text)


def parse_term(text: str) -> Term:
    """The term of an argument for a variable whose kind is not declared.

    >>> parse_term("object:wine glass"), parse_term("0.5"), parse_term("knife")
    (Iri('https://w3id.org/hilt/object/wine_glass'), Decimal('0.5'), 'knife')
    """
    kind, _, name = text.partition(":")
    if kind in KINDS and name:
        return iri(kind, unquote(name.replace("_", " ")))
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


_VALUES = {"text": str, "integer": int, "decimal": Decimal, "time": read_time}
