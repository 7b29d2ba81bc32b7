# SPDX-License-Identifier: Apache-2.0
"""Migration of bases that an earlier version of Hilt wrote to the present format.

A base names its format. Each step is one SPARQL update to the next format; it is applied together
with the new number, so a base is always wholly in one format. At an endpoint that does not apply
both at once the number comes last, and the step is repeated. Bases are migrated when they are
opened for writing. Steps are never changed after their release.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..ontology.errors import StoreError
from ..ontology.vocabulary import term
from .rdf.terms import Quad, Term
from .reader import BASE_GRAPH, BASE_NODE
from .sparql.text import delete_insert, join_updates
from .stores.base import Store

FORMAT = 1  # raised when earlier versions would misread what is written
FORMAT_VERSION = term("formatVersion")

# Format -> the update to the next one. Add a step when FORMAT is raised.
STEPS: Mapping[int, str] = {}


def base_format(store: Store) -> Term | None:
    """The format in which a store was written; None when it holds no base."""
    found = store.quads(BASE_NODE, FORMAT_VERSION, None, BASE_GRAPH)
    return next((quad.object for quad in found), None)


def migrate(
    store: Store, found: Term, *, steps: Mapping[int, str] = STEPS, to: int = FORMAT
) -> None:
    """Bring a base to a later format, step by step; the caller holds the write lock.

    Args:
        store: the store of the base.
        found: its format.
        steps: format -> the update to the next one.
        to: the wanted format.

    Raises:
        StoreError: there is no step, or the store is read-only.
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
