"""The worker process of `query_subprocess`, run as `python -m hilt.kb.stores.query_worker`.

It reads pickled requests from stdin: `source` (the folder of a snapshot), `query`, and `megabytes`,
its memory beyond what it needs to open the source. It answers with the result or the error,
pickled, after the size of that. The process that asked kills it when it takes too long. A request
with `document`, arguments of `OxigraphStore.document`, is answered with that document; one with an
`update` is answered with the statements that it leaves in an empty store.
"""

import contextlib
import pickle
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any

from ...ontology.errors import QueryError, StoreError
from .oxigraph import OxigraphStore, open_memory, open_snapshot
from .query_subprocess import SIZE_BYTES

MAX_SHARE = 4  # an answer takes several times its size there; it may have 1/4 of the memory


def serve() -> None:
    """Answer the requests on stdin until there are no more."""
    with contextlib.suppress(EOFError):
        while True:
            body = _answer_or_error(pickle.load(sys.stdin.buffer))  # noqa: S301 - of who asked
            sys.stdout.buffer.write(len(body).to_bytes(SIZE_BYTES, "big"))
            sys.stdout.buffer.write(body)
            sys.stdout.buffer.flush()


def _limit_memory(megabytes: int) -> None:
    try:
        import resource
    except ImportError:  # Windows; there only time is limited
        return
    taken = 1_000_000_000  # where the system does not say how much it is
    with contextlib.suppress(OSError, ValueError, IndexError):
        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[0]
        taken = int(pages) * resource.getpagesize()
    most = taken + megabytes * 1_000_000
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))


@lru_cache(maxsize=1)
def _opened(source: str, megabytes: int) -> OxigraphStore:
    store = open_snapshot(Path(source))
    _limit_memory(megabytes)
    return store


def _answer(request: dict[str, Any]) -> object:
    if "update" not in request:
        store = _opened(request["source"], request["megabytes"])
        if "document" in request:
            return store.document(request["query"], **request["document"])
        return store.run(request["query"])
    _limit_memory(request["megabytes"])
    store = open_memory()
    store.update(request["update"])
    return list(store.quads())


def _answer_or_error(request: dict[str, Any]) -> bytes:
    try:
        body = pickle.dumps(_answer(request))
        if len(body) > request["megabytes"] * 1_000_000 // MAX_SHARE:
            raise MemoryError
        return body
    except MemoryError:
        return pickle.dumps(MemoryError())
    except (QueryError, StoreError) as error:  # as the class itself, which is made of its message
        kind = QueryError if isinstance(error, QueryError) else StoreError
        return pickle.dumps(kind(str(error)))


if __name__ == "__main__":
    serve()
