"""Splitting of SPARQL updates into operations: what each selects, and what it deletes and inserts.

An operation deletes and inserts its templates for every solution of its WHERE group. Those that
name whole graphs (CLEAR, DROP, COPY, MOVE, ADD) are read as such operations too; an engine takes
the prefix of `COPY graph:a TO graph:b` for a keyword, and here it is none.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ...ontology.errors import QueryError
from ...ontology.vocabulary import Iri
from ..rdf.terms import Term, as_sparql
from .query_text import keywords, tokens, variables

_ONE = "hilt_one"  # a variable for a query whose templates have none
_ALL = "?hilt_s ?hilt_p ?hilt_o"
_OTHERS = "?hilt_t ?hilt_q ?hilt_r"
_NO_EFFECT = "DROP ALL"  # on an empty store
_DECLARATIONS = {"BASE": 2, "PREFIX": 3}  # with how many tokens they have


@dataclass(frozen=True)
class UpdateOperation:
    """One operation of an update."""

    prologue: str  #: the declarations before it
    graph: str = ""  #: the graph that its WITH names, as it is written; empty without
    #: deleted, inserted: its templates, groups in braces; empty where it has none
    deleted: str = ""
    inserted: str = ""
    where: str = ""  #: its WHERE group; empty where the templates hold as they are
    dataset: str = ""  #: the FROM clauses that its USING clauses amount to

    @property
    def variables(self) -> tuple[str, ...]:
        """The variables of the templates."""
        return variables(f"{self.deleted} {self.inserted}") or (_ONE,)

    def query(self, most: int) -> str:
        """The query for the solutions, at most so many; it has the columns `variables`."""
        is_within = self.graph and not self.dataset
        where = f"{{ GRAPH {self.graph} {self.where} }}" if is_within else self.where
        wanted = " ".join(f"?{name}" for name in self.variables)
        return f"{self.prologue}\nSELECT DISTINCT {wanted} {self.dataset} {where}\nLIMIT {most}"

    def insertion(self, template: str, rows: Sequence[Sequence[Term | None]]) -> str:
        """The update that inserts the statements of a template, given the rows of `query`."""
        names = " ".join(f"?{name}" for name in self.variables)
        cells = (["UNDEF" if one is None else as_sparql(one) for one in row] for row in rows)
        values = "\n".join(f"({' '.join(row)})" for row in cells)
        within = f"WITH {self.graph} " if self.graph else ""
        where = f"WHERE {{ VALUES ({names}) {{ {values} }} }}"
        return f"{self.prologue}\n{within}INSERT {template}\n{where}"


def readable_update(text: str) -> str:
    """An update as an engine reads it, tokens in place; QueryError for none, or of no use here."""
    readable, pieces = text, list(_pieces(text))
    for start, end, _ in reversed(pieces):
        if _graph_operation(text[start:end]):
            blank = re.sub(r"[^\n\r]", " ", text[start:end])
            is_short = "\n" in blank[: len(_NO_EFFECT)]  # then nothing else is on its last line
            rest = blank if is_short else blank[len(_NO_EFFECT) :]
            readable = readable[:start] + _NO_EFFECT + rest + readable[end:]
    if not pieces:
        raise QueryError("The update is empty.")
    return readable


def parse_update(text: str) -> list[UpdateOperation]:
    """Return the operations of an update that an engine can read (`readable_update`)."""
    return [
        _operation(prologue, _graph_operation(text[start:end]) or text[start:end])
        for start, end, prologue in _pieces(text)
    ]


def with_dataset(update: str, default: Sequence[str], named: Sequence[str]) -> str:
    """An update whose groups are evaluated over a default graph and named ones, given as IRIs.

    A QueryError says that it chooses its graphs itself (USING, WITH).
    """
    if not {"USING", "WITH"}.isdisjoint(keywords(update)):
        raise QueryError("The graphs are given twice: in the update (USING, WITH) and beside it.")
    graphs = [f"USING {as_sparql(Iri(one))} " for one in default]
    graphs += [f"USING NAMED {as_sparql(Iri(one))} " for one in named]
    using = "".join(graphs)
    for start, end, _ in reversed([*_pieces(update)]):
        *before, (head, where) = [*_groups(update[start:end])] or [("", "")]
        match keywords(head):
            case ("DELETE", "WHERE"):
                before = [("DELETE ", where)]
            case (*_, "WHERE"):
                pass
            case _:
                continue
        templates = "".join(f"{one}{template}" for one, template in before)
        update = f"{update[:start]}{templates} {using}WHERE {where}{update[end:]}"
    return update


def _pieces(text: str) -> Iterator[tuple[int, int, str]]:
    prologue, depth, found = "", 0, list[re.Match[str]]()
    for token in (*tokens(text), None):
        if token and (depth or token.group() != ";"):
            depth += (token.group() == "{") - (token.group() == "}")
            found.append(token)
            continue
        while found and (size := _DECLARATIONS.get(found[0].group().upper())):
            prologue += text[found[0].start() : found[:size][-1].end()] + "\n"
            found = found[size:]
        if found:
            yield found[0].start(), found[-1].end(), prologue
        found = []


def _graph_operation(text: str) -> str | None:
    words = (token.group() for token in tokens(text))
    verb, *rest = [word if ":" in word else word.upper() for word in words]
    rest = rest[1:] if rest[:1] == ["SILENT"] else rest
    if "DEFAULT" in rest and verb in {"CLEAR", "DROP", "COPY", "MOVE", "ADD"}:
        raise QueryError("A base has no default graph; name one, as graph:beliefs.")
    match verb, [word for word in rest if word != "GRAPH"]:
        case "CLEAR" | "DROP", ["ALL" | "NAMED"]:
            return f"DELETE WHERE {{ GRAPH ?hilt_g {{ {_ALL} }} }}"
        case "CLEAR" | "DROP", [graph]:
            return f"DELETE WHERE {{ GRAPH {graph} {{ {_ALL} }} }}"
        case "CREATE", [_]:  # a graph without statements is none
            return "INSERT DATA { }"
        case "COPY" | "MOVE" | "ADD", [source, "TO", target]:
            read, there = f"GRAPH {source} {{ {_ALL} }}", f"GRAPH {target} {{ {_OTHERS} }}"
            inserted = f"INSERT {{ GRAPH {target} {{ {_ALL} }} }}"
            if verb == "ADD" or source == target:
                return f"{inserted} WHERE {{ {read} }}"
            gone = f"{there} {read}" if verb == "MOVE" else there
            return f"DELETE {{ {gone} }} {inserted} WHERE {{ {{ {read} }} UNION {{ {there} }} }}"
        case _:
            return None


def _operation(prologue: str, text: str) -> UpdateOperation:
    deleted = inserted = where = graph = dataset = ""
    for head, group in _groups(text):
        match keywords(head):
            case (*_, "DELETE", "WHERE"):
                deleted = where = group
            case ("DELETE", "DATA") | (*_, "DELETE"):
                deleted, graph = group, graph or _with(head)
            case ("INSERT", "DATA") | (*_, "INSERT"):
                inserted, graph = group, graph or _with(head)
            case (*_, "WHERE"):
                words = [token.group() for token in tokens(head)][:-1]
                where = group
                dataset = " ".join("FROM" if one.upper() == "USING" else one for one in words)
            case _:
                raise QueryError(f'"{head.strip()[:30]}" is no operation of an update.')
    if not deleted + inserted:
        raise QueryError(f'"{text.strip()[:30]}" is no operation of an update.')
    return UpdateOperation(prologue, graph, deleted, inserted, where, dataset)


def _groups(text: str) -> Iterator[tuple[str, str]]:
    depth, start, place = 0, 0, 0
    for token in tokens(text):
        if token.group() == "{":
            place = token.start() if depth == 0 else place
            depth += 1
        elif token.group() == "}":
            depth -= 1
            if depth == 0:
                yield text[start:place], text[place : token.end()]
                start = token.end()


def _with(head: str) -> str:
    words = [token.group() for token in tokens(head)]
    return words[1] if len(words) > 1 and words[0].upper() == "WITH" else ""
