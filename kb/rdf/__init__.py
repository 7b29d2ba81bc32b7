"""RDF terms, and the mapping of rules and of the household domain to statements."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
