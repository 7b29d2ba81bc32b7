from .drawing import draw_graph
from .graphml import graph_of, read_graphml, rules_of_graph, write_graphml
from .import_export import export_file, import_file, read_file, write_base
from .registry import FORMATS, FileFormat, format_of

__all__ = [
    "FORMATS",
    "FileFormat",
    "draw_graph",
    "export_file",
    "format_of",
    "graph_of",
    "import_file",
    "read_file",
    "read_graphml",
    "rules_of_graph",
    "write_base",
    "write_graphml",
]
