"""Applications that are served on a free port of the loopback, for the tests."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import uvicorn

from hilt.agent.web.security import ServiceSettings
from hilt.agent.web.sparql_targets import bare_app
from hilt.kb.stores.oxigraph import open_folder, open_memory


@contextmanager
def served(app: Any) -> Generator[str]:
    """Serve an application in a thread, until the block ends; its address without a slash."""
    listener = socket.create_server(("127.0.0.1", 0))
    config = uvicorn.Config(app, log_config=None, timeout_graceful_shutdown=3)
    server = uvicorn.Server(config)
    running = threading.Thread(target=server.run, args=([listener],))
    running.start()
    try:
        while not server.started and running.is_alive():
            time.sleep(0.01)
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
    finally:
        server.should_exit = True
        running.join()
        listener.close()


@contextmanager
def served_bare(folder: Path | None = None) -> Generator[str]:
    """Serve an empty plain store, in memory or in a folder."""
    store = open_folder(folder) if folder else open_memory()
    with served(bare_app(store, ServiceSettings(needs_key=False))) as address:
        yield address
