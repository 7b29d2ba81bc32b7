# SPDX-License-Identifier: Apache-2.0
"""The process in which a query runs, because the engine cannot stop one.

`python -m hilt.kb.sparql.worker` reads one request a line from stdin, as JSON: `source` (a
snapshot's folder, or a file of N-Quads), `query`, and `megabytes`, its memory beyond what it needs
to open the source; or, in place of the query, `updates` to a source that is a copy. It answers with
a line of JSON, `kind` and `size`, followed by so many bytes. Whoever asked kills it when it takes
too long.
"""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from ...ontology.errors import QueryError, StoreError

if TYPE_CHECKING:
    from ..stores.oxigraph import OxigraphStore

ROWS, ANSWER, TRIPLES = "rows", "answer", "triples"
WRONG_QUERY, FAILED, TOO_LARGE = "wrong query", "failed", "too large"
UPDATED = "updated"


def serve(requests: Iterable[bytes], answers: BinaryIO) -> None:
    """Answer requests until there are no more.

    Args:
        requests: lines of JSON.
        answers: where the answers are written.
    """
    for kind, body in _answers(requests):
        head = json.dumps({"kind": kind, "size": len(body)})
        answers.write(head.encode() + b"\n" + body)
        answers.flush()


def _answers(requests: Iterable[bytes]) -> Iterator[tuple[str, bytes]]:
    opened, store = "", None
    for line in requests:
        request = json.loads(line)
        try:
            if "updates" in request:
                yield UPDATED, _updated(request)
                continue
            if store is None or request["source"] != opened:
                store, opened = _open(Path(request["source"])), request["source"]
                _limit_memory(request["megabytes"])
            yield store.serialized(request["query"])
        except QueryError as error:
            yield WRONG_QUERY, str(error).encode()
        except StoreError as error:
            yield FAILED, str(error).encode()
        except MemoryError:
            yield TOO_LARGE, b""


def _updated(request: dict[str, Any]) -> bytes:
    from ..stores.oxigraph import open_folder
    from .update import tried

    store = open_folder(Path(request["source"]))
    _limit_memory(request["megabytes"])
    return tried(store, request["updates"])


def _open(source: Path) -> OxigraphStore:
    from ..stores.oxigraph import load_file, open_snapshot

    return open_snapshot(source) if source.is_dir() else load_file(source)


def _limit_memory(megabytes: int) -> None:
    """Let this process have so much more memory than it has now, where the system can."""
    try:
        import resource
    except ImportError:  # Windows; there only time is limited
        return
    most = _address_space() + megabytes * 1_000_000
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))


def _address_space() -> int:
    """The address space of this process in bytes; 0 where it is not told."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except (OSError, ValueError, IndexError):
        return 1_000_000_000
    import resource

    return pages * resource.getpagesize()


if __name__ == "__main__":
    serve(sys.stdin.buffer, sys.stdout.buffer)
