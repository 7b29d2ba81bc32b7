# SPDX-License-Identifier: Apache-2.0
"""How a base that an earlier Hilt wrote becomes one of today.

A base says in which format it is. Each step is one SPARQL update that leads to the next format;
it is applied together with the new number, so a base is always wholly in one format; where the
store is an endpoint that does not do both at once, the number comes last, and the step is done
again. Bases are migrated when they are opened for writing. Steps are never changed once they were
released.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..ontology.errors import StoreError
from ..ontology.vocabulary import term
from .rdf.terms import Quad, Term
from .reader import BASE_GRAPH, BASE_NODE
from .sparql.text import delete_insert, join_updates
from .stores.base import Store

FORMAT = 1  # raised when earlier programs would misread what is written
FORMAT_VERSION = term("formatVersion")

# From a format to the next: the update that does it. Add a step when FORMAT is raised.
STEPS: Mapping[int, str] = {}


def base_format(store: Store) -> Term | None:
    """In which format a store was written; None when it holds no base."""
    found = store.quads(BASE_NODE, FORMAT_VERSION, None, BASE_GRAPH)
    return next((quad.object for quad in found), None)


def migrate(
    store: Store, found: Term, *, steps: Mapping[int, str] = STEPS, to: int = FORMAT
) -> None:
    """Bring a base to a later format, step by step; the write lock is held.

    Args:
        store: what holds the base.
        found: its format.
        steps: from a format to the next.
        to: the format that is wanted.

    Raises:
        StoreError: there is no way, or the store is read only.
    """
    if not isinstance(found, int) or found > to or any(n not in steps for n in range(found, to)):
        raise StoreError(
            f'The knowledge base "{store.location}" has format {found}; this Hilt reads format '
            f"{to}. Use the Hilt that wrote it to export it."
        )
    if found < to and store.read_only:
        raise StoreError(
            f'The knowledge base "{store.location}" has format {found}; open it once for writing '
            f"to bring it to format {to}."
        )
    for number in range(found, to):
        store.update(join_updates(steps[number], _renumber(number)))


def version_quad(number: int) -> Quad:
    """The statement that names the format of a base."""
    return Quad(BASE_NODE, FORMAT_VERSION, number, BASE_GRAPH)


def _renumber(number: int) -> str:
    return delete_insert([version_quad(number)], [version_quad(number + 1)])
