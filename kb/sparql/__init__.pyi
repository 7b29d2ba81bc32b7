from .named_queries import NamedQuery, named_query, query_names, read_query
from .query_text import Bindings, bind_variables, query_form, with_prefixes
from .results import BooleanResult, ConstructResult, QueryLimits, QueryResult, SelectResult
from .safety import refuse_external_access, refuse_nondeterminism

__all__ = [
    "Bindings",
    "BooleanResult",
    "ConstructResult",
    "NamedQuery",
    "QueryLimits",
    "QueryResult",
    "SelectResult",
    "bind_variables",
    "named_query",
    "query_form",
    "query_names",
    "read_query",
    "refuse_external_access",
    "refuse_nondeterminism",
    "with_prefixes",
]
