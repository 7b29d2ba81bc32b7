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
from pathlib import Path
from typing import Any

from ...ontology.errors import QueryError, StoreError
from ..rdf.terms import Quad
from .oxigraph import OxigraphStore, open_memory, open_snapshot
from .query_subprocess import SIZE_BYTES

MAX_SHARE = 4  # an answer takes several times its size there; it may have 1/4 of the memory


def serve() -> None:
    """Answer the requests on stdin until there are no more."""
    answer = _QueryAnswers()
    with contextlib.suppress(EOFError):
        while True:
            request = pickle.load(sys.stdin.buffer)  # noqa: S301 - of the process that asked
            body = _answer_or_error(answer, request)
            sys.stdout.buffer.write(len(body).to_bytes(SIZE_BYTES, "big"))
            sys.stdout.buffer.write(body)
            sys.stdout.buffer.flush()


def _limit_memory(megabytes: int) -> None:
    try:
        import resource
    except ImportError:  # Windows; there only time is limited
        return
    most = _address_space() + megabytes * 1_000_000
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))


class _QueryAnswers:
    def __init__(self) -> None:
        self._opened = Path()
        self._store: OxigraphStore | None = None

    def __call__(self, request: dict[str, Any]) -> object:
        if "update" in request:
            _limit_memory(request["megabytes"])
            return _outcome(request["update"])
        if self._store is None or request["source"] != self._opened:
            source = self._opened = request["source"]
            self._store = open_snapshot(source)
            _limit_memory(request["megabytes"])
        if "document" in request:
            return self._store.document(request["query"], **request["document"])
        return self._store.run(request["query"])


def _outcome(update: str) -> list[Quad]:
    store = open_memory()
    store.update(update)
    return list(store.quads())


def _answer_or_error(answer: _QueryAnswers, request: dict[str, Any]) -> bytes:
    try:
        body = pickle.dumps(answer(request))
        if len(body) > request["megabytes"] * 1_000_000 // MAX_SHARE:
            raise MemoryError
        return body
    except MemoryError:
        return pickle.dumps(MemoryError())
    except (QueryError, StoreError) as error:  # as the class itself, which is made of its message
        kind = QueryError if isinstance(error, QueryError) else StoreError
        return pickle.dumps(kind(str(error)))


def _address_space() -> int:
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except (OSError, ValueError, IndexError):
        return 1_000_000_000
    import resource

    return pages * resource.getpagesize()


if __name__ == "__main__":
    serve()
