# SPDX-License-Identifier: Apache-2.0
"""A command and what came of it, as an episode to keep in the graph."""

from __future__ import annotations

import json

from ..kb.episodes import Episode
from .reply import Reply


def episode_of(reply: Reply) -> Episode:
    """The episode of a reply to a command: its key facts, and the whole document as JSON."""
    came = reply.achievement
    decision = came.decision if came else None
    best = decision.object.best if decision else None
    return Episode(
        goal=reply.understanding.goal,
        text=reply.text,
        speaker=reply.speaker,
        outcome=reply.ending,
        said=reply.said,
        seed=reply.seed,
        object=best.object if best else None,
        part=decision.chosen_part if decision else None,
        rules=tuple(rule.id for rule in decision.rules) if decision else (),
        document=json.dumps(reply.as_do_json(), ensure_ascii=False, sort_keys=True),
    )
