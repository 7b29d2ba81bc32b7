"""Replay of an episode: the same request, under the same circumstances, with the same rules.

A command starts from the scene that the commands before it left, so these are run again first. The
rules are those that held then. Nothing is written into the base.
"""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..inference.experience import Experience
from ..inference.settings import Settings
from ..kb.episodes import Episode
from ..kb.knowledge_base import KnowledgeBase
from ..kb.learned import LearnedWord
from ..kb.views import view
from ..ontology.errors import HiltError, NotFoundError
from .agent import Agent
from .config import AgentConfig, actions_with, load_language, open_base
from .dialogue.translation import word_from_base
from .episodes import AGAIN, embodiment_from_json, file_from_json, from_json
from .execution.outcome import GoalResult, Json
from .execution.request import Request

LAST = "last"
COMPARED = ("outcome", "said", "decision", "steps", "world", "state")
KEPT = {"request", "state", "circumstances", "after"}
CIRCUMSTANCES = {"embodiment", "actions", "settings", "induces"}
LISTED = 8  # ids that a message names


@dataclass(frozen=True)
class ReplayResult:
    """An episode that was run again: its recorded result, and the repeated one, also as a value."""

    episode: Episode
    recorded: Json
    repeated: Json
    result: GoalResult

    @property
    def differences(self) -> tuple[str, ...]:
        """The differences, a line each; none when both are equal to the last bit."""
        was, now = dict(_leaves("", self.recorded)), dict(_leaves("", self.repeated))
        paths = (path for path in sorted({*was, *now}) if was.get(path) != now.get(path))
        return tuple(f"{path}: {was.get(path)}, now {now.get(path)}" for path in paths)

    def as_json(self) -> Json:
        """As `hilt replay --json` prints it."""
        return {
            "episode": self.episode.id,
            "utterance": self.episode.text,
            "same": not self.differences,
            "differences": list(self.differences),
            **self.repeated,
        }


def find_episode(episodes: Sequence[Episode], name: str) -> Episode:
    """Return the episode with this id, its number, or the start of it, or the last one for "last".

    UnknownNameError if there is none; HiltError if there are several.
    """
    if name == LAST and episodes:
        return episodes[-1]
    found = [each for each in episodes if each.id == name]
    found = found or [each for each in episodes if each.id.startswith(f"{name}-")]
    found = found or [each for each in episodes if each.id.startswith(name)]
    if len(found) > 1:
        alike = ", ".join(each.id for each in found[-LISTED:])
        raise HiltError(f'{len(found)} episodes begin with "{name}", among them {alike}.')
    if not found:
        raise NotFoundError("episode", name, [each.id for each in episodes[-LISTED:]])
    return found[0]


def replay(
    base: KnowledgeBase, name: str, *, gui: bool = False, film: Path | None = None
) -> ReplayResult:
    """Run an episode again: that with this id, the start of it, or the "last" one.

    A window of the simulator, and the file of a film, are optional. UnknownNameError if there is no
    such episode; HiltError if it was recorded without what is needed to run it again.
    """
    kept = {each.id: each for each in base.episodes()}
    last = find_episode([*kept.values()], name)
    chain = [last]  # with those before it, the first one at the end
    while after := _again(chain[-1])["after"]:
        if after not in kept:
            raise HiltError(f"Episode {last.id} goes on from {after}, which is not in the base.")
        chain.append(kept[after])
    with _agent(_again(chain[-1])["circumstances"], base.words(), gui=gui) as agent:
        for earlier in chain[:0:-1]:
            _run(agent, base, earlier)
        with agent.filmed(film) if film else nullcontext():
            return _run(agent, base, last)


def _again(episode: Episode) -> dict[str, Any]:
    again = json.loads(episode.document).get(AGAIN)
    if again is None or KEPT - again.keys() or CIRCUMSTANCES - again["circumstances"].keys():
        raise HiltError(
            f"Episode {episode.id} cannot be run again: it used vision or motion other than Hilt's "
            "own, an earlier command was not recorded, or another version of Hilt recorded it."
        )
    return again


def _agent(circumstances: Mapping[str, Any], words: Iterable[LearnedWord], *, gui: bool) -> Agent:
    embodiment = embodiment_from_json(circumstances["embodiment"], gui=gui)
    return Agent(
        open_base("memory:", embodiment.household),
        load_language(embodiment.household).with_words(map(word_from_base, words)),
        actions_with(file_from_json(circumstances["actions"])),
        embodiment,
        AgentConfig(
            settings=Settings().with_choices(circumstances["settings"]),
            induce=circumstances["induces"],
        ),
    )


def _run(agent: Agent, base: KnowledgeBase, episode: Episode) -> ReplayResult:
    past = view(base, at=episode.utterance or 0)
    experience = Experience(base, agent.robot, before=episode.utterance)
    agent.goals.affordances = agent.affordances_from(past, experience)
    again = _again(episode)
    result, said = agent.attempt(episode.text, from_json(Request, again["request"]))
    recorded = json.loads(episode.document) | {"state": again["state"]}
    ended = {"outcome": result.answer.ending, "said": said, "state": agent.state()}
    repeated = json.loads(json.dumps(result.as_json() | ended))
    was, now = ({key: each[key] for key in COMPARED} for each in (recorded, repeated))
    return ReplayResult(episode, was, now, result)


def _leaves(path: str, value: object) -> Iterator[tuple[str, str]]:
    match value:
        case dict():
            for key in value.keys() - {"pictures"}:
                yield from _leaves(f"{path}.{key}".lstrip("."), value[key])
        case list():
            for index, each in enumerate(value):
                yield from _leaves(f"{path}[{index}]", each)
        case _:
            yield path, json.dumps(value)
