# SPDX-License-Identifier: Apache-2.0

from .drawing import draw_graph
from .graphml import graph_of, read_graphml, rules_of_graph, write_graphml
from .registry import FORMATS, Format, format_of
from .transfer import export_file, import_file, import_text, read_file, write_base

__all__ = [
    "FORMATS",
    "Format",
    "draw_graph",
    "export_file",
    "format_of",
    "graph_of",
    "import_file",
    "import_text",
    "read_file",
    "read_graphml",
    "rules_of_graph",
    "write_base",
    "write_graphml",
]
