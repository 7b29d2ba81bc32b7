# SPDX-License-Identifier: Apache-2.0
"""What a query or an update must not do: reach outside the base, or differ each time.

The engine cannot be told to refuse SERVICE and LOAD, so they are found in the text. Words that
stand in strings, names, IRIs and comments are harmless, but whether something is a string or an
IRI depends in SPARQL on what comes before it: `<` opens an IRI or compares, `#` opens a comment or
belongs to an IRI. Where a text that says one of the words could be read in two ways, it is
refused too. A parser also takes words that are glued together (`SERVICESILENT<...>`, `1SERVICE`),
so it is enough that a word contains one of them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from ...ontology.errors import QueryError
from .text import tokens

# What makes an engine fetch something from elsewhere; DEFINE does so in Virtuoso.
REACHING_OUT = frozenset({"SERVICE", "LOAD", "DEFINE"})
CHANCE = frozenset({"RAND", "UUID", "STRUUID", "NOW", "BNODE"})
OF_ONE_ENGINE = ("bif:", "sql:")  # functions of Virtuoso, some of which read files

_CODE_POINT = re.compile(r"\\u([0-9A-Fa-f]{4})|\\U([0-9A-Fa-f]{8})")
_OPERATORS = frozenset("(,=!<>+-*/&|^")  # after these a value is expected, so `<` opens an IRI
_MAYBE_IRI = re.compile(r"<[^<>\x00-\x20\"{}|^`]*>")
_ESCAPES = re.compile(r"(?:[^\\]|\\[tbnrf\\\"'])*", re.DOTALL)  # those that all parsers read alike
_OPEN, _CLOSE = frozenset("([{"), frozenset(")]}")


def refuse_external_access(text: str) -> None:
    """Refuse a query or update that would read from the network or from files.

    Raises:
        QueryError: it says SERVICE or LOAD, in any spelling.
    """
    # Some engines read escaped characters before anything else.
    for version in {text, _CODE_POINT.sub(_decoded, text)}:
        found = _said(version, REACHING_OUT) or _function_of_one_engine(version)
        if found:
            raise QueryError(
                f"{found} is refused: a query reads this knowledge base and nothing else. "
                "Import the data first."
            )


def refuse_nondeterminism(update: str) -> None:
    """Refuse an update that would not do the same a second time.

    It is tried out on a copy before it is applied, and both must come to the same.

    Raises:
        QueryError: it calls RAND, UUID, NOW or the like.
    """
    found = _said(update, CHANCE)
    if found:
        raise QueryError(
            f"{found} is refused in an update: it must do the same each time. "
            "Write the value itself."
        )


def _said(text: str, refused: Iterable[str]) -> str | None:
    """One of the words, where the text says it as a keyword or may do so."""
    capitals = text.upper()
    suspects = [word for word in refused if word in capitals]
    if not suspects:
        return None
    return next(_keywords(text, suspects), None)


def _keywords(text: str, suspects: list[str]) -> Iterator[str]:
    brackets, before = list[str](), ""
    found = list(tokens(text))
    after = [token.group() for token in found[1:]] + [""]
    for token, following in zip(found, after, strict=True):
        said, kind = token.group(), token.lastgroup
        if kind == "word":
            yield from _within(said, suspects)
        elif kind == "pname":
            yield from _glued(said, suspects, before, following, depth=len(brackets))
        if _is_unsure(token, before, "".join(brackets[-1:])):
            yield f"{suspects[0]} in a text that can be read in two ways, at {said[:30]!r},"
        brackets += [said] if said in _OPEN else []
        if said in _CLOSE and brackets:
            brackets.pop()
        before = said


def _within(said: str, suspects: list[str]) -> Iterator[str]:
    return (word for word in suspects if word in said.upper())


def _glued(
    name: str, suspects: list[str], before: str, following: str, *, depth: int
) -> Iterator[str]:
    """Keywords that a parser may read at the start of what looks like a prefixed name."""
    prefix, _, local = name.upper().partition(":")
    is_declared_here = before.upper() == "PREFIX"
    opens_group = following == "{"  # as after SERVICE; names in a pattern are followed by others
    if not is_declared_here and (opens_group or depth == 0):
        yield from _within(prefix, suspects)
    # After a dot, which may end the statement instead of being part of the name.
    yield from (word for word in suspects if f".{word}" in local)


def _is_unsure(token: re.Match[str], before: str, bracket: str) -> bool:
    """Whether another parser may see something else here."""
    said = token.group()
    match token.lastgroup:
        case "string":
            return not _ESCAPES.fullmatch(said)
        case "iri":  # compares, where a value stands before it in an expression
            return bracket == "(" and before not in _OPERATORS
        case "mark":
            return said == "<<" or (said == "<" and _may_be_iri(token))
        case _:
            return False


def _may_be_iri(token: re.Match[str]) -> bool:
    return _MAYBE_IRI.match(token.string, token.start()) is not None


def _function_of_one_engine(text: str) -> str | None:
    said = (token.group().lstrip("<").lower() for token in tokens(text))
    return next((one[:60] for one in said if one.startswith(OF_ONE_ENGINE)), None)


def _decoded(match: re.Match[str]) -> str:
    code = int(match.group(1) or match.group(2), 16)
    return chr(code) if code <= 0x10FFFF else ""
