"""The agent: knowledge base, language, inference and robot joined into one that listens and acts.

    with Agent.open("memory:", AgentConfig(scene="objects:knife,mug", seed=7)) as agent:
        agent.hear("A knife is used for cutting")
        agent.hear("pass me something used for cutting").said

The simulated body is made at the first command: teaching and asking need no robot.
"""

from collections.abc import Callable, Collection, Generator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from ..inference.affordance import Affordances
from ..inference.experience import Experience
from ..inference.induction import InducedRuleSource, TaughtRules
from ..inference.norms import ALLOWED, NormChecker, NormVerdict
from ..inference.settings import SETTINGS_FILE, Settings
from ..inference.taxonomy import Taxonomy
from ..kb.knowledge_base import KnowledgeBase
from ..nlu.language import Language
from ..ontology.actions import Actions
from ..ontology.errors import DataError, MissingExtraError
from ..ontology.logs import timed
from ..sim.robot.interruption import Interruption
from . import episodes, protocols
from .config import AgentConfig, actions_with, load_language, open_base
from .dialogue.conversation import Conversation
from .dialogue.hearing import Alternative, reaction, weigh
from .dialogue.manager import DialogueManager
from .dialogue.reply import Reply
from .dialogue.translation import action_words
from .execution.action_tree_executor import GoalManager
from .execution.embodiment import Embodiment
from .execution.norm_guard import NormGuard
from .execution.outcome import GoalResult, Json, WalkStep
from .execution.request import Request, review_arguments
from .presentation.video import Film
from .protocols import Motion, Vision

if TYPE_CHECKING:
    from ..sim.body import Body
    from ..sim.scene.scene import Scene
    from ..sim.vision.learned_detector import LearnedDetector
    from .speech.phonetic_repair import SoundRepair


class Agent(AbstractContextManager["Agent"]):
    """A robot that learns from sentences and acts on what it learned; also one that only decides.

    Most programs make one by `Agent.open`.

    Args:
        config: the choices beside the embodiment: induction, settings of the inference, contexts.
        motion: the motion that goes with `vision`; without one the agent decides but does not act.
        dialogue: a language part that is asked before Hilt's own.
    """

    def __init__(
        self,
        base: KnowledgeBase,
        language: Language,
        actions: Actions,
        embodiment: Embodiment,
        config: AgentConfig | None = None,
        *,
        vision: Vision | None = None,
        motion: Motion | None = None,
        dialogue: protocols.Dialogue | None = None,
    ) -> None:
        if embodiment.scene.unknown and not embodiment.vision.startswith("learned"):
            raise DataError("what is unknown is seen only with --vision learned.", source="--scene")
        self.base, self.actions, self.embodiment = base, actions, embodiment
        self._vision, self._motion = vision, motion
        self.config = config = config or AgentConfig()
        self.scene, self.objects = embodiment.scene, embodiment.household.objects
        self.affordances = self.affordances_from(base, Experience(base, self.robot))
        properties = (kind.properties for kind in self.objects.values())
        self.norms = NormChecker(self.affordances, frozenset().union(*properties))
        self._done: list[tuple[str, str]] = []
        self.simulate = embodiment.simulate and vision is None
        self.interruption = Interruption()
        #: called at every node of an action tree, before and after its action
        self.watchers: list[Callable[[WalkStep], None]] = []
        self._hearing = Lock()
        self._film: Film | None = None
        self._repair: SoundRepair | None = None
        self._last_episode: str | None = None
        self._is_repeatable = True  # whether episodes alone changed the world
        language, state = language.with_words(action_words(actions, language)), self.holding
        conversation = Conversation(
            base, language, self.visible, holding=state, seed=self.scene.seed, other=dialogue
        )
        self.dialogue = DialogueManager(
            conversation,
            lambda: self.goals,
            self._record_episode,
            judge=self.judge,
            actions=actions,
            sounds_like=self._sounds_like,
            eyes=lambda: self.eyes,
        )
        self.dialogue.contexts.update(config.context_intervals())

    @classmethod
    def open(
        cls,
        location: str | None = None,
        config: AgentConfig | None = None,
        *,
        vision: Vision | None = None,
        motion: Motion | None = None,
        dialogue: protocols.Dialogue | None = None,
    ) -> "Agent":
        """Return an agent over a knowledge base: `memory:`, a folder, or an endpoint.

        Without a location it is the user's own base; the rest is as in the constructor. DataError
        if the scene, the objects, the noise, the actions or the lexicon are wrong; UnknownNameError
        if there is no such object, robot or percept source; StoreError if no base can be opened.
        """
        config = config or AgentConfig()
        embodiment = Embodiment.from_config(config)
        actions = actions_with(config.actions)
        if vision is None:
            vision, plugged_in = embodiment.open_plugins(config.motion)
            motion = motion or plugged_in
        base = open_base(location, embodiment.household, actions)
        base.taxonomies = config.taxonomy
        language = load_language(embodiment.household, config.lexicon)
        parts = (base, language, actions, embodiment, config)
        return cls(*parts, vision=vision, motion=motion, dialogue=dialogue)

    def affordances_from(self, source: TaughtRules, experience: Experience) -> Affordances:
        """Return the inference over the rules of a source and what grasps came to."""
        classes = self.embodiment.household.classes
        rules = InducedRuleSource(source, self.objects, classes) if self.config.induce else source
        given = self.config.settings
        loaded = given if isinstance(given, Settings) else Settings.load(given or SETTINGS_FILE)
        settings = loaded.with_choices(self.config.overrides)
        return Affordances(rules, settings, Taxonomy.declared(self.base), experience)

    def hear(
        self,
        text: str,
        *,
        speaker: str = "sam",
        only: str | None = None,
        heard: float = 1.0,
        alternatives: Sequence[Alternative] = (),
        keep: bool = True,
        pointing_at: tuple[float, float] | None = None,
    ) -> Reply:
        """Understand one utterance, act on it, and return the reply.

        Any thread may call it. Utterances are heard one after the other, but for controls: "stop",
        "wait" or "put it down" interrupt the command that is being carried out.

        Args:
            text: what is said.
            speaker: who says it.
            only: "tell", "do" or "ask" to accept statements, commands or questions only.
            heard: the confidence of the speech recogniser, in [0, 1].
            alternatives: what a recogniser heard instead, or the text with what else it may have
                been, each with its score in [0, 1]. Then only what is sure is believed or done at
                once, and all else is read back (`agent/dialogue/hearing.py`).
            keep: whether a command is written to the history and kept as an episode.
            pointing_at: x and y on the table to which the speaker points [m].

        ValidationError if a score is not in [0, 1].
        """
        scores = weigh(text, heard, alternatives) if alternatives else {text: 1.0}
        language, is_spoken = self.dialogue.conversation.language, bool(alternatives)
        wanted = reaction(text, scores, language, is_spoken=is_spoken) if self.is_busy else None
        if wanted and wanted[1].control in {"wait", "continue"}:
            self.interrupt(wanted[1].control)
            return self.dialogue.hear_aside(*wanted, speaker=speaker, heard=heard, keep=keep)
        if self.interruption.is_paused or wanted:
            self.interrupt("stop")
        hear = partial(self.dialogue.hear, text, speaker=speaker, only=only, keep=keep)
        with self._hearing:
            self.interruption.clear()
            self.dialogue.showing.pointed_at = pointing_at
            self._take_trajectory()  # of what was no episode
            if self._film:
                self._film.begin(text)
            reply = hear(heard=heard, alternatives=alternatives)
            if reply.understanding.kind == "control":
                self._is_repeatable = False
            if self._film:
                self._film.end(reply.said)
                reply = reply.with_pictures(str(self._film.path))
            return reply

    def _sounds_like(
        self, language: Language, text: str, names: Collection[str]
    ) -> Mapping[str, float]:
        from .speech.phonetic_repair import SoundRepair

        if self._repair is None or self._repair.language is not language:
            try:
                self._repair = SoundRepair(language)
            except MissingExtraError:  # what sounds like it is only a help
                return {}
        return self._repair.candidates(text, names)

    @property
    def is_busy(self) -> bool:
        """Whether an utterance is being heard, or a command carried out, in any thread."""
        return self._hearing.locked()

    def interrupt(self, control: str = "stop") -> None:
        """Let the command that is carried out "stop", "wait" or "continue"; for any thread.

        The arm reacts within 50 ms of simulated time. A command that is stopped ends as failed.
        """
        requests = {"wait": self.interruption.pause, "continue": self.interruption.resume}
        requests.get(control, self.interruption.stop)()

    def attempt(self, text: str, request: Request) -> tuple[GoalResult, str]:
        """Carry out a request; return its result and the spoken answer."""
        if self._film:
            self._film.begin(text)
        result, said = self.dialogue.attempt(request)
        if self._film:
            self._film.end(said)
        return result, said

    def judge(self, request: Request) -> NormVerdict:
        """Return what the norms say of a request, by what it names; no robot is needed."""
        guard = NormGuard(self.norms, self.actions, request, self._done, self.holding)
        guard.enter(request.action, review_arguments(self.actions, request.action, request))
        return guard.verdicts[-1] if guard.verdicts else ALLOWED

    def _record_episode(self, request: Request, reply: Reply, keep: bool) -> None:
        self._is_repeatable = self._is_repeatable and keep and not reply.is_interrupted
        if keep:
            episode = episodes.episode_from_reply(reply, self._again(request), self.robot)
            episode = replace(episode, trajectory=self._take_trajectory())
            self._last_episode = self.base.record_episode(episode).id

    def _take_trajectory(self) -> str | None:
        return self.body.robot.take_trajectory() if self.has_body else None

    def _again(self, request: Request) -> Json | None:
        if self._vision or self._motion or not self._is_repeatable:
            return None
        circumstances = {
            "embodiment": episodes.embodiment_as_json(self.embodiment),
            "actions": episodes.file_as_json(self.config.actions),
            "settings": episodes.settings_as_choices(self.affordances.settings),
            "induces": self.config.induce,
        }
        kept: Json = {"request": episodes.as_json(request), "state": self.state()}
        return kept | {"circumstances": circumstances, "after": self._last_episode}

    def state(self) -> str:
        """Return a hash of the state of the simulation; empty when there is none yet."""
        return self.body.state_hash() if self.has_body else ""

    @property
    def robot(self) -> str:
        """The name of the robot, with which its experience is kept."""
        return type(self._motion).__name__ if self._motion else self.embodiment.robot

    def visible(self) -> tuple[str, ...]:
        """Return the objects in view; without noise those of the scene, in its order."""
        if self._vision is None and self.embodiment.sees_all:
            return tuple(placement.object for placement in self.scene.placements)
        eyes = self.eyes
        features = [f"object:{name}" for name in (eyes.kinds if eyes else self.objects)]
        unknown = {percept.name for percept in eyes.unknown} if eyes else set[str]()
        found = self.goals.search(features)
        return tuple(percept.object for percept in found if percept.name not in unknown)

    @property
    def eyes(self) -> "LearnedDetector | None":
        """The learned eyes of the simulated body; None with another vision."""
        is_learned = self.simulate and self.embodiment.vision.startswith("learned")
        return self.body.eyes if is_learned else None

    def holding(self) -> str | None:
        """Return the name of the object in the simulated hand; None when it is empty."""
        return self.body.holding if self.has_body else None

    def quote(self, utterance: int) -> str:
        """Return the text of the utterance with this number; UnknownNameError if there is none."""
        return self.base.utterance(utterance).text

    @cached_property
    def body(self) -> "Body":
        """The simulated body, made at its first use.

        MissingExtraError if the simulator is not installed.
        """
        with timed(__name__, "build the simulated scene and robot"):
            body = self.embodiment.open_body(self.interruption)
        for word in self.base.words():
            if body.eyes and word.look:
                body.eyes.recall(word.atom.name, word.look)
        return body

    @cached_property
    def goals(self) -> GoalManager:
        """The goal manager, with the vision and the motion of this agent."""
        body = self.body if self.simulate else None
        parts = {name: kind.parts for name, kind in self.objects.items()}
        roles = ((name, part) for name, own in parts.items() for part in own.values())
        return GoalManager(
            self.actions,
            self.affordances,
            self._vision or self.embodiment.open_vision(body),
            body or self._motion,
            self.norms,
            grips={name: part.name for name, part in roles if part.role == "grip"},
            parts=parts,
            interruption=self.interruption,
            done=self._done,
            watchers=self.watchers,
        )

    @contextmanager
    def in_scene(self, scene: "Scene", *, simulate: bool = False) -> "Generator[Agent]":
        """Another agent for the block: with the same knowledge, in a scene of its own."""
        language, config = self.dialogue.conversation.language, replace(self.config, contexts=())
        embodiment = replace(self.embodiment, scene=scene, simulate=simulate)
        other = Agent(self.base, language, self.actions, embodiment, config)
        try:
            yield other
        finally:
            other.release_body()

    @contextmanager
    def filmed(self, path: Path) -> Generator[None]:
        """Record a film of the block, complete when it ends: .mp4, .gif, or .png for a strip.

        DataError if the file cannot be written.
        """
        with Film(self.body, self.goals, path) as film:
            self._film = film
            try:
                yield
            finally:
                self._film = None

    def close(self) -> None:
        """Release the body and the base."""
        self.release_body()
        self.base.close()

    @property
    def has_body(self) -> bool:
        """Whether the simulated body has been made."""
        return "body" in self.__dict__

    def release_body(self) -> None:
        """Release the body, if there is one; the base stays open."""
        if self.has_body:
            self.body.close()

    def __exit__(self, *_: object) -> None:
        self.close()
