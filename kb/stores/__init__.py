"""Stores of RDF statements: in memory, in a folder, or behind a SPARQL endpoint.

base                            the `Store` protocol, which every store fulfils
opening                         opens a store by its location
oxigraph                        the embedded store, by pyoxigraph
remote                          the store behind a SPARQL 1.1 endpoint; `http` sends its requests
query_subprocess, query_worker  queries with limits, in a process that can be killed
directory                       the folder of a store: write-ahead log and snapshots
rdf_text                        parsing and serialization of RDF
result_serialization            query results as JSON, CSV, TSV, XML or Turtle
term_conversion                 between Hilt's terms and those of pyoxigraph
errors                          translation of pyoxigraph's errors

pyoxigraph is imported in this sub-package only.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
