"""Recorder of episodes: a command and its result, as they are kept in the graph.

The document of an episode is that of `hilt do --json`, and has under "again" what is needed to run
it again: the request, the circumstances, and the episode before it, whose changes to the scene it
starts from.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace

from ...kb.episodes import Episode, EpisodeStep
from ...kb.interval import Interval
from ...kb.knowledge_base import KnowledgeBase
from ...kb.rule import Atom
from ..dialogue.reply import Reply
from ..execution.outcome import Json, WalkStep
from ..execution.request import Request
from .serialization import as_json

AGAIN = "again"  # key of the document


class EpisodeRecorder:
    """Records the episodes of one agent, each with what is needed to run it again."""

    def __init__(
        self,
        base: KnowledgeBase,
        circumstances: Callable[[], Json | None],
        state: Callable[[], str],
        robot: str,
    ) -> None:
        self._base = base
        self._circumstances, self._state, self._robot = circumstances, state, robot
        self._last: str | None = None
        self._is_whole = True

    def record(self, request: Request, reply: Reply, keep: bool) -> None:
        """Keep the result of a request."""
        if reply.is_interrupted:
            self.forget_state()
        if keep:
            self._last = self._base.record_episode(
                episode_from_reply(reply, self._again(request), self._robot)
            ).id
        else:
            self._is_whole = False

    def forget_state(self) -> None:
        """Note that the world was changed by something that no request can repeat."""
        self._is_whole = False

    def _again(self, request: Request) -> Json | None:
        circumstances = self._circumstances()
        if circumstances is None or not self._is_whole:
            return None
        kept: Json = {"request": as_json(request), "state": self._state()}
        return kept | {"circumstances": circumstances, "after": self._last}


def episode_from_reply(reply: Reply, again: Json | None = None, robot: str = "") -> Episode:
    """Return the episode of a command: its steps and grasps, and the whole document as JSON."""
    result = reply.result
    decision = result.decision if result else None
    best = decision.object.best if decision else None
    world = result.world if result and result.world.executed else None
    document = reply.as_do_json() | {AGAIN: again}
    return Episode(
        goal=reply.understanding.content,
        text=reply.text,
        speaker=reply.speaker,
        outcome=reply.ending,
        said=reply.said,
        seed=reply.seed,
        document=json.dumps(document, ensure_ascii=False, sort_keys=True),
        object=best.object if best else None,
        part=decision.chosen_part if decision else None,
        rules=tuple(rule.id for rule in decision.rules) if decision else (),
        steps=tuple(_step_of(step) for step in result.steps) if result else (),
        trials=tuple(replace(each, robot=robot) for each in result.trials) if result else (),
        touched=tuple(sorted(world.touched)) if world else (),
        lifted_m=world.lifted_m if world else None,
        handed_over=world.handed_over if world else None,
    )


def _step_of(step: WalkStep) -> EpisodeStep:
    bound, best = step.constraint, step.inference.best
    return EpisodeStep(
        path=step.node,
        features=tuple(Atom.parse(feature) for feature in step.features),
        object=bound.object if bound else None,
        part=bound.part if bound else None,
        interval=Interval(bound.lower, bound.upper) if bound else None,
        rules=tuple(rule.id for rule in best.rules) if best else (),
    )
