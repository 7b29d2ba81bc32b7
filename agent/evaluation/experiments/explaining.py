# SPDX-License-Identifier: Apache-2.0
"""Why a case came out as it did: the proofs of a decision as lines of text."""

from __future__ import annotations

from collections.abc import Iterator

from ...dialogue.reply import Reply
from ...execution.outcome import Decision


def why(reply: Reply) -> list[str]:
    """What was asked and answered, then every candidate with its verdict and proof."""
    decision = reply.achievement.decision if reply.achievement else None
    return [reply.text, reply.said, *(_lines(decision) if decision else ())]


def _lines(decision: Decision) -> Iterator[str]:
    for inference in (decision.object, decision.part):
        for candidate in (*inference.candidates, *inference.absent) if inference else ():
            about = f"{candidate.name} {candidate.argument or ''}".strip()
            yield f"{about}: {candidate.verdict}, {candidate.reason}"
            yield from (f"  {line}" for line in candidate.proof.lines())
