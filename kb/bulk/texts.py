# SPDX-License-Identifier: Apache-2.0
"""What RDF texts need besides what the engine does to them."""

from __future__ import annotations

import re

from ...ontology.errors import DataError
from ...ontology.vocabulary import PREFIXES, shortened
from ..rdf.terms import Quad

_NOT_IN_XML = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")


def fit_for_xml(quad: Quad) -> Quad:
    """The statement itself; the engine would write what no parser reads."""
    value = quad.object
    found = _NOT_IN_XML.search(value) if isinstance(value, str) else None
    if found:
        raise DataError(
            f"XML cannot hold the character U+{ord(found[0]):04X} of {shortened(quad.subject)}. "
            "Take Turtle, N-Quads or another format.",
            source="RDF/XML",
        )
    return quad


def whole_lines(rest: bytes, chunk: bytes) -> tuple[list[str], bytes]:
    """The lines that are complete with a chunk of a text, and what is left of the last one.

    Args:
        rest: what was left before.
        chunk: what comes after it.

    Raises:
        UnicodeDecodeError: it is no UTF-8.
    """
    whole, end, left = chunk.rpartition(b"\n")
    if not end:
        return [], rest + chunk
    return (rest + whole).decode().split("\n"), left


def with_sorted_prefixes(written: bytes) -> bytes:
    """The text with the prefixes it uses, in our order; the engine's order is a random one."""
    lines = written.split(b"\n")
    count = next((i for i, line in enumerate(lines) if not line.startswith(b"@prefix")), len(lines))
    body = b"\n".join(lines[count:])
    used = set(re.findall(rb"(?<![\w<])([a-z]+):", body))
    head = [
        f"@prefix {prefix}: <{namespace}> .\n"
        for prefix, namespace in PREFIXES.items()
        if prefix.encode() in used
    ]
    return "".join([*head, "\n"]).encode() + body
