"""Semantics and pragmatics: from the term of a derivation to what an utterance means to Hilt."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
