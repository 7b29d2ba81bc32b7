"""RDF terms, and the mapping of rules and of the household domain to statements.

terms             RDF terms and statements as plain Python values
rule_mapping      a rule as statements, and back
record_mapping    a dataclass as properties, and back, by a table of its fields
annotated_turtle  rules as annotated edges, the RDF 1.2 dialect of Turtle
domain            object types and action trees as statements
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
