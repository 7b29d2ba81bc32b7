"""Repair by sound: the sentence that was said is offered for what a recogniser wrote."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("pocketsphinx", reason="the dictionary of pronunciations is in pocketsphinx")

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.speech.phonetic_repair import MOST_CANDIDATES, MOST_COST, SoundRepair
from hilt.nlu.language import Language
from hilt.nlu.lexicon.vocabulary import NewWord
from hilt.nlu.semantics.meaning import ActionRule, Statement

FILE = Path(__file__).parents[1] / "data" / "misheard.yaml"
MISHEARD: Mapping[str, str] = yaml.safe_load(FILE.read_text(encoding="utf-8"))
NONSENSE = (
    "gaga blub", "good morning", "music", "la la la la", "please subscribe to my channel",
    "the weather is nice today", "guten Tag wie geht es dir", "",
)  # fmt: skip
AT_FIRST, AMONG_THREE = 0.85, 0.9  # the least shares of the misheard sentences


FREE = {  # what Moonshine made of sentences that the grammar does not generate
    "Nicely done, robot": "Nicely done, road-bought",
    "I take back what I said about mugs being for pounding": (
        "I take back what I said about Mubs being for pounding."
    ),
    "Forget what I just said": "Forgot what I just said.",
    "Let me have whatever you'd use for rolling": "Let me have watch ever, you'd use for rolling.",
    "Once in a while a spoon will do for cutting": (
        "Once in the while, a spoon will do for cutting."
    ),
    "Cut the bread with something used for cutting": (
        "Cut the bread with something used for coaching."
    ),
    "Listen, a shoe is not something you cut with": "Listen, Ashu is not something you cut with.",
}


@pytest.fixture(scope="module")
def repair() -> SoundRepair:
    """The repair with the words that Hilt comes with."""
    return SoundRepair(Language.load())


def offered(repair: SoundRepair, heard: str) -> list[str]:
    """The three sentences that are offered."""
    return [*repair.candidates(heard)][:3]


def test_what_was_said_is_among_what_is_offered(repair: SoundRepair):
    """Of the misheard sentences most are found, and nearly all of these are the nearest."""
    meaning = {text: repair.language.understand(text).meaning for text in MISHEARD}
    found = {
        said: [repair.language.understand(each).meaning for each in offered(repair, heard)]
        for said, heard in MISHEARD.items()
    }

    first = sum(meanings[:1] == [meaning[said]] for said, meanings in found.items())
    among = sum(meaning[said] in meanings for said, meanings in found.items())

    assert first / len(MISHEARD) >= AT_FIRST
    assert among / len(MISHEARD) >= AMONG_THREE


@pytest.mark.parametrize(("said", "heard"), FREE.items())
def test_words_of_free_sentences_are_replaced(repair: SoundRepair, said: str, heard: str):
    """What the grammar does not generate is found, too, if all but some words were heard right."""
    meanings = [repair.language.understand(each).meaning for each in offered(repair, heard)]

    assert repair.language.understand(said).meaning in meanings


@pytest.mark.parametrize(
    ("said", "heard"),
    [("put it down", "put it dawn"), ("let go", "let goat"), ("drop it", "drop id")],
)
def test_controls_of_the_arm_are_found(repair: SoundRepair, said: str, heard: str):
    """What stops the arm or empties the hand is no sentence of the grammar, and found as well."""
    assert said in offered(repair, heard)


def test_what_is_understood_gets_no_other_words(repair: SoundRepair):
    """There is nothing to repair."""
    assert repair.respelled("Pass me the knife", repair.costs("Pass me the knife")) == []


def test_transcript_gets_the_form_of_what_was_said(repair: SoundRepair):
    """Of "to point to a salad grab it by the top" all is found but the salad, no object here."""
    first = next(iter(repair.candidates("To point to a silent rabbit by the top")))

    (rule,) = _statement(repair, first).rules
    assert isinstance(rule, ActionRule)
    assert (rule.context, rule.part) == ("pointTo", "top")


def _statement(repair: SoundRepair, text: str) -> Statement:
    meaning = repair.language.understand(text).meaning
    assert isinstance(meaning, Statement)
    return meaning


def test_learned_word_is_found():
    """A word that was learned is known by its sound, whether the dictionary has it or not."""
    language = Language.load().with_words(
        [
            NewWord(word, "object", word) for word in ("celery", "gromble", "日本")
        ]  # the last: no sound
    )

    repair = SoundRepair(language)

    assert offered(repair, "pass me the salary")[0] == "pass me the celery"
    assert offered(repair, "pass me the crumble")[0] == "pass me the gromble"


def test_likely_words_are_nearer(repair: SoundRepair):
    """A word of what is on the table costs less, and may come first."""
    heard = "path me the rug"
    usual = repair.candidates(heard)

    likely = repair.candidates(heard, ["mug"])

    assert likely["pass me the mug"] < usual["pass me the mug"]
    assert next(iter(likely)) == "pass me the mug"


@given(st.sampled_from([*MISHEARD.values(), *NONSENSE]))
def test_candidates_are_in_order_and_mean_different_things(repair: SoundRepair, heard: str):
    """They are ranked by cost, and all are understood."""
    found = repair.candidates(heard)

    costs = [*found.values()]
    assert costs == sorted(costs) and all(cost <= MOST_COST for cost in costs)
    meanings = [repair.language.understand(each).meaning for each in found]
    assert len(set(meanings)) == len(found) <= MOST_CANDIDATES


@pytest.mark.parametrize("heard", NONSENSE)
def test_nonsense_gets_no_offer(repair: SoundRepair, heard: str):
    """What sounds like no sentence of the grammar is left as it is."""
    assert repair.candidates(heard) == {}


def test_long_text_is_left_as_it_is(repair: SoundRepair):
    """The search is bounded: half a minute of talk is not repaired."""
    assert repair.candidates("pass me the life " * 30) == {}


@pytest.mark.parametrize("said", [said for said in MISHEARD if "grab it by the blade" in said])
def test_sentence_itself_costs_least(repair: SoundRepair, said: str):
    """What was heard well is its own nearest sentence."""
    assert repair.nearest(repair.costs(said))[0][1] == said


@pytest.fixture
def agent() -> Iterator[Agent]:
    """An agent with a knife and a mug in view."""
    with Agent.open("memory:", AgentConfig(simulate=False, scene="objects:knife,mug")) as opened:
        yield opened


@pytest.mark.parametrize("heard", MISHEARD.values())
def test_repair_is_only_offered(agent: Agent, heard: str):
    """However sure, what has a repair, a new word or a negation leads to a question only."""
    reply = agent.hear(heard, alternatives=[(heard, 1.0)])

    assert not agent.base.rules()
    if agent.dialogue.conversation.language.understand(heard).kind == "error":
        assert reply.ending in {"asked", "not_understood"}


def test_offered_sentence_is_carried_out_after_a_yes(agent: Agent):
    """The knife is passed once it was agreed that "the life" was the knife."""
    asked = agent.hear("path me the knive", alternatives=[("path me the knive", 0.8)])
    done = agent.hear("the first one", alternatives=[("the first one", 0.3)])

    assert "pass me the knife" in asked.said
    assert (done.ending, done.text) == ("done", "pass me the knife")
