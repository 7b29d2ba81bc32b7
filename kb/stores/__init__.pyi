from .base import MEMORY, Store
from .opening import open_store
from .oxigraph import OxigraphStore
from .rdf_text import write_rdf, write_result
from .remote import RemoteStore

__all__ = [
    "MEMORY",
    "OxigraphStore",
    "RemoteStore",
    "Store",
    "open_store",
    "write_rdf",
    "write_result",
]
