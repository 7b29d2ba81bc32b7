from .actions import Actions, ActionTree, load_actions
from .confidence import Degrees, load_degrees
from .errors import DataError, HiltError, UnknownNameError
from .objects import Household, ObjectType, PartType, load_household, load_objects
from .vocabulary import Iri, iri, term

__all__ = [
    "ActionTree",
    "Actions",
    "DataError",
    "Degrees",
    "HiltError",
    "Household",
    "Iri",
    "ObjectType",
    "PartType",
    "UnknownNameError",
    "iri",
    "load_actions",
    "load_degrees",
    "load_household",
    "load_objects",
    "term",
]
