"""Parsing: from the text of an utterance to its readings, or to the clarification it needs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
