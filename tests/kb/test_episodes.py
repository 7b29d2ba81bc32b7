# SPDX-License-Identifier: Apache-2.0
"""Claims about episodes."""

from __future__ import annotations

from dataclasses import replace

from hilt.kb.episodes import Episode, EpisodeStep
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Atom
from hilt.kb.validation import check_shapes

from .conftest import BLADE, CUTTING

FIND = EpisodeStep(
    "pass/findObject",
    (Atom("object", "knife"),),
    "knife",
    None,
    Interval(0.9, 1),
    (CUTTING.id,),
)
GRASP = EpisodeStep("pass/graspObject", (), "knife", "blade", Interval(0.9, 1), (BLADE.id,))
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
    touched=("blade",),
    lifted_m=0.1522,
    handed_over=True,
)


def test_episode_comes_back_with_its_steps_in_order(paper: KnowledgeBase):
    """Everything is kept, and belongs to the utterance that was said last."""
    recorded = paper.record_episode(EPISODE)

    assert list(paper.episodes()) == [recorded]
    assert (recorded.utterance, recorded.steps) == (3, EPISODE.steps)
    assert replace(recorded, id="", utterance=None, time=None) == EPISODE


def test_episode_without_a_choice_is_kept_too(kb: KnowledgeBase):
    """A failure has no object, part or rules."""
    nothing = replace(EPISODE, object=None, part=None, rules=(), steps=(), touched=())
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
