"""Merging two bases, with a report of what in one contradicts what in the other."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from ..inference.conflicts import Conflict, find_conflicts
from ..kb.bulk.importer import merge as merge_stores
from ..kb.bulk.reconciliation import ImportSummary
from ..kb.interval import Interval
from ..kb.knowledge_base import KnowledgeBase
from ..kb.rule import Rule


@dataclass(frozen=True)
class MergeReport:
    """What a merge changed.

    Attributes:
        new: rules that the base did not know.
        conflicts: pairs of a rule of the base and a new one, the heaviest first.
        kept: rules that hold in one base and were retracted in the other, as they stand in the
            other; in this base they stay what they were.
        dry_run: whether nothing was written.
    """

    summary: ImportSummary
    new: tuple[Rule, ...]
    conflicts: tuple[Conflict, ...]
    kept: tuple[Rule, ...]
    dry_run: bool

    def as_json(self) -> dict[str, object]:
        """The report as `hilt merge --json` prints it."""
        return {
            "new": [rule.as_json() for rule in self.new],
            "known": self.summary.known,
            "utterances": self.summary.utterances,
            "untrusted": list(self.summary.untrusted),
            "conflicts": [each.as_json() for each in self.conflicts],
            "kept": [{**rule.as_json(), "status": rule.status} for rule in self.kept],
            "not_taken": dict(self.summary.not_taken),
            "dry_run": self.dry_run,
        }


def merge(base: KnowledgeBase, other: KnowledgeBase, *, name: str, dry_run: bool) -> MergeReport:
    """Add to a base what another one knows, as one unit.

    ValidationError if the other base breaks a law; nothing has changed.
    """
    found = _Findings({**other.trust_by_speaker(), **base.trust_by_speaker()})
    summary = merge_stores(base, other.store, source=name, dry_run=dry_run, observer=found)
    return MergeReport(
        summary,
        tuple(sorted(found.new, key=lambda rule: rule.id)),
        tuple(sorted(found.conflicts, key=lambda one: (-one.weight, one.first.id, one.second.id))),
        tuple(sorted(found.kept, key=lambda rule: rule.id)),
        dry_run,
    )


@dataclass
class _Findings:
    trust: dict[str, Interval]
    new: list[Rule] = field(default_factory=list[Rule])
    conflicts: list[Conflict] = field(default_factory=list[Conflict])
    kept: list[Rule] = field(default_factory=list[Rule])

    def add_new(self, rule: Rule, believed: Sequence[Rule]) -> None:
        trust = self.trust.get(rule.speaker)
        weighted = replace(rule, trust=trust.lower if trust else 0.0)
        self.new.append(weighted)
        for other in believed:
            self.conflicts += find_conflicts((other, weighted))

    def add_different(self, rule: Rule) -> None:
        self.kept.append(rule)
