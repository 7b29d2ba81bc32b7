"""Mapping of dataclasses to RDF properties, and back, as their fields are annotated."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any, Generic, TypeAlias, TypeVar, get_origin, get_type_hints

from ...ontology.errors import ValidationError
from ...ontology.vocabulary import Iri, external, shortened, split
from .terms import Quad, Term

TYPE = external("rdf:type")
Record = TypeVar("Record")
Key = TypeVar("Key")
Value = TypeVar("Value")
PropertyValues: TypeAlias = "defaultdict[Iri, list[Term]]"  # of each property of a node
REQUIRED = object()  # the default of a field that is always stored


@dataclass(frozen=True)
class FieldProperty:
    """The property that stores the field it annotates; representations show the predicate alone."""

    predicate: Iri
    kind: type = field(repr=False)  #: the type of its values as terms
    #: encode, decode: from a value of the field to a term, and back
    encode: Callable[[Any], Term] = field(default=lambda value: value, repr=False)
    decode: Callable[[Any], Any] = field(default=lambda value: value, repr=False)
    #: the value that is not stored; () for a field with several values
    default: object = field(default=REQUIRED, repr=False)


def group_pairs(pairs: Iterable[tuple[Key, Value]]) -> defaultdict[Key, list[Value]]:
    """The values of each key, in order."""
    found = defaultdict[Key, list[Value]](list)
    for key, value in pairs:
        found[key].append(value)
    return found


@dataclass(frozen=True)
class RecordMapping(Generic[Record]):
    """How the records of a dataclass are stored: each as a node with properties.

    The nodes are of the class `type`, in `graph`; `what` is a record in messages ("An utterance").
    """

    record: type[Record]
    what: str
    type: Iri
    graph: Iri

    @cached_property
    def fields(self) -> Mapping[str, FieldProperty]:
        """The property of each field that has one, in the order in which they are written."""
        hints = get_type_hints(self.record, include_extras=True).items()
        return {name: one.__metadata__[0] for name, one in hints if get_origin(one) is Annotated}

    def quads(self, node: Iri, record: Record) -> Iterator[Quad]:
        """The statements about the node of a record."""
        yield Quad(node, TYPE, self.type, self.graph)
        for name, stored in self.fields.items():
            if (value := getattr(record, name)) != stored.default:
                for one in value if isinstance(value, tuple) else (value,):
                    yield Quad(node, stored.predicate, stored.encode(one), self.graph)

    def read(self, found: PropertyValues, **more: object) -> Record:
        """The record of these properties and `more` fields; ValidationError if one is wrong."""
        stored: dict[str, Any] = {}
        for name, at in self.fields.items():
            values = found[at.predicate]
            if at.default == ():
                stored[name] = tuple(sorted(map(at.decode, values)))
            elif values or at.default is REQUIRED:
                if len(values) != 1 or not isinstance(values[0], at.kind):
                    what = f"{self.what} has {len(values)} {shortened(at.predicate)}"
                    raise ValidationError([f"{what}; expected one {at.kind.__name__}."])
                stored[name] = at.decode(values[0])
            else:
                stored[name] = at.default
        return self.record(**stored, **more)


def local_name(node: Iri) -> str:
    """The name of an individual, without its kind."""
    return split(node)[1]
