"""Merging one base into another: an import of the export of the other base.

It streams in bounded memory, is applied whole or not at all, and merging twice changes nothing.
"""

from __future__ import annotations

import tempfile
from typing import BinaryIO, cast

from .bulk.exporter import write_statements
from .bulk.importer import ImportObserver, import_statements
from .bulk.nquads_reader import read_groups
from .bulk.reconciliation import ImportSummary
from .knowledge_base import KnowledgeBase
from .rdf.rule_mapping import BELIEFS
from .stores.base import Store
from .validation import check_invariants

_MAX_IN_MEMORY = 2**24  # bytes of the other base; more of it is written to a temporary file


def merge(
    base: KnowledgeBase,
    other: Store,
    *,
    source: str,
    dry_run: bool = False,
    observer: ImportObserver | None = None,
) -> ImportSummary:
    """Add to a base what another one knows, as one unit.

    The source names the other base in the history; a dry run only finds out what would change.
    The observer receives new rules, and known ones of another status.

    Raises:
        ValidationError: the other base breaks a law; nothing has changed.
    """
    with tempfile.SpooledTemporaryFile(_MAX_IN_MEMORY, prefix="hilt-") as spool:
        stream = cast(BinaryIO, spool)
        write_statements(other, stream, "nquads", None, rules_only=False)
        stream.seek(0)
        groups = read_groups(stream, format="nquads", source=source, default=BELIEFS)
        return import_statements(
            base, groups, source=source, dry_run=dry_run, check=check_invariants, observer=observer
        )
