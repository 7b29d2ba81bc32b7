"""Things are shown to the learned eyes, their parts are named, and rules about them followed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.learned import WORDS
from hilt.kb.validation import findings
from hilt.ontology.errors import DataError
from hilt.sim.physics.bodies import Bodies
from hilt.sim.robot.robot import NAME

pytestmark = pytest.mark.sim

EXAMPLES = Path(__file__).parents[3] / "examples"
SCENE = EXAMPLES / "unknown_thing.yaml"
LESSON = (
    "This is a mallet.",
    "The long part is the handle.",
    "The other part is the head.",
    "To pass a mallet, grab the mallet by the head.",
)
PIN = """
  rolling pin:
    is_a: tool
    parts:
      body: {role: grip, material: wood, colour: "#c99e6c", mass: 0.3,
             shape: [{cylinder: {radius: 0.02, length: 0.2}}]}
    rests: {usual: {turn_deg: [0, 90, 0]}}
"""


def see(scene: Path = SCENE, base: str = "memory:", *, seed: int = 3) -> Agent:
    """An agent with learned eyes at a table."""
    return Agent.open(base, AgentConfig(scene=str(scene), seed=seed, vision="learned"))


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, list[str]]:
    """A base in which a mallet was shown, and what was answered."""
    folder = str(tmp_path_factory.mktemp("shown") / "kb")
    with see(base=folder) as agent:
        said = ["what do you see?", *LESSON, "what do you see?", "what are the parts of a mallet?"]
        answers = [agent.hear(each).said for each in said]
    return folder, answers


def test_dialogue(base: tuple[str, list[str]]):
    """What is unknown is said; the kind and its parts are learned; then it is seen."""
    before, shown, first, second, _, after, parts = base[1]

    assert before.endswith("Things here that I don't know: 1.") and "mallet" not in before
    assert (
        shown
        == "I'll know a mallet again. I see two parts, a long one and a wide one. What are they?"
    )
    assert first == "Of a mallet I know a handle."
    assert second == "Of a mallet I know a handle and a head."
    assert "a mallet" in after and "don't know" not in after
    assert parts == "Of a mallet I know a handle and a head."


def test_shown_thing_is_passed_by_the_part_that_was_said(
    base: tuple[str, list[str]], monkeypatch: pytest.MonkeyPatch
):
    """An agent that begins anew knows it, elsewhere on the table; the fingers touch its head."""
    touched = set[str]()
    with see(base=base[0], seed=5) as agent:
        contacts = Bodies.contacts

        def noted(self: Bodies, body: str, link: str | None = None):
            found = contacts(self, body, link)
            if body == NAME and link in agent.body.robot.gripper.links:
                touched.update(each.other_link for each in found if each.other == "thing")
            return found

        monkeypatch.setattr(Bodies, "contacts", noted)
        before = agent.body.world.pose("thing")
        reply = agent.hear("pass me the mallet")
        raised = (agent.body.world.pose("thing") - before)[2, 3]

    assert reply.said == "Here is the mallet. I'm holding it by the head, as you told me."
    assert touched == {"head"}
    assert raised > 0.1


def test_what_was_shown_has_its_source_and_is_listed(base: tuple[str, list[str]]):
    """Who showed it stands with it, and the sentence; the base is valid."""
    with KnowledgeBase.open(base[0], read_only=True) as kb:
        (word,) = kb.words()

        assert word.as_json()["parts"] == ["handle", "head"]
        assert word.speaker == "sam"
        assert kb.utterance(word.utterance or 0).text in LESSON
        assert findings(kb.store, whole=True) == []


def test_what_was_shown_can_be_forgotten(base: tuple[str, list[str]], tmp_path: Path):
    """Then it is unknown again."""
    folder = str(tmp_path / "kb")
    with see(base=folder) as agent:
        agent.hear(LESSON[0])
        agent.base.forget(WORDS, "mallet", "forget the word mallet", "sam")

    with see(base=folder) as agent:
        assert agent.hear("what do you see?").said.endswith("Things here that I don't know: 1.")


@pytest.fixture
def two(tmp_path: Path) -> Path:
    """A scene with two unknown things."""
    known = (EXAMPLES / "mallet.yaml").read_text(encoding="utf-8")
    (tmp_path / "new.yaml").write_text(known + PIN, encoding="utf-8")
    scene = tmp_path / "scene.yaml"
    scene.write_text("objects: [mug]\nunknown: new.yaml\n", encoding="utf-8")
    return scene


def test_of_several_the_one_is_meant_that_is_pointed_at(two: Path):
    """Without a hint Hilt asks; a part is named by pointing at it."""
    with see(two) as agent:
        bounds = agent.body.world.engine.bodies.bounds
        x, y = np.mean(bounds("thing", "head"), axis=0)[:2]
        asked = agent.hear("This is a mallet.")
        far = agent.hear("This is a mallet.", pointing_at=(x, y + 2.0))
        shown = agent.hear("This is a mallet.", pointing_at=(x, y))
        part = agent.hear("This is its head.", pointing_at=(x, y))
        rest = agent.hear("This is its handle.")
        (word,) = agent.base.words()
        corrected = agent.hear("The long part is the head.")

    assert asked.said == far.said == "Things here that I don't know: 2. Which one do you mean?"
    assert "two parts" in shown.said
    assert (part.said, rest.said) == (
        "Of a mallet I know a head.",
        "Of a mallet I know a head and a handle.",
    )
    assert corrected.said == "Of a mallet I know a head."
    assert '"names":{"wide":"head","long":"handle"}' in word.look


def test_nothing_is_shown_where_all_is_known():
    """A new name then names nothing in view; a known kind is only spoken of."""
    with Agent.open("memory:", AgentConfig(scene="objects:mug", vision="learned")) as agent:
        new, known = agent.hear("This is a mallet."), agent.hear("This is a mug.")
        part = agent.hear("The long part is the handle.")

    assert new.said == "I know all that I see. Which one do you mean?"
    assert known.said == "All right, what should I know about a mug?"
    assert part.said == "Which one do you mean?"


def test_shown_thing_is_found_with_noise(base: tuple[str, list[str]]):
    """What is shown is searched for, too, where perception fails now and then."""
    noise = "missed=0.01,confused=0.01,depth_m=0.002"
    config = AgentConfig(scene=str(SCENE), seed=4, vision="learned", noise=noise)
    with Agent.open(base[0], config) as agent:
        assert agent.hear("point to the mallet").said == "That is the mallet."


def test_stranger_shows_nothing():
    """What somebody shows who is not trusted is not learned."""
    with see() as agent:
        reply = agent.hear("This is a mallet.", speaker="mallory")

        assert reply.ending == "refused"
        assert agent.base.words() == []


def test_unknown_things_need_learned_eyes():
    """The mask gives each thing its name."""
    with pytest.raises(DataError, match="--vision learned"):
        Agent.open("memory:", AgentConfig(scene=str(SCENE)))
