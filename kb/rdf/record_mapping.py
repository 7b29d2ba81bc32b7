"""Mapping of dataclasses to RDF properties, and back, by a table with one entry for each field."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from ...ontology.errors import ValidationError
from ...ontology.vocabulary import Iri, shortened, split
from .terms import Term

PropertyValues: TypeAlias = "defaultdict[Iri, list[Term]]"
REQUIRED = object()  # the default of a field that is always stored


@dataclass(frozen=True)
class FieldProperty:
    """The property that stores a field.

    Attributes:
        predicate: its IRI.
        kind: the type of its values as terms.
        encode, decode: from a value of the field to a term, and back.
        default: the value that is not stored; () for a field with several values.
    """

    predicate: Iri
    kind: type
    encode: Callable[[Any], Term] = lambda value: value
    decode: Callable[[Any], Any] = lambda value: value
    default: object = REQUIRED


def group_properties(properties: Iterable[tuple[Iri, Term]]) -> PropertyValues:
    """The values of each property of a node."""
    found: PropertyValues = defaultdict(list)
    for predicate, value in properties:
        found[predicate].append(value)
    return found


def record_properties(
    record: object, fields: Mapping[str, FieldProperty]
) -> Iterator[tuple[Iri, Term]]:
    """The properties of a record, in the order of its fields in the table."""
    for name, field in fields.items():
        value = getattr(record, name)
        if value != field.default:
            for one in value if isinstance(value, tuple) else (value,):
                yield field.predicate, field.encode(one)


def read_fields(
    found: PropertyValues, fields: Mapping[str, FieldProperty], what: str
) -> dict[str, Any]:
    """The fields of a record; ValidationError if one is missing or malformed.

    `what` is the name of such a record in messages, as "An utterance".
    """
    return {
        name: _read_field(found[field.predicate], field, what) for name, field in fields.items()
    }


def local_name(node: Iri) -> str:
    """The name of an individual, without its kind."""
    return split(node)[1]


def _read_field(values: list[Term], field: FieldProperty, what: str) -> object:
    if field.default == ():
        return tuple(sorted(map(field.decode, values)))
    if not values and field.default is not REQUIRED:
        return field.default
    if len(values) != 1 or not isinstance(values[0], field.kind):
        expected = f"expected one {field.kind.__name__}"
        raise ValidationError(
            [f"{what} has {len(values)} {shortened(field.predicate)}; {expected}."]
        )
    return field.decode(values[0])
