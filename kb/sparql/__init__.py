"""The text and the results of SPARQL queries, independent of any engine.

query_text     variable bindings, prefixes, paging and error messages of query texts
safety         refusal of queries that read the network or files
named_queries  the queries in `kb/queries`, each with its question and its parameters
results        rows, booleans and statements, and the limits of a query
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
