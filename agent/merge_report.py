# SPDX-License-Identifier: Apache-2.0
"""Merging two bases, with a report of what in one contradicts what in the other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from ..inference.conflicts import Conflict, find_conflicts
from ..kb.knowledge_base import KnowledgeBase
from ..kb.merge import Merged
from ..kb.merge import merge as take_over
from ..kb.rule import Rule
from ..kb.validation import check_invariants, raise_findings


@dataclass(frozen=True)
class MergeReport:
    """What came of a merge.

    Attributes:
        merged: what was taken over.
        conflicts: pairs of a new rule and one that was there, the heaviest first.
        kept: rules that hold in one base and were taken back in the other, as they stand in the
            other; here they stay what they were.
        is_dry: whether nothing was written.
    """

    merged: Merged
    conflicts: tuple[Conflict, ...]
    kept: tuple[Rule, ...]
    is_dry: bool

    def as_json(self) -> dict[str, object]:
        """As `hilt merge --json` prints it."""
        return {
            "new": [rule.as_json() for rule in self.merged.new],
            "known": len(self.merged.known),
            "utterances": self.merged.utterances,
            "untrusted": list(self.merged.untrusted),
            "conflicts": [each.as_json() for each in self.conflicts],
            "kept": [{**rule.as_json(), "status": rule.status} for rule in self.kept],
            "dry_run": self.is_dry,
        }


def merge(base: KnowledgeBase, other: KnowledgeBase, *, name: str, dry_run: bool) -> MergeReport:
    """Take over what another base knows, as one unit.

    Args:
        base: what is written to.
        other: what is read.
        name: of the other, for the history.
        dry_run: only tell what would come of it.

    Raises:
        ValidationError: the other breaks the laws of a base; nothing has changed.
    """
    raise_findings(check_invariants(other.store))
    # Both are looked at first: what is merged cannot be told from what was there afterwards.
    planned = take_over(base, other.reader, source=name, dry_run=True)
    before = base.rules_at_nodes(sorted({rule.node for rule in planned.new}))
    coming = [_weighed(rule, base) for rule in planned.new if rule.status == "active"]
    found = _conflicts(before, coming)
    kept = tuple(rule for rule in planned.known if base.rule(rule.id).status != rule.status)
    merged = planned if dry_run else take_over(base, other.reader, source=name)
    return MergeReport(merged, found, kept, dry_run)


def _weighed(rule: Rule, base: KnowledgeBase) -> Rule:
    """A rule as it will weigh: whom the base has an opinion of, it goes on trusting so far."""
    trust = base.trust(rule.speaker)
    return replace(rule, trust=trust.lower) if trust else rule


def _conflicts(before: Iterable[Rule], new: list[Rule]) -> tuple[Conflict, ...]:
    """Contradictions between what is there and what comes, not those within either."""
    ids = {rule.id for rule in new}
    every = find_conflicts((*before, *new))
    return tuple(each for each in every if (each.first.id in ids) != (each.second.id in ids))
