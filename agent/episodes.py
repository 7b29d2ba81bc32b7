# SPDX-License-Identifier: Apache-2.0
"""A command and what came of it, as an episode to keep in the graph."""

from __future__ import annotations

import json

from ..kb.episodes import Episode, EpisodeStep
from ..kb.interval import Interval
from ..kb.rule import Atom
from .outcome import Step
from .reply import Reply


def episode_of(reply: Reply) -> Episode:
    """The episode of a command: its facts step by step, and the whole document as JSON."""
    came = reply.achievement
    decision = came.decision if came else None
    best = decision.object.best if decision else None
    return Episode(
        goal=reply.understanding.content,
        text=reply.text,
        speaker=reply.speaker,
        outcome=reply.ending,
        said=reply.said,
        seed=reply.seed,
        document=json.dumps(reply.as_do_json(), ensure_ascii=False, sort_keys=True),
        object=best.object if best else None,
        part=decision.chosen_part if decision else None,
        rules=tuple(rule.id for rule in decision.rules) if decision else (),
        steps=tuple(_step_of(step) for step in came.steps) if came else (),
    )


def _step_of(step: Step) -> EpisodeStep:
    bound, best = step.constraint, step.inference.best
    return EpisodeStep(
        path=step.node,
        features=tuple(Atom.parse(feature) for feature in step.features),
        object=bound.object if bound else None,
        part=bound.part if bound else None,
        interval=Interval(bound.lower, bound.upper) if bound else None,
        rules=tuple(rule.id for rule in best.rules) if best else (),
    )
