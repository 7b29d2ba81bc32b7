"""What a hearing may do: what is believed or done at once, what is read back, and what stops."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from threading import Thread

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.dialogue.hearing import SURE, Alternative, reaction, weigh
from hilt.agent.dialogue.reply import Reply
from hilt.nlu.language import Language
from hilt.nlu.semantics.meaning import Control
from hilt.ontology.errors import ValidationError

USES = "a knife is used for cutting"
GIVE = "pass me the knife"
POSITIVE = (USES, GIVE, "to pass a knife grab it by the blade", "pick up the mug")
NEGATIVE = (
    "a knife is never used for cutting",
    "do not pass me the knife",
    "never pass a knife by the blade",
    "don't pick up the mug",
    "you must not pick up the mug",
    "stop passing me the knife",
    "forget that",
    "forget what I said about knives",
    "no, by the handle",
    "a knife is not used for cutting",
)
TEXTS = (*POSITIVE, *NEGATIVE, "gaga blub", "a spoon is used for coaching", "yes", "")
SCORES = st.floats(0, 1)
HEARINGS = st.lists(st.tuples(st.sampled_from(TEXTS), SCORES), min_size=1, max_size=5)


def spoken(agent: Agent, *alternatives: Alternative, keep: bool = True) -> Reply:
    """The reply to what may have been said; the first text is what a recogniser took."""
    return agent.hear(alternatives[0][0], alternatives=alternatives, keep=keep)


def changed(agent: Agent, reply: Reply) -> bool:
    """Whether a reply to an agent that knew nothing is more than an answer."""
    is_done = reply.ending == "done" and reply.understanding.kind != "acknowledgement"
    return bool(agent.base.rules()) or is_done


@pytest.fixture
def language(agent: Agent) -> Language:
    """The language of the agent."""
    return agent.dialogue.conversation.language


@given(HEARINGS, SCORES)
def test_scores_are_at_most_one_in_all(alternatives: list[Alternative], heard: float):
    """Each text has a score in [0, 1], and so has their sum."""
    scores = weigh("stop", heard, alternatives)

    assert set(scores) == {"stop", *dict(alternatives)}
    assert all(0 <= score <= 1 for score in scores.values())
    assert sum(scores.values()) <= 1 + 1e-9


@pytest.mark.parametrize("score", [-0.1, 1.1, float("nan"), float("inf")])
def test_score_that_is_no_degree_is_refused(agent: Agent, score: float):
    """A score outside [0, 1] is the mistake of who calls, and nothing is heard."""
    with pytest.raises(ValidationError):
        spoken(agent, (USES, score))

    assert not list(agent.base.history())


@given(HEARINGS)
def test_nothing_of_other_polarity_follows(alternatives: list[Alternative]):
    """Nothing that denies, forbids or takes back is believed unasked, nor what it may deny."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        reply = spoken(agent, *alternatives)

        scores = weigh(alternatives[0][0], 1.0, alternatives)
        if changed(agent, reply):
            assert reply.text in POSITIVE
            assert all(scores.get(text, 0) < 0.01 for text in NEGATIVE)
            assert reply.heard >= SURE
        assert all(not rule.interval.upper < 0.5 for rule in agent.base.rules())


@given(HEARINGS, st.sampled_from(["yes", "the first one", "2", "no"]))
def test_what_was_read_back_is_what_follows(alternatives: list[Alternative], answer: str):
    """After an answer, what is believed or done has one of the texts that were read back."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        asked = spoken(agent, *alternatives)
        if asked.ending != "asked" or not asked.said.startswith("Did you say"):
            return
        before = agent.base.rules()
        reply = spoken(agent, (answer, 0.3))

        if agent.base.rules() != before or reply.ending == "done":
            assert answer == "no" or reply.text.lower() in asked.said.lower()


@given(
    st.permutations([(USES, 0.3), ("a knife is used for cutting.", 0.3), (GIVE, 0.2), ("x", 0.1)])
)
def test_order_of_alternatives_changes_nothing(alternatives: Sequence[Alternative]):
    """Only the scores count: the answer and the certainty are the same in any order."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        reply = agent.hear(USES, alternatives=alternatives)

    assert reply.heard == pytest.approx(0.6)
    assert reply.said == "Did you say: 1. a knife is used for cutting. 2. pass me the knife?"


@given(HEARINGS, st.sampled_from(["stop", "Stop!", "please stop"]), SCORES, st.integers(0, 5))
def test_stop_needs_no_certainty(
    alternatives: list[Alternative], stop: str, score: float, place: int
):
    """Where any alternative is a "stop", that is obeyed, and nothing else."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        reply = spoken(agent, *alternatives[:place], (stop, score), *alternatives[place:])

        assert reply.understanding.meaning == Control("stop")
        assert not agent.base.rules()


def test_certainty_of_a_meaning_is_the_sum_over_its_texts(agent: Agent):
    """Two ways to say the same are believed together where each alone is not."""
    texts = ("To pass a knife grab it by the blade", "to pass a knife, grab the knife by the blade")

    reply = spoken(agent, (texts[0], 0.5), (texts[1], 0.45), ("gaga", 0.05))

    assert (reply.ending, reply.text, reply.heard) == ("done", texts[0], pytest.approx(0.95))
    assert [said.heard for said in agent.base.history()] == [pytest.approx(0.95)]


def test_what_is_not_sure_is_read_back_and_then_done(agent: Agent):
    """Below the bound nothing happens before a "yes", which needs no certainty."""
    asked = spoken(agent, (GIVE, SURE - 0.01))
    done = spoken(agent, ("yes", 0.1))

    assert (asked.ending, asked.said) == ("asked", "Did you say: pass me the knife?")
    assert (done.ending, done.text) == ("done", GIVE)


@pytest.mark.parametrize("text", [text for text in NEGATIVE if not text.startswith("no, ")])
def test_what_denies_or_takes_back_is_read_back_however_sure(agent: Agent, text: str):
    """A certainty of 1 does not help; a "no" then leaves all as it was."""
    spoken(agent, (USES, 1.0))
    before = agent.base.rules()

    asked = spoken(agent, (text, 1.0))
    spoken(agent, ("no", 0.1))

    assert asked.said == f"Did you say: {text}?"
    assert agent.base.rules() == before


@pytest.mark.parametrize("text", ["you can trust Anna", "my name is Anna", "don't trust Anna"])
def test_trust_is_read_back(agent: Agent, text: str):
    """Whom to trust, and who speaks, is not believed unasked."""
    assert spoken(agent, (text, 1.0)).ending == "asked"
    assert agent.base.trust("anna") is None


def test_new_word_is_spelt_out(agent: Agent):
    """A new word is learned after a "yes" only, and was spelt out before."""
    asked = spoken(agent, ("a whistle is used for coaching", 1.0))

    assert "Is that a new word: w-h-i-s-t-l-e, c-o-a-c-h-i-n-g?" in asked.said
    assert not agent.base.words()
    assert spoken(agent, ("yes", 0.5)).ending == "done"
    assert {word.said for word in agent.base.words()} == {"whistle", "coaching"}


def test_new_word_as_an_answer_is_spelt_out(agent: Agent):
    """The short answer to a question of Hilt is read back, and the question stays after a "no"."""
    question = spoken(agent, ("what is an egg used for", 0.95)).said

    asked = spoken(agent, ("coaching", 0.99))
    repeated = spoken(agent, ("no", 0.4))
    spoken(agent, ("cutting", 0.99))

    assert asked.said.endswith("Is that a new word: c-o-a-c-h-i-n-g?")
    assert repeated.said == question
    assert [rule.argument.name for rule in agent.base.rules()] == ["cutting"]


@pytest.mark.parametrize(
    "text", ["a whistle might be used for coaching", "a wistle iz what you use four coaching"]
)
def test_new_word_in_what_is_offered_is_spelt_out(agent: Agent, text: str):
    """Whatever Hilt asks about such a text, no word is learned that it has not spelt out."""
    asked = [spoken(agent, (text, 1.0)).said]
    for _ in range(3):
        asked.append(spoken(agent, ("yes", 0.5)).said)

    spelt = " ".join(asked)
    assert all("-".join(word.said) in spelt for word in agent.base.words())


def test_questions_are_answered_from_the_usual_bound_on(taught: Agent):
    """What changes nothing needs only the certainty that a typed text with `heard` needs."""
    assert spoken(taught, ("what is a knife used for", 0.6)).said == "A knife is used for cutting."
    assert spoken(taught, ("what is a knife used for", 0.5)).ending == "asked"


@pytest.mark.parametrize(
    "answer",
    [
        [("yes", 0.4), ("no", 0.1)],
        [("yes", 0.4), (GIVE, 0.3)],
        [("yes", 0.4), ("guess", 0.3)],
        [("guess", 0.5), ("yes", 0.4)],
        [("yes", 0.9), ("do not pass it", 0.05)],
    ],
)
def test_yes_that_may_be_something_else_does_not_count(agent: Agent, answer: list[Alternative]):
    """It must be twice as sure as all else together, and nothing may deny."""
    spoken(agent, (USES, 0.6))

    assert spoken(agent, *answer).ending in {"asked", "not_understood"}
    assert not agent.base.rules()


@pytest.mark.parametrize(
    "answer", [[("the second", 0.2)], [("2", 0.3), ("number two", 0.2)], [(GIVE, 0.4)]]
)
def test_choice_is_made_by_number_or_by_its_text(agent: Agent, answer: list[Alternative]):
    """Of several readings one is taken by its place, or by saying it again."""
    spoken(agent, (USES, 0.6), (GIVE, 0.3))

    assert (spoken(agent, *answer).text, agent.base.rules()) == (GIVE, [])


def test_typed_answer_answers_what_was_read_back(agent: Agent):
    """The answer to a spoken question may be typed."""
    spoken(agent, (USES, 0.6), (GIVE, 0.3))

    assert agent.hear("the first one").ending == "done"


def test_what_is_not_understood_changes_nothing(agent: Agent):
    """What sounds like no sentence is answered as if it were typed."""
    reply = spoken(agent, ("gaga blub dada", 0.95))

    assert reply.ending == "not_understood"
    assert [said.accepted for said in agent.base.history()] == [False]


def test_hearing_with_one_certain_alternative_is_as_typed(agent: Agent):
    """What needs no question gets the answer that a typed text gets."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as typed:
        for text in (USES, GIVE, "what is a knife used for", "thanks", "wait"):
            assert spoken(agent, (text, 1.0)).said == typed.hear(text).said


@pytest.mark.parametrize(
    ("text", "alternatives", "wanted"),
    [
        ("pass me the top", [("stop", 0.0)], "stop"),
        ("pass it", [("wait", 0.01)], "wait"),
        ("wait", [("stop", 0.01)], "stop"),
        ("pass me the mug", [("do not pass me the mug", 0.01)], "stop"),
        ("no", [("no", 0.2)], "stop"),
        ("put it down", [("put it down", 0.2)], "stop"),
        ("go on", [("go on", 0.95)], "continue"),
        ("go on", [("go on", 0.5)], None),
        ("pass me the mug", [("pass me the rug", 0.3)], None),
    ],
)
def test_what_interrupts_needs_no_certainty(
    language: Language, text: str, alternatives: list[Alternative], wanted: str | None
):
    """Anything that may be a "stop" stops the arm; only going on must be sure."""
    found = reaction(text, weigh(text, 0.5, alternatives), language, is_spoken=True)

    assert (found and found[1].control) == wanted


def test_typed_no_interrupts_nothing(language: Language):
    """A typed "no" waits until the command is done."""
    assert reaction("no", {"no": 1.0}, language, is_spoken=False) is None


@pytest.mark.sim
def test_unsure_stop_ends_the_motion():
    """While the arm moves, an alternative "stop" with a low score ends the command."""
    with Agent.open("memory:", AgentConfig(scene="objects:knife,mug", seed=3)) as agent:
        replies: list[Reply] = []
        started = agent.body.world.time
        thread = Thread(target=lambda: replies.append(agent.hear("pass me the knife")))
        thread.start()
        while thread.is_alive() and agent.body.world.time < started + 1:
            pass
        stopped = spoken(agent, ("the top", 0.6), ("stop", 0.01))
        thread.join()

    assert replies[0].is_interrupted
    assert (stopped.ending, stopped.text) == ("done", "stop")


def test_history_keeps_what_was_taken_and_how_sure(agent: Agent):
    """The question back stands in the history with the text taken and its certainty."""
    spoken(agent, ("a shoe is used for cutting", 0.3), (USES, 0.5))

    (said,) = agent.base.history()
    assert (said.text, said.accepted, said.heard) == (USES, False, pytest.approx(0.5))


@pytest.fixture
def agent() -> Iterator[Agent]:
    """An agent that was taught nothing, with a knife and a mug in view."""
    with Agent.open("memory:", AgentConfig(simulate=False, scene="objects:knife,mug")) as opened:
        yield opened
