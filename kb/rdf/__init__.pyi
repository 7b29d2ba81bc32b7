from .annotated_turtle import expand_annotations, write_annotated
from .domain import domain_quads
from .rule_mapping import read_rule, rule_quads
from .terms import Literal, Quad, Term, as_sparql

__all__ = [
    "Literal",
    "Quad",
    "Term",
    "as_sparql",
    "domain_quads",
    "expand_annotations",
    "read_rule",
    "rule_quads",
    "write_annotated",
]
