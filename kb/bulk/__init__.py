"""Imports and exports of any size: rules and statements as streams of text.

nquads_reader   N-Quads and N-Triples, read subject by subject
rule_nquads     rules as lines of N-Quads: serialization, and the fast reading of exports
importer        the import, which checks rules as they stream by and writes them as one unit
reconciliation  conflicts, trust and the numbering of utterances between an import and a base
statement_scan  the statements of a graph as rows, and the rules of a store, in one pass
exporter        the export of statements as text
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
