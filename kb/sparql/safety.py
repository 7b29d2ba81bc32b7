"""Refusal of queries and updates that access the network or files.

The engine has no option to refuse SERVICE and LOAD, so they are searched for in the text. In
strings, names, IRIs and comments these words are harmless, but whether something is a string or an
IRI depends in SPARQL on what comes before it: `<` opens an IRI or compares, `#` opens a comment or
belongs to an IRI. A text with one of the words that could be read in two ways is refused too. A
parser also accepts words that are joined (`SERVICESILENT<...>`, `1SERVICE`), so a word that
contains one of them is refused.
"""

import re
from collections.abc import Iterator

from ...ontology.errors import QueryError
from .query_text import tokens

# Keywords of external access; DEFINE is one in Virtuoso.
EXTERNAL_ACCESS = frozenset({"SERVICE", "LOAD", "DEFINE"})
VIRTUOSO_FUNCTIONS = ("bif:", "sql:")  # some of them read files

_CODE_POINT = re.compile(r"\\u([0-9A-Fa-f]{4})|\\U([0-9A-Fa-f]{8})")
_OPERATORS = frozenset("(,=!<>+-*/&|^")  # after these a value is expected, so `<` opens an IRI
_MAYBE_IRI = re.compile(r"<[^<>\x00-\x20\"{}|^`]*>")
_ESCAPES = re.compile(r"(?:[^\\]|\\[tbnrf\\\"'])*", re.DOTALL)  # those that all parsers read alike
_OPEN, _CLOSE = frozenset("([{"), frozenset(")]}")


def refuse_external_access(text: str) -> None:
    """Raise a QueryError for a text that would read from the network or from files."""
    # Some engines read escaped characters before anything else.
    for version in {text, _CODE_POINT.sub(_decoded, text)}:
        said = (token.group().lstrip("<").lower()[:60] for token in tokens(version))
        function = next((one for one in said if one.startswith(VIRTUOSO_FUNCTIONS)), None)
        found = _forbidden_word(version) or function
        if found:
            raise QueryError(
                f"{found} is refused: a query reads this knowledge base and nothing else. "
                "Import the data first."
            )


def _forbidden_word(text: str) -> str | None:
    capitals = text.upper()
    suspects = [word for word in EXTERNAL_ACCESS if word in capitals]
    return next(_keywords(text, suspects), None) if suspects else None


def _keywords(text: str, suspects: list[str]) -> Iterator[str]:
    brackets, before = list[str](), ""
    found = list(tokens(text))
    after = [token.group() for token in found[1:]] + [""]
    for token, following in zip(found, after, strict=True):
        said, kind = token.group(), token.lastgroup
        if kind == "word":
            yield from _contained(said, suspects)
        elif kind == "pname":
            yield from _joined_to_name(said, suspects, before, following, depth=len(brackets))
        if _is_ambiguous(token, before, "".join(brackets[-1:])):
            yield f"{suspects[0]} in a text that can be read in two ways, at {said[:30]!r},"
        brackets += [said] if said in _OPEN else []
        if said in _CLOSE and brackets:
            brackets.pop()
        before = said


def _contained(said: str, suspects: list[str]) -> Iterator[str]:
    return (word for word in suspects if word in said.upper())


def _joined_to_name(
    name: str, suspects: list[str], before: str, following: str, *, depth: int
) -> Iterator[str]:
    prefix, _, local = name.upper().partition(":")
    is_declared_here = before.upper() == "PREFIX"
    opens_group = following == "{"  # as after SERVICE; names in a pattern are followed by others
    if not is_declared_here and (opens_group or depth == 0):
        yield from _contained(prefix, suspects)
    # After a dot, which may end the statement instead of being part of the name.
    yield from (word for word in suspects if f".{word}" in local)


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
    code = int(match.group(1) or match.group(2), 16)
    return chr(code) if code <= 0x10FFFF else ""
