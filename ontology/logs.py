"""Log messages with times, and without credentials.

Each module that logs has the standard logger of its name (`hilt.kb.stores.oxigraph`). All messages
are of level DEBUG, so that nothing is printed unless a handler is attached to `hilt` or below.
"""

import re
import sys
from collections.abc import Generator
from contextlib import contextmanager
from time import perf_counter

DEBUG = 10  # that of `logging`
MOST_CHARACTERS = 500  # of a message
_CREDENTIALS = re.compile(r"//[^\s<>\"]*@")  # of an address: //name:password@
_COMMENTS = re.compile(r"^\s*#.*$", re.MULTILINE)  # of SPARQL


@contextmanager
def timed(module: str, doing: str, *details: object) -> Generator[None]:
    """Log for a module what the block does, when it ends, and how long it took [ms]."""
    logging = sys.modules.get("logging")  # who listens has imported it
    log = logging.getLogger(module) if logging else None
    if log is None or not log.isEnabledFor(DEBUG):
        yield
        return
    started = perf_counter()
    try:
        yield
    finally:
        log.debug("%s [%.1f ms]", shown(doing % details), 1000 * (perf_counter() - started))


def shown(text: str) -> str:
    """Return a text on one line for a log: not too long, addresses without credentials.

    >>> shown("open http://anna:secret@host/kb")
    'open http://***@host/kb'
    """
    line = _CREDENTIALS.sub("//***@", " ".join(_COMMENTS.sub("", text).split()))
    return line if len(line) <= MOST_CHARACTERS else f"{line[: MOST_CHARACTERS - 3]}..."
