"""Claims about episodes."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hilt.kb.episodes import Episode, EpisodeStep, GraspTrial
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Atom
from hilt.kb.validation import check_shapes
from hilt.ontology.errors import NotFoundError

from .conftest import BLADE, CUTTING

FIND = EpisodeStep(
    "pass/findObject", (Atom("object", "knife"),), "knife", None, Interval(0.9, 1), (CUTTING.id,)
)
GRASP = EpisodeStep("pass/graspObject", (), "knife", "blade", Interval(0.9, 1), (BLADE.id,))
SLIPPED = GraspTrial("knife", "blade", "pass", "slipped", "panda")
HELD = replace(SLIPPED, outcome="held")
EPISODE = Episode(
    goal="pass(self,usedFor(something,cutting))",
    text="pass me something used for cutting",
    speaker="sam",
    outcome="done",
    said="Here is the knife.",
    seed=7,
    document='{"outcome": "done"}',
    object="knife",
    part="blade",
    rules=tuple(sorted((BLADE.id, CUTTING.id))),
    steps=(FIND, GRASP, EpisodeStep("pass/moveTo")),
    trials=(SLIPPED, HELD),
    touched=("blade",),
    lifted_m=0.1522,
    handed_over=True,
    trajectory='{"robot": "panda"}',
)


def test_episode_comes_back_with_its_steps_in_order(paper: KnowledgeBase):
    """Everything is kept, and belongs to the utterance that was said last."""
    recorded = paper.record_episode(EPISODE)

    assert list(paper.episodes()) == [recorded]
    assert (recorded.utterance, recorded.steps) == (3, EPISODE.steps)
    assert replace(recorded, id="", utterance=None, time=None) == EPISODE


def test_episode_without_a_choice_is_kept_too(kb: KnowledgeBase):
    """A failure has no object, part or rules."""
    nothing = replace(EPISODE, object=None, part=None, rules=(), steps=(), trials=(), touched=())
    failed = replace(nothing, outcome="failed", lifted_m=None, handed_over=None)

    recorded = kb.record_episode(failed)

    assert next(kb.episodes()) == recorded
    assert recorded.utterance is None


def test_two_episodes_of_one_utterance_are_two(paper: KnowledgeBase):
    """Repeating a command in the same breath is another episode."""
    one, two = paper.record_episode(EPISODE), paper.record_episode(EPISODE)

    assert one.id != two.id
    assert len(list(paper.episodes())) == 2


def test_episode_keeps_to_the_shapes(paper: KnowledgeBase):
    """What is recorded is valid."""
    paper.record_episode(EPISODE)

    assert list(check_shapes(paper.store)) == []


def test_episode_answers_questions_in_sparql(paper: KnowledgeBase):
    """Which rules decided what can be asked of the graph."""
    paper.record_episode(EPISODE)

    found = paper.select(
        "SELECT ?part WHERE { GRAPH graph:episodes { ?e hilt:step ?s . ?s hilt:path "
        '"pass/graspObject" ; hilt:part ?part ; prov:used ?rule } }'
    )

    assert [str(row[0]) for row in found] == ["https://w3id.org/hilt/part/blade"]


def test_what_the_fingers_touched_can_be_asked(paper: KnowledgeBase):
    """The graph tells in which episodes something was handed over by another part than chosen."""
    paper.record_episode(EPISODE)
    slipped = paper.record_episode(replace(EPISODE, touched=("handle",)))

    found = paper.select(
        "SELECT ?e WHERE { GRAPH graph:episodes { ?e hilt:part ?part ; hilt:touched ?other ; "
        "hilt:handedOver true ; hilt:lifted ?height FILTER (?other != ?part && ?height > 0.1) } }"
    )

    assert [str(row[0]) for row in found] == [f"https://w3id.org/hilt/episode/{slipped.id}"]


def counts(base: KnowledgeBase, **wanted: str) -> dict[str, object]:
    """How often each outcome occurred."""
    return {str(row[-2]): row[-1] for row in base.answer("experience", **wanted)}


def test_trials_are_counted_by_outcome(paper: KnowledgeBase):
    """The named query tells how often the grasps of an object by a part ended in which way."""
    for _ in range(2):
        paper.record_episode(EPISODE)
    other = replace(SLIPPED, part="handle")
    paper.record_episode(replace(EPISODE, trials=(other,)))

    assert counts(paper, object="knife", part="blade") == {"slipped": 2, "held": 2}
    assert counts(paper, part="handle", robot="panda") == {"slipped": 1}
    assert counts(paper, robot="kuka") == counts(paper, context="pickUp") == {}


def test_forgotten_trials_count_no_longer_but_did_before(paper: KnowledgeBase):
    """Forgetting is an utterance: what was known before it can still be asked."""
    paper.record_episode(EPISODE)

    number = paper.forget_trials("forget experience knife", "sam", of="knife", part="blade")

    (episode,) = paper.episodes()
    assert number == 2
    assert counts(paper) == {}
    assert counts(paper, before="4") == {"slipped": 1, "held": 1}
    assert [each.forgotten_by for each in episode.trials] == [4, 4]
    assert list(check_shapes(paper.store)) == []


def test_only_what_there_is_can_be_forgotten(paper: KnowledgeBase):
    """Without such trials nothing changes, and the error says so."""
    paper.record_episode(EPISODE)

    with pytest.raises(NotFoundError, match="experience"):
        paper.forget_trials("forget experience knife handle", "sam", of="knife", part="handle")

    assert paper.sequence == 3
