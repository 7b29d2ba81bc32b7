"""Showing: people show things that the learned eyes do not know, and say what the parts are called.

"This is a mallet" is about the one thing in view that is unknown, or that somebody points at. What
it looks like is kept with its name, so that who showed it and when is known; it can be forgotten.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

from ...nlu.lexicon.vocabulary import NewWord
from ...nlu.semantics import meaning
from ...sim.vision.percept import Percept
from ..execution.outcome import AnswerContent
from .belief_revision import BeliefRevision
from .conversation import Conversation, UnderstoodTurn
from .reply import Reply

if TYPE_CHECKING:
    from ...sim.poses import Array
    from ...sim.vision.learned_detector import LearnedDetector
    from ...sim.vision.shown_kinds import ShownKind

NEAR = 0.1  # [m], from a place that is pointed at to the thing that is meant
# The pieces of a thing, and what people say that they are.
SHAPES = {"long": {"long", "thin"}, "wide": {"wide", "thick", "big", "large", "short"}}

Eyes: TypeAlias = "Callable[[], LearnedDetector | None]"


class Showing:
    """What is shown in a conversation to the eyes, which are None with another vision."""

    def __init__(self, conversation: Conversation, beliefs: BeliefRevision, eyes: Eyes) -> None:
        self._conversation, self._beliefs, self._eyes = conversation, beliefs, eyes
        #: where on the table somebody points, x and y [m]; None for nowhere
        self.pointed_at: tuple[float, float] | None = None
        self._last = ""  # the kind that was spoken of last

    def open_topic(self, turn: UnderstoodTurn, said: meaning.TopicStatement) -> Reply:
        """Learn what a thing looks like that is shown; else ask about what is spoken of."""
        eyes, conversation = self._eyes() if said.shown else None, self._conversation
        self._last = said.topic
        meant = self._meant(eyes.unknown) if eyes else ()
        known = eyes.kinds.keys() - (eyes.shown.keys() if meant else ()) if eyes else ()
        if eyes is None or said.topic in known:
            return self._beliefs.open_topic(turn, said)
        if len(meant) != 1:
            key, number = "unknown_seen" if eyes.unknown else "all_known", str(len(eyes.unknown))
            answers = AnswerContent(key, {"number": number}), AnswerContent("which_thing")
            return conversation.recorded(turn, " ".join(map(conversation.say, answers)), "asked")
        kind = eyes.show(said.topic, meant[0])
        spoken = conversation.say(AnswerContent("shown", {"object": kind.name}))
        if len(kind.masses) > 1:
            spoken += f" {conversation.say(AnswerContent('shown_parts'))}"
        return self._keep(turn, kind, eyes, spoken)

    def name_part(self, turn: UnderstoodTurn, said: meaning.PartNaming) -> Reply:
        """Learn what a part of something is called that was shown."""
        eyes, conversation = self._eyes(), self._conversation
        kind = eyes.shown.get(said.object or self._last) if eyes else None
        shapes = self._shapes(said, kind, eyes.percepts) if eyes and kind else ()
        if eyes is None or kind is None or len(shapes) != 1:
            return conversation.answered(turn, "which_thing", "asked")
        others = {shape: name for shape, name in kind.names.items() if name != said.part}
        kind = replace(kind, names={**others, shapes[0]: said.part})
        known = {"object": kind.name, "parts": tuple(kind.names.values())}
        return self._keep(turn, kind, eyes, conversation.say(AnswerContent("parts", known)))

    def say_seen(self, found: AnswerContent) -> str:
        """Return in words what is seen, and how many things are unknown."""
        eyes = self._eyes()
        number, say = len(eyes.unknown) if eyes else 0, self._conversation.say
        unknown = [AnswerContent("unknown_seen", {"number": str(number)})] if number else []
        return " ".join(map(say, unknown if number and found.key != "see" else [found, *unknown]))

    def _meant(self, things: Sequence[Percept]) -> Sequence[Percept]:
        if self.pointed_at is None or not things:
            return things
        nearest = min(things, key=lambda thing: self._distance(thing.cloud))
        return [nearest] if self._distance(nearest.cloud) < NEAR else []

    def _shapes(
        self, said: meaning.PartNaming, kind: "ShownKind", seen: Sequence[Percept]
    ) -> Sequence[str]:
        if said.props:
            return [shape for shape in kind.masses if SHAPES.get(shape, set()) & {*said.props}]
        thing = next((each for each in seen if each.object == kind.name), None)
        if self.pointed_at and thing and not said.other:
            part = min(thing.parts, key=lambda name: self._distance(thing.parts[name]))
            return [shape for shape in kind.masses if kind.names.get(shape, shape) == part]
        return [shape for shape in kind.masses if shape not in kind.names]

    def _distance(self, cloud: "Array") -> float:
        import numpy as np  # here: who decides without a simulator saves its import time

        return float(np.linalg.norm(cloud[:, :2] - (self.pointed_at or (0.0, 0.0)), axis=1).min())

    def _keep(
        self, turn: UnderstoodTurn, kind: "ShownKind", eyes: "LearnedDetector", spoken: str
    ) -> Reply:
        words = [NewWord(kind.name, "object", kind.name), *turn.understood.new_words]
        look = kind.as_json()
        self._conversation.believe(turn, (), spoken, words, looks={kind.name: look}, kind="topic")
        eyes.recall(kind.name, look)
        return self._conversation.reply(turn, spoken)
