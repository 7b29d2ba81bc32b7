"""Processing of SPARQL texts: bindings, prefixes, paging, updates, errors, and what is refused.

Values are bound as terms in a `VALUES` block at the head of the WHERE group, written by
`terms.as_sparql`; they are never pasted into the text. The tokenizer knows just enough of SPARQL's
lexical grammar (section 19.8 of the recommendation) to tell keywords from strings and comments.

The engine has no option to refuse SERVICE and LOAD, so they are searched for in the text. In
strings, names, IRIs and comments these words are harmless, but whether something is a string or an
IRI depends in SPARQL on what comes before it: `<` opens an IRI or compares, `#` opens a comment or
belongs to an IRI. A text with one of the words that could be read in two ways is refused too. A
parser also accepts words that are joined (`SERVICESILENT<...>`, `1SERVICE`), so a word that
contains one of them is refused.
"""

import re
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from itertools import groupby, pairwise
from typing import TypeAlias, cast

from ...ontology.errors import QueryError
from ...ontology.vocabulary import PREFIXES, Iri
from ..rdf.terms import Quad, Term, as_sparql

# Variable -> its value, or several that are alternatives.
Bindings: TypeAlias = "Mapping[str, Term | Sequence[Term]]"
FORMS = ("SELECT", "ASK", "CONSTRUCT", "DESCRIBE")
# Keywords of external access; DEFINE is one in Virtuoso.
EXTERNAL_ACCESS = frozenset({"SERVICE", "LOAD", "DEFINE"})
VIRTUOSO_FUNCTIONS = ("bif:", "sql:")  # some of them read files

_TOKEN = re.compile(
    r"""
    (?P<comment>\#[^\n\r]*)
  | (?P<string>\"{3}(?:(?:\"|\"\")?(?:[^\"\\]|\\.))*\"{3}|'{3}(?:(?:'|'')?(?:[^'\\]|\\.))*'{3}
             |\"(?:[^\"\\\n\r]|\\.)*\"|'(?:[^'\\\n\r]|\\.)*')
  | (?P<iri><[^\x00-\x20<>\"{}|^`\\]*>)
  | (?P<variable>[?$]\w+)
  | (?P<tag>@[A-Za-z]+(?:-[A-Za-z0-9]+)*)
  | (?P<pname>(?:[^\W\d_][\w.-]{0,99})?:
             (?:(?:[\w:]|%[0-9A-Fa-f]{2}|\\[_~.!$&'()*+,;=/?\#@%-])
                (?:[\w:.-]|%[0-9A-Fa-f]{2}|\\[_~.!$&'()*+,;=/?\#@%-])*)?)
  | (?P<word>\w+)
  | (?P<mark><<|\S)
    """,
    re.VERBOSE | re.DOTALL,
)
_NAME = r"(?:<[^<>\x00-\x20\"{}|^`\\]*>|[?$]\w+|(?:[A-Za-z][\w-]*)?:[\w-]*|a\b)"
_LOOKUP = re.compile(  # a SELECT of one pattern
    rf"""\s*(?:PREFIX\s+[\w-]*:\s*<[^<>\s]*>\s*)*SELECT(?:\s*\*|(?:\s+[?$]\w+)+)\s*(?:WHERE\s*)?
    \{{\s*(?:GRAPH\s+(?P<graph>{_NAME})\s*\{{\s*)?(?P<subject>{_NAME})\s+(?P<key>{_NAME})\s+
    (?P<value>{_NAME}|\"[^\"\\\n\r]*\")\s*(?:\.\s*)?(?(graph)\}}\s*)\}}\s*
    (?:LIMIT\s+(?P<limit>\d{{1,3}})\s*)?""",
    re.VERBOSE | re.IGNORECASE,
)
_POSITION = re.compile(r"(?:error at|at line) (?P<line>\d+)(?::|, column )(?P<column>\d+)")
_CODE_POINT = re.compile(r"\\u([0-9A-Fa-f]{4})|\\U([0-9A-Fa-f]{8})")
_OPERATORS = frozenset("(,=!<>+-*/&|^")  # after these a value is expected, so `<` opens an IRI
_MAYBE_IRI = re.compile(r"<[^<>\x00-\x20\"{}|^`]*>")
_ESCAPES = re.compile(r"(?:[^\\]|\\[tbnrf\\\"'])*", re.DOTALL)  # those that all parsers read alike
_OPEN, _CLOSE = frozenset("([{"), frozenset(")]}")


def bind_variables(query: str, bindings: Bindings) -> str:
    """A query with bound variables; QueryError if it has no WHERE group, or a value is no term."""
    if not bindings:
        return query
    place, blocks = _where_group(query), ""
    for name, value in bindings.items():
        if not re.fullmatch(r"\w+", name):
            raise QueryError(f'"{name}" is not the name of a variable.')
        terms = value if isinstance(value, (list, tuple)) else [cast("Term", value)]
        try:
            blocks += f" VALUES ?{name} {{ {' '.join(map(as_sparql, terms))} }}"
        except ValueError as error:
            raise QueryError(f"The value for ?{name} is wrong: {error}") from error
    return query[:place] + blocks + query[place:]


def query_form(query: str) -> str:
    """The form of a query: SELECT, ASK, CONSTRUCT or DESCRIBE; empty for anything else."""
    return next((word for word in keywords(query) if word in FORMS), "")


def keywords(text: str) -> tuple[str, ...]:
    """The keywords of a text in capitals: what is no name, variable, string, IRI or comment."""
    return tuple(token.group().upper() for token in tokens(text) if token.lastgroup == "word")


def variables(text: str) -> tuple[str, ...]:
    """The names of all variables of a text, sorted, without question mark."""
    found = (token.group() for token in tokens(text) if token.lastgroup == "variable")
    return tuple(sorted({name[1:] for name in found}))


def with_prefixes(text: str) -> str:
    """A text with the prefixes that it uses, and does not declare, declared in its first line."""
    missing = [prefix for prefix in _undeclared_prefixes(text) if prefix in PREFIXES]
    return "".join(f"PREFIX {one}: <{PREFIXES[one]}> " for one in missing) + text


def result_limit(query: str) -> int | None:
    """The LIMIT of a query's result; None when it has none."""
    found = [token.group().upper() for token in _modifiers(query)]
    return next((int(n) for word, n in pairwise(found) if word == "LIMIT" and n.isdigit()), None)


def lookup(query: str, most: int) -> str | None:
    """A query for at most so many rows of another that finds each of them at once; else None.

    It has one pattern, without a condition, and a known subject or a LIMIT below 1,000.
    """
    if not (found := _LOOKUP.fullmatch(query)):
        return None
    terms = [each for each in found.group("graph", "subject", "key", "value") if each]
    unknown = [each[1:] for each in terms if each[0] in "?$"]
    if len({*unknown}) < len(unknown):
        return None
    if found["limit"]:
        return query
    return f"{query} LIMIT {most}" if found["subject"][0] not in "?$" else None


def page_query(query: str, variables: Sequence[str], *, size: int, offset: int) -> str:
    """The query for one page of the solutions of another query, in a stable order.

    The variables are those of a SELECT, none for a CONSTRUCT. QueryError if it cannot be paged.
    """
    modifiers = {token.group().upper() for token in _modifiers(query)}
    if modifiers & {"LIMIT", "OFFSET", "VALUES"} or "FROM" in keywords(query):
        raise QueryError(
            f"The endpoint gives at most {size} rows at once, and a query with LIMIT, OFFSET, "
            f"FROM or VALUES at its end cannot be read in parts. Use a LIMIT of at most {size}."
        )
    page = f"LIMIT {size} OFFSET {offset}"
    if not variables:
        return f"{query}\n{page}"
    start = next(t.start() for t in tokens(query) if t.group().upper() == "SELECT")
    by = " ".join(f"?{name}" for name in variables)
    order = by if "ORDER" in modifiers else f"ORDER BY {by}"
    # A subquery, because some engines sort only so many rows for a page of their own.
    head, body = query[:start], query[start:]
    return f"{head}SELECT {by} WHERE {{ {{ {body}\n{order} }} }} {page}"


def syntax_message(message: str, text: str) -> str:
    """One line that says what is wrong with a text that the engine could not parse."""
    for prefix in _undeclared_prefixes(text):
        if prefix and prefix not in PREFIXES:
            return f'The prefix "{prefix}:" is not declared.'
    if not (match := _POSITION.search(message)):
        return f"The query is wrong: {message.strip().splitlines()[0]}"
    line, column = int(match["line"]), int(match["column"])
    lines = text.splitlines() or [""]
    said = lines[line - 1] if line <= len(lines) else ""
    inside = (t for t in tokens(said) if t.start() < column - 1 < t.end())
    column = next((t.start() + 1 for t in inside if t.lastgroup in {"word", "pname"}), column)
    there = said[column - 1 :].strip()
    found = f'found "{there[:30]}"' if there else "the query ends too early"
    return f"The query is wrong at line {line}, column {column}: {found}."


@contextmanager
def errors_as_typed(typed: str, sent: str) -> Generator[None]:
    """Raise an error in a text that was sent as one in the text that was typed, at its place."""
    try:
        yield
    except QueryError as error:
        if (match := _POSITION.search(str(error))) is None:
            raise
        line, column = int(match["line"]), int(match["column"])
        start = sum(map(len, sent.splitlines(keepends=True)[: line - 1])) + column - 1
        # What was added stands before the place, or after it.
        place = len(typed) - len(sent[start:]) if typed.endswith(sent[start:]) else start
        before = typed[:place]
        line, column = before.count("\n") + 1, place - before.rfind("\n")
        raise QueryError(syntax_message(f"error at {line}:{column}: ", typed)) from error


def insert_data(quads: Sequence[Quad]) -> str:
    """The update that inserts statements."""
    return f"INSERT DATA {{ {_blocks(quads)} }}"


def delete_insert(
    delete: Sequence[Quad], insert: Sequence[Quad], *, where: str = "VALUES ?once { 1 }"
) -> str:
    """The one update operation that deletes statements and inserts others, if `where` is so."""
    # One operation, because `op ; op` is not atomic everywhere; a WHERE that is not empty,
    # because some engines take an empty one for no solution.
    return f"DELETE {{ {_blocks(delete)} }} INSERT {{ {_blocks(insert)} }} WHERE {{ {where} }}"


def refuse_external_access(text: str) -> None:
    """Raise a QueryError for a text that would read from the network or from files."""
    # Some engines read escaped characters before anything else.
    for version in {text, _CODE_POINT.sub(_decoded, text)}:
        is_suspect = any(each in version.lower() for each in VIRTUOSO_FUNCTIONS)
        found = tokens(version if is_suspect else "")
        said = (token.group().lstrip("<").lower()[:60] for token in found)
        function = next((one for one in said if one.startswith(VIRTUOSO_FUNCTIONS)), None)
        if word := next(_forbidden_words(version), function):
            raise QueryError(
                f"{word} is refused: a query reads this knowledge base and nothing else. "
                "Import the data first."
            )


def _blocks(quads: Iterable[Quad]) -> str:
    blocks = list[str]()
    for graph, some in groupby(sorted(quads, key=_graph), key=_graph):
        lines = "\n".join(" ".join(map(as_sparql, quad[:3])) + " ." for quad in some)
        blocks.append(f"GRAPH {as_sparql(Iri(graph))} {{ {lines} }}" if graph else lines)
    return " ".join(blocks)


def _graph(quad: Quad) -> str:
    return quad.graph or ""


@lru_cache(maxsize=256)
def _where_group(query: str) -> int:
    depth, parentheses, before = 0, 0, ""
    for token in tokens(query):
        text = token.group()
        parentheses += (text == "(") - (text == ")")
        if text == "{" and not (depth or parentheses) and before != "CONSTRUCT":  # a template
            return token.end()
        depth += (text == "{") - (text == "}")
        before = text.upper()
    raise QueryError("The query has no WHERE group, so its variables cannot be given values.")


def tokens(text: str, start: int = 0) -> Iterator[re.Match[str]]:
    """The tokens from a position on, without comments; `lastgroup` of each is its kind."""
    return (match for match in _TOKEN.finditer(text, start) if match.lastgroup != "comment")


def _modifiers(query: str) -> list[re.Match[str]]:
    depth, found = 1, list[re.Match[str]]()
    for token in tokens(query, _where_group(query)):
        depth += (token.group() == "{") - (token.group() == "}")
        if depth == 0:
            found.append(token)
    return found[1:]  # the first one is the brace that closes the group


def _undeclared_prefixes(text: str) -> list[str]:
    declared = {
        name.group().partition(":")[0]
        for word, name in pairwise(tokens(text))
        if word.group().upper() == "PREFIX" and name.lastgroup == "pname"
    }
    used = (t.group().partition(":")[0] for t in tokens(text) if t.lastgroup == "pname")
    return [prefix for prefix in dict.fromkeys(used) if prefix not in declared]


def _forbidden_words(text: str) -> Iterator[str]:
    if not (suspects := [word for word in EXTERNAL_ACCESS if word in text.upper()]):
        return
    brackets, before = list[str](), ""
    found = list(tokens(text))
    for token, following in zip(found, [token.group() for token in found[1:]] + [""], strict=True):
        said, kind = token.group(), token.lastgroup
        searched = said.upper() if kind == "word" else ""
        if kind == "pname":
            prefix, _, local = said.upper().partition(":")
            # After a dot, which may end the statement instead of being part of the name.
            yield from (word for word in suspects if f".{word}" in local)
            opens_group = following == "{"  # as after SERVICE; in a pattern other names follow
            if before.upper() != "PREFIX" and (opens_group or not brackets):
                searched = prefix
        yield from (word for word in suspects if word in searched)
        if _is_ambiguous(token, before, "".join(brackets[-1:])):
            yield f"{suspects[0]} in a text that can be read in two ways, at {said[:30]!r},"
        brackets += [said] if said in _OPEN else []
        if said in _CLOSE and brackets:
            brackets.pop()
        before = said


def _is_ambiguous(token: re.Match[str], before: str, bracket: str) -> bool:
    said = token.group()
    match token.lastgroup:
        case "string":
            return not _ESCAPES.fullmatch(said)
        case "iri":  # compares, where a value stands before it in an expression
            return bracket == "(" and before not in _OPERATORS
        case "mark":
            may_be_iri = _MAYBE_IRI.match(token.string, token.start())
            return said == "<<" or (said == "<" and may_be_iri is not None)
        case _:
            return False


def _decoded(match: re.Match[str]) -> str:
    return chr(code) if (code := int(match[1] or match[2], 16)) <= 0x10FFFF else ""
