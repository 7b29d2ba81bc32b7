"""Opening a store by its location: in memory, in a folder, or behind a SPARQL endpoint."""

import re
from pathlib import Path

from ...ontology.errors import StoreError
from ...ontology.plugins import call_plugin, plugin_names
from .base import MEMORY, Store
from .oxigraph import open_folder, open_memory

_SCHEME = re.compile(r"[A-Za-z]{2,}:")  # one letter is a Windows drive


def open_store(location: str | Path, *, read_only: bool = False) -> Store:
    """Open or create a store; StoreError if it cannot be opened, with what to do.

    The location is `memory:`, a folder, the address of an endpoint (`hilt.kb.stores.http`), or what
    a plug-in of `hilt.stores` opens: its name and a colon, then what it makes of the rest.
    `read_only` refuses writes: the store must exist; a folder open elsewhere is read as it is now.
    """
    text = str(location)
    if text.startswith(("http://", "https://")):
        from .remote import open_remote

        return open_remote(text, read_only=read_only)
    if _SCHEME.match(text) and text != MEMORY and not Path(text).exists():
        group, name = "hilt.stores", text.partition(":")[0]
        if name not in (known := plugin_names(group)):
            others = f" (plug-ins: {', '.join(known)})" if known else ""
            raise StoreError(
                f'"{text}" is not a store: expected memory:, a folder, or http(s)://...{others}'
            )
        return call_plugin(group, name, text, read_only=read_only, methods=("select", "apply"))
    if text == MEMORY:
        return open_memory(read_only=read_only)
    return open_folder(Path(text).expanduser(), read_only=read_only)
