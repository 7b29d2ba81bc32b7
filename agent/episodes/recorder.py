# SPDX-License-Identifier: Apache-2.0
"""A command and what came of it, as an episode to keep in the graph.

The document of an episode says what `hilt do --json` printed, and under "again" what it takes to
run it once more: the request, the circumstances, and the episode before it, as what one command
moves the next one finds moved.
"""

from __future__ import annotations

import json
from collections.abc import Callable

from ...kb.episodes import Episode, EpisodeStep
from ...kb.interval import Interval
from ...kb.knowledge_base import KnowledgeBase
from ...kb.rule import Atom
from ..dialogue.reply import Reply
from ..execution.outcome import Json, WalkStep
from ..execution.request import Request
from .serialization import request_as_json

AGAIN = "again"  # key of the document


class EpisodeRecorder:
    """Keeps what one agent does, each episode with what it takes to run it again.

    Args:
        base: where episodes are kept.
        circumstances: tells what the agent is put into; None when that cannot be had again.
        state: tells in what state the world is, in a word.
    """

    def __init__(
        self,
        base: KnowledgeBase,
        circumstances: Callable[[], Json | None],
        state: Callable[[], str],
    ) -> None:
        self._base = base
        self._circumstances, self._state = circumstances, state
        self._last: str | None = None
        self._is_whole = True

    def record(self, request: Request, reply: Reply, keep: bool) -> None:
        """Keep the result of a request.

        Args:
            request: what was asked.
            reply: its result.
            keep: False when it is not to be kept; no later command can then be run again.
        """
        if keep:
            self._last = self._base.record_episode(
                episode_from_reply(reply, self._again(request))
            ).id
        else:
            self._is_whole = False

    def _again(self, request: Request) -> Json | None:
        circumstances = self._circumstances()
        if circumstances is None or not self._is_whole:
            return None
        kept: Json = {"request": request_as_json(request), "state": self._state()}
        return kept | {"circumstances": circumstances, "after": self._last}


def episode_from_reply(reply: Reply, again: Json | None = None) -> Episode:
    """The episode of a command: its facts step by step, and the whole document as JSON.

    Args:
        reply: what came of the command.
        again: what it takes to run it again; None when it cannot be.
    """
    came = reply.achievement
    decision = came.decision if came else None
    best = decision.object.best if decision else None
    world = came.world if came and came.world.executed else None
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
        steps=tuple(_step_of(step) for step in came.steps) if came else (),
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
