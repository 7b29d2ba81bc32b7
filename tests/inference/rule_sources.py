"""A source of rules without a knowledge base."""

from __future__ import annotations

from collections.abc import Sequence

from hilt.kb.rule import Rule


class Told:
    """A rule source over some rules, which never changes."""

    sequence = 0

    def __init__(self, *rules: Rule) -> None:
        self.rules = rules

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """Return the rules at these nodes."""
        return [rule for rule in self.rules if rule.node in nodes]
