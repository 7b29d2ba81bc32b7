"""Presentation for people: terminal tables, the history, pictures of proofs, and films.

Nothing here prints or decides; each module turns values of the agent into something to show.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
