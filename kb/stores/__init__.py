"""Stores of RDF statements: in memory, in a folder, or behind a SPARQL endpoint.

pyoxigraph is imported in this sub-package only.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
