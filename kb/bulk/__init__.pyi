from .exporter import scan_rules, write_statements
from .importer import ImportObserver, import_rules, import_statements
from .nquads_reader import RuleBlock, StatementGroup, read_groups
from .reconciliation import ImportConflict, ImportSummary
from .rule_nquads import FastRuleReader, NQuadsWriter

__all__ = [
    "FastRuleReader",
    "ImportConflict",
    "ImportObserver",
    "ImportSummary",
    "NQuadsWriter",
    "RuleBlock",
    "StatementGroup",
    "import_rules",
    "import_statements",
    "read_groups",
    "scan_rules",
    "write_statements",
]
