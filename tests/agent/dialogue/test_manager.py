"""Dialogue: what is believed, done and answered, and what is not."""

from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.dialogue.reply import Reply


def part(reply: Reply) -> str | None:
    """The part that a command decided on."""
    assert reply.result is not None
    return reply.result.decision.chosen_part if reply.result.decision else None


# --- The running example -------------------------------------------------------------------


def test_nothing_is_known_before_it_is_told(agent: Agent):
    """Without the sentences the command fails with the right answer."""
    reply = agent.hear("pass me something used for cutting")

    assert (reply.ending, reply.said) == (
        "failed",
        "I don't see anything for cutting. What is used for cutting?",
    )
    assert agent.base.rules() == []


def test_knife_is_passed_by_the_blade_once_told(taught: Agent):
    """The three sentences decide what is passed, and how."""
    reply = taught.hear("pass me something used for cutting")

    assert (reply.said, part(reply)) == ("I would pass the knife by the blade.", "blade")


def test_same_knife_is_picked_up_by_the_handle(taught: Agent):
    """The context decides the part."""
    assert part(taught.hear("pick up the knife")) == "handle"


def test_exchanged_sentences_exchange_the_parts(agent: Agent):
    """Nothing but the sentences says which part it is."""
    agent.hear("To pickup a knife grab the knife by the blade")
    agent.hear("To pass a knife grab the knife by the handle")

    assert part(agent.hear("pick up the knife")) == "blade"
    assert part(agent.hear("pass me the knife")) == "handle"


def test_decision_rests_on_the_rules_that_were_told(taught: Agent):
    """The reasons name the rule of the object and the rule of the part."""
    reply = taught.hear("pass me something used for cutting")

    assert reply.result is not None and reply.result.decision is not None
    texts = [taught.base.utterance(r.utterance or 0).text for r in reply.result.decision.rules]
    assert texts == ["A knife is used for cutting", "To pass a knife grab the knife by the blade"]


def test_walk_has_four_operations_at_each_node_in_preorder(taught: Agent):
    """Each node says what was looked for, seen, concluded and done."""
    reply = taught.hear("pass me something used for cutting")

    assert reply.result is not None
    steps = {step.node: step for step in reply.result.steps}
    assert list(steps) == [
        "pass", "pass/findObject", "pass/graspObject", "pass/moveTo", "pass/handOver",
    ]  # fmt: skip
    assert steps["pass/findObject"].features == ("object:knife",)
    assert steps["pass/findObject"].percepts == {"knife": 1.0}
    grasp = steps["pass/graspObject"].constraint
    assert grasp is not None
    assert (grasp.object, grasp.part, grasp.interval.lower) == ("knife", "blade", 0.95)


def test_tool_is_chosen_by_what_the_action_needs(agent: Agent):
    """Pounding a nail looks for something used for pounding (section 4.2)."""
    agent.hear("A hammer is used for pounding")

    reply = agent.hear("pound the nail")

    assert reply.said == "I would pound the nail with the hammer."


# --- Being told ----------------------------------------------------------------------------


def test_what_was_learned_is_said_back_in_words(agent: Agent):
    """The echo is made from the rule that was stored."""
    reply = agent.hear("To pass a knife grab it by the blade")

    assert reply.said == "I learned: to pass a knife, grab it by the blade."


def test_same_thing_told_twice_is_one_rule(agent: Agent):
    """Repetition is not evidence."""
    agent.hear("A knife is used for cutting")
    again = agent.hear("A knife is used for cutting")

    assert again.said.startswith("I already know that from Sam")
    assert len(agent.base.rules()) == 1


def test_untrusted_speaker_is_neither_believed_nor_obeyed(taught: Agent):
    """Who is not trusted changes nothing, and hears why."""
    before = taught.base.rules()

    told = taught.hear("A mug is used for cutting", speaker="mallory")
    asked = taught.hear("pass me the knife", speaker="mallory")

    assert (told.ending, asked.ending) == ("refused", "refused")
    assert "Mallory" in told.said
    assert taught.base.rules() == before


def test_trust_can_be_given_and_counts(agent: Agent):
    """What a half-trusted speaker says generally is believed to .475."""
    agent.base.set_trust("kim", 0.5)
    agent.hear("A knife is used for cutting", speaker="kim")

    reply = agent.hear("pass me something used for cutting")

    assert reply.result is not None and reply.result.decision is not None
    best = reply.result.decision.object.best
    assert best is not None and best.interval.lower == pytest.approx(0.475)


def test_trust_that_is_withdrawn_counts_at_once(agent: Agent):
    """A decision after the change uses the new trust."""
    agent.base.set_trust("kim", 1.0)
    agent.hear("A knife is used for cutting", speaker="kim")
    before = agent.hear("pass me something used for cutting")
    agent.base.set_trust("kim", 0.0)

    after = agent.hear("pass me something used for cutting")

    assert (before.ending, after.ending) == ("done", "failed")


@pytest.mark.parametrize("command", ["pick up the shoe", "pass me the knife"])
@pytest.mark.parametrize("text", ["forget what I just said", "forget that"])
def test_forgetting_after_a_deed_asks_first(taught: Agent, command: str, text: str):
    """It was the deed that was spoken of, not what it rests on."""
    taught.hear(command)

    assert taught.hear(text).said.startswith("Should I forget this: ")
    assert len(taught.base.rules()) == 3
    assert taught.hear("yes").said.startswith("Okay, I no longer believe this: ")


def test_reason_of_a_deed_can_be_taken_back(taught: Agent):
    """Once it was spoken of."""
    taught.hear("pass me the knife")
    taught.hear("why?")

    assert taught.hear("forget that").said.startswith("Okay, I no longer believe this: to pass")


def test_nobody_takes_back_what_another_told(taught: Agent):
    """Nor something else instead."""
    taught.base.set_trust("anna", 1.0)
    taught.hear("A spoon is used for stirring", speaker="anna")

    assert "Anna told me" in taught.hear("forget that").said
    assert len(taught.base.rules()) == 4


def test_forgetting_takes_back_the_last_rule_and_keeps_history(taught: Agent):
    """What was forgotten is no reason any more, but can be told."""
    reply = taught.hear("forget that")

    assert reply.said.startswith("Okay, I no longer believe this: to pass")
    assert part(taught.hear("pass me the knife")) is None
    assert [u.text for u in taught.base.history()][2] == LESSON_THREE


LESSON_THREE = "To pass a knife grab the knife by the blade"


# --- Being asked, and not understanding -----------------------------------------------------


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("what is a knife used for?", "A knife is used for cutting."),
        ("what is used for cutting?", "For cutting, I know of a knife."),
        ("how do you pass a knife?", "To pass a knife, grab it by the blade."),
        ("is a knife used for cutting?", "Yes: a knife is used for cutting."),
        ("is a mug used for cutting?", "Nobody has told me that a mug is used"),
        ("what is a mug used for?", "I don't know what a mug is used for."),
    ],
)
def test_questions_are_answered_from_what_was_told(taught: Agent, question: str, answer: str):
    """Answers name things and uses, without any number."""
    assert taught.hear(question).said.startswith(answer)


@pytest.mark.parametrize(
    ("said", "reasons"),
    [
        ("A hammer is used for pounding because it is heavy", ["heavy"]),
        ("A knife is used for cutting, since it is so sharp", ["sharp"]),
        ("Because it is heavy, a hammer is used for pounding", ["heavy"]),
        ("A hammer is used for pounding because it is nice", []),
        ("To pass a knife, grab it by the blade because it is sharp", []),
    ],
)
def test_reason_of_a_use_is_kept_and_asserts_nothing(agent: Agent, said: str, reasons: list[str]):
    """The properties are a rule about anything with them, on which no decision rests."""
    reply = agent.hear(said)

    kept = [rule for rule in agent.base.rules() if rule.object is None]
    assert sorted(atom.name for rule in kept for atom in rule.features) == reasons
    assert all(rule.interval.is_vacuous for rule in kept)
    assert len(reply.rules) == 1
    assert ("because of being" in reply.said) == bool(reasons)
    assert "occasionally" not in agent.hear("what do you know?").said


def test_how_is_answered_by_the_nearest_rule(agent: Agent):
    """What is told of any object holds of those with the part, unless their own rule says more."""
    agent.hear("To pass anything, grab it by the handle")
    agent.hear("To pass a knife, grab it by the blade")

    assert (
        agent.hear("How do you pass a hammer?").said == "To pass an object, grab it by the handle."
    )
    assert agent.hear("How do you pass a knife?").said == "To pass a knife, grab it by the blade."
    assert "Nobody has told me" in agent.hear("How do you pass a shoe?").said
    assert "Nobody has told me" in agent.hear("How do you pick up a hammer?").said


def test_why_is_answered_with_the_sentence_it_rests_on(taught: Agent):
    """The reason of an action is what somebody said."""
    taught.hear("pass me something used for cutting")

    assert (
        taught.hear("why?").said
        == f'Because Sam said: "A knife is used for cutting" and "{LESSON_THREE}".'
    )


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("why the blade?", f'Because Sam said: "{LESSON_THREE}".'),
        ("why the knife?", 'Because Sam said: "pass me the knife".'),
        ("why the spoon?", "But it was not the spoon."),
        ("why the handle?", "But it was not the handle."),
        ("why not the knife?", "But it was the knife."),
        ("why not by the blade?", "But it was the blade."),
        ("why not by the handle?", f'Not by the handle, because Sam said: "{LESSON_THREE}".'),
    ],
)
def test_reasons_are_those_of_what_is_asked_about(taught: Agent, question: str, answer: str):
    """The thing was named by the command, the part by a rule; and what was not done has none."""
    taught.hear("pass me the knife")

    assert taught.hear(question).said == answer


def test_the_reason_of_what_was_named_is_the_command(agent: Agent):
    """No rule is needed for it."""
    agent.hear("could I have the spoon, please?")

    assert agent.hear("why?").said == 'Because Sam said: "could I have the spoon, please?".'


@pytest.mark.parametrize("question", ["who told you that?", "why?"])
def test_bare_questions_are_about_what_was_last_spoken_of(taught: Agent, question: str):
    """Not about the last sentence that was told, nor the last thing that was done."""
    taught.hear("pass me the knife")
    taught.hear("A mug is used for containing")
    taught.hear("how sure are you that a knife is used for cutting?")

    assert "A knife is used for cutting" in taught.hear(question).said


@pytest.mark.parametrize(
    ("recipient", "named"), [("the child", "the child"), ("kim", "Kim"), ("Zoë Ünal", "Zoë Ünal")]
)
def test_recipients_are_named_as_people_are(taught: Agent, recipient: str, named: str):
    """By what they are, or by their names with capital letters."""
    taught.hear("You can trust Zoë Ünal and Kim")

    said = taught.hear(f"pass the knife to {recipient}").said

    assert said == f"I would pass the knife by the blade to {named}."


@pytest.mark.parametrize(
    ("question", "answer"),
    [("do you see a mug?", "I see a mug."), ("where is the nail?", "I don't see a nail.")],
)
def test_who_asks_for_one_thing_hears_of_that_one(taught: Agent, question: str, answer: str):
    """The others are not listed."""
    assert taught.hear(question).said == answer


@pytest.mark.parametrize(
    ("command", "question", "reason"),
    [
        ("pass me something used for cutting", "spoon", "nobody has told me that a spoon is used"),
        ("pass me something used for cutting", "nail", "I don't see it"),
        ("pass me the knife", "spoon", "I was asked for the knife"),
    ],
)
def test_why_not_says_what_speaks_against_the_other(
    taught: Agent, command: str, question: str, reason: str
):
    """Not told of, not seen and not asked for are three reasons."""
    taught.hear(command)

    assert reason in taught.hear(f"why not the {question}?").said


@pytest.mark.parametrize(
    ("denial", "command", "question", "answer"),
    [
        (
            "A spoon is rarely used for cutting.",
            "pass me something used for cutting",
            "why not the spoon?",
            'Not the spoon, because Sam said: "A spoon is rarely used for cutting".',
        ),
        (
            "Never pass a knife by the handle.",
            "pass me the knife",
            "why not by the handle?",
            'Not by the handle, because Sam said: "Never pass a knife by the handle".',
        ),
    ],
)
def test_what_was_denied_is_the_reason_why_not(
    taught: Agent, denial: str, command: str, question: str, answer: str
):
    """Rather than what was said of the one that was taken; quotes have no stops of their own."""
    taught.hear(denial)
    taught.hear(command)

    assert taught.hear(question).said == answer


def test_what_seldom_holds_is_not_said_to_hold_never(agent: Agent):
    """Seldom is less than never."""
    assert "a shoe is rarely used for" in agent.hear("A shoe is rarely used for pounding").said
    assert "a shoe is not used for" in agent.hear("A shoe is never used for poking").said


@pytest.mark.parametrize(
    ("command", "question"),
    [
        ("pass me the elephant", "What is it, or what is it used for?"),
        ("pass me something used for flying", "What is used for flying?"),
    ],
)
def test_what_an_unknown_word_may_be_is_asked_for(agent: Agent, command: str, question: str):
    """A thing, or a use."""
    assert agent.hear(command).said.endswith(question)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "   ",
        "knife",
        "pass me",
        "To pass a knife grab",
        "pass me something used for",
        "x" * 10_000,
        "pass the knife and banana phone",
        "colourless green ideas sleep furiously",
    ],
)
def test_nonsense_changes_nothing_and_is_told(taught: Agent, text: str):
    """Half sentences and noise are neither believed nor obeyed."""
    before = taught.base.rules()

    reply = taught.hear(text)

    assert reply.ending in {"not_understood", "asked"}
    assert reply.said
    assert reply.result is None
    assert taught.base.rules() == before


def test_nobody_is_expected_to_make_a_slip(agent: Agent):
    """That one could go on with "no, sorry" is no help."""
    reply = agent.hear("the mug on")

    assert "sorry" not in reply.said
    assert reply.said.endswith('Try, for example, "Point to the mug".')


def test_forbidden_act_is_not_carried_out(taught: Agent):
    """A negated command is acknowledged and refused."""
    reply = taught.hear("do not pass me the knife")

    assert (reply.ending, reply.result) == ("refused", None)


@pytest.mark.parametrize(
    ("only", "text"),
    [("tell", "pass me the knife"), ("do", "A mug is used for cutting"), ("ask", "pick it up")],
)
def test_listening_for_one_kind_refuses_the_others(taught: Agent, only: str, text: str):
    """`hilt tell` moves nothing and `hilt do` believes nothing."""
    before = taught.base.rules()

    reply = taught.hear(text, only=only)

    assert reply.ending == "not_understood"
    assert reply.result is None
    assert taught.base.rules() == before


# --- Memory --------------------------------------------------------------------------------


def test_every_utterance_is_in_the_history(taught: Agent):
    """Commands, refusals and nonsense are kept beside what was believed."""
    taught.hear("pass me the knife")
    taught.hear("gibberish blah blah")

    kinds = [(utterance.kind, utterance.accepted) for utterance in taught.base.history()]

    assert kinds[:3] == [("statement", True)] * 3
    assert kinds[3] == ("command", True)
    assert kinds[4][1] is False


def test_command_leaves_an_episode_with_its_reasons(taught: Agent):
    """What was decided can be asked of the graph afterwards."""
    reply = taught.hear("pass me something used for cutting")

    (episode,) = taught.base.episodes()

    assert (episode.object, episode.part, episode.outcome) == ("knife", "blade", "done")
    assert reply.result is not None and reply.result.decision is not None
    assert set(episode.rules) == {rule.id for rule in reply.result.decision.rules}


# --- Corrections, confirmations, words ------------------------------------------------------


def test_correction_supersedes_what_was_told(agent: Agent):
    """No, by the blade: takes the place of the handle."""
    agent.hear("To pass a knife grab it by the handle")
    reply = agent.hear("no, by the blade")

    assert reply.said.startswith("I changed my mind: to pass a knife, grab it by the blade")
    assert [rule.part for rule in agent.base.rules()] == ["blade"]
    assert [rule.part for rule in agent.base.rules(status="superseded")] == ["handle"]


def test_what_is_not_sure_enough_is_asked_and_done_on_yes(agent: Agent):
    """A hardly trusted speaker's rule is asked about; "yes" settles it."""
    agent.base.set_trust("kim", 0.05)
    agent.hear("A mug is used for pounding", speaker="kim")

    asked = agent.hear("pass me something used for pounding")
    done = agent.hear("yes")

    assert (asked.ending, asked.said[-17:]) == ("asked", "Should I take it?")
    assert (done.ending, done.said) == ("done", "I would pass the mug.")


@pytest.mark.parametrize("between", ["no", "what do you see?"])
def test_yes_counts_only_right_after_the_question(agent: Agent, between: str):
    """A "no" or another utterance ends the question."""
    agent.base.set_trust("kim", 0.05)
    agent.hear("A mug is used for pounding", speaker="kim")
    agent.hear("pass me something used for pounding")
    agent.hear(between)

    assert agent.hear("yes").result is None


def test_only_who_was_asked_can_say_yes(agent: Agent):
    """What a bystander says neither settles nor ends the question."""
    agent.base.set_trust("kim", 0.05)
    agent.hear("A mug is used for pounding", speaker="kim")
    agent.hear("pass me something used for pounding")

    assert agent.hear("yes", speaker="kim").result is None
    assert agent.hear("yes").ending == "done"


def test_recognition_score_discounts_what_is_learned(agent: Agent):
    """Heard to .8, generally counts as .76, and the answer shows the doubt."""
    reply = agent.hear("A spoon is used for poking", heard=0.8)

    (rule,) = agent.base.rules()
    assert rule.interval.lower == pytest.approx(0.76)
    assert reply.said.startswith("If I heard you right: a spoon is")
    assert agent.base.utterance(1).heard == 0.8


def test_what_was_badly_heard_is_asked_about_first(agent: Agent):
    """Nothing is believed of it before a "yes"; the question and the score are in the history."""
    reply = agent.hear("A spoon is used for poking", heard=0.5)

    assert reply.ending == "asked"
    assert not agent.base.rules()
    assert reply.said == 'I didn\'t hear that well. Did you say "A spoon is used for poking"?'
    assert agent.base.utterance(1).heard == 0.5
    assert agent.hear("yes").rules[0].interval.lower == pytest.approx(0.95)


@pytest.mark.parametrize("text", ["pass me the knife", "could you pass me the knife?"])
def test_a_badly_heard_command_is_not_carried_out(agent: Agent, text: str):
    """That it is wanted is as sure as it was heard, and less by the rule for indirect requests."""
    assert agent.hear(text, heard=0.9).result is not None
    assert agent.hear(text, heard=0.4).result is None
    assert agent.hear("no").result is None


def test_new_words_are_usable_at_once(agent: Agent):
    """Object and affordance learned from one sentence are understood in the next."""
    reply = agent.hear("A saw is used for slicing")

    assert [word.as_json()["word"] for word in reply.understanding.new_words] == ["saw", "slicing"]
    assert agent.hear("what are saws used for?").said == "A saw is used for slicing."
    assert [word.atom.name for word in agent.base.words()] == ["slicing", "saw"]


def test_untrusted_speaker_teaches_no_words(agent: Agent):
    """What is not believed is not learned."""
    agent.hear("A saw is used for slicing", speaker="mallory")

    assert agent.base.words() == []
    assert agent.hear("what are saws used for?").ending != "done"


def test_robot_that_induces_passes_what_is_like_a_knife_like_a_knife():
    """It acts on likeness when asked to, says so, and drops the guess when it is taught."""
    with Agent.open("memory:", AgentConfig(simulate=False, induce=True)) as inducing:
        inducing.hear("To pass a knife grab it by the blade")
        guessed = part(inducing.hear("pass me the screwdriver"))
        why = inducing.hear("why?").said
        inducing.hear("To pass a screwdriver grab it by the handle")

        assert part(inducing.hear("pass me the screwdriver")) == "handle"

    assert guessed == "shaft"
    assert (
        why == 'Because it is similar to what I was told: "To pass a knife grab it by the blade".'
    )


def test_part_that_is_not_sure_enough_is_asked_about(agent: Agent):
    """A rule too weak to act on is a reason to ask, not to grasp anywhere."""
    agent.base.set_trust("kim", 0.05)
    agent.hear("To pass a mug grab it by the barrel", speaker="kim")

    reply = agent.hear("pass me the mug")

    assert reply.ending == "asked"
    assert reply.said == "I'm not sure enough how to pass a mug. By the barrel?"


@pytest.mark.parametrize(
    "turn", ["how do you pass a knife?", "pass me something used for cutting", "why the blade?"]
)
def test_correction_is_about_what_was_last_spoken_of(taught: Agent, turn: str):
    """After an answer or a deed, "no" corrects the rule that it rests on, not the last one told."""
    taught.hear("pass me the knife")
    taught.hear("A hammer is used for pounding")
    taught.hear(turn)

    assert taught.hear("no, by the handle").said.startswith("I changed my mind: to pass a knife")


@pytest.mark.parametrize(
    ("told", "correction", "left"),
    [
        ("A spoon is used for cutting.", "No, I meant the knife.", "knife"),
        ("A knife is used for rolling.", "Oops, make that cutting.", "knife"),
    ],
)
def test_a_correction_may_change_the_object_or_the_use(
    agent: Agent, told: str, correction: str, left: str
) -> None:
    """The rule that was just told goes, and the corrected one stays."""
    agent.hear(told)

    said = agent.hear(correction).said

    rules = agent.base.rules(speaker="sam")
    assert said.startswith("I changed my mind")
    assert [str(rule.argument) for rule in rules] == ["affordance:cutting"]
    assert all(left in str(rule) for rule in rules)


def test_what_is_forgotten_is_what_was_last_spoken_of(taught: Agent):
    """An answer in between makes its rule "that"."""
    taught.hear("A hammer is used for pounding")
    taught.hear("how do you pass a knife?")

    assert taught.hear("forget that").said.startswith("Okay, I no longer believe this: to pass")


def test_a_speaker_known_to_the_base_may_be_asked_about(tmp_path: Path):
    """The name needs no capital letter."""
    with Agent.open(str(tmp_path / "kb"), AgentConfig(simulate=False)) as before:
        before.base.set_trust("kim", 0.5)

    with Agent.open(str(tmp_path / "kb"), AgentConfig(simulate=False)) as agent:
        reply = agent.hear("do you trust kim?")

    assert "kim" in reply.said.lower()


# --- What is only believed after a yes ----------------------------------------------------------


def test_what_is_reported_is_believed_only_after_a_yes(agent: Agent):
    """What somebody else does is asked about, and a yes teaches it, with its new words."""
    asked = agent.hear("when people pass a trowel they hold it by the prongs")

    assert asked.ending == "asked"
    assert agent.base.rules() == []
    agent.hear("yes")
    assert [(rule.object, rule.part) for rule in agent.base.rules()] == [("trowel", "prong")]


def test_what_is_reported_is_not_believed_after_a_no(agent: Agent):
    """A no leaves nothing."""
    agent.hear("you might pass a knife by the blade")
    agent.hear("no")

    assert agent.base.rules() == []


def test_another_one_is_none_of_those_chosen_before():
    """Of two mugs the other is chosen, then there is no further one."""
    with Agent.open("memory:", AgentConfig(scene="objects:mug,mug,knife", simulate=False)) as mind:
        replies = [
            mind.hear(said) for said in ("pass me a mug", "no, the other one", "another one")
        ]

    chosen = [reply.result.decision.object.best for reply in replies if reply.result]
    assert [each.name if each else None for each in chosen if each] == ["mug", "mug 2"]
    assert replies[-1].said == "I don't see another one."


def test_what_was_chosen_can_be_referred_to(taught: Agent):
    """The object that a command was carried out with is the referent of "it"."""
    taught.hear("pass me something used for cutting")

    assert taught.hear("what is it used for?").said.startswith("A knife is used for cutting")


@pytest.mark.parametrize(
    "answer", ["no", "no, hamer", "no, I meant hamer", "yes, it is new", "it's a new word"]
)
def test_a_new_word_is_asked_about_once(agent: Agent, answer: str):
    """Whatever the speaker insists with, the word is learned and never questioned again."""
    assert agent.hear("A hamer is used for pounding").ending == "asked"

    learned = agent.hear(answer)

    assert [rule.object for rule in learned.rules] == ["hamer"]
    assert agent.hear("a hamer is used for cutting").ending == "done"


def test_a_part_may_become_an_object(agent: Agent):
    """A handle is a part of something unless somebody says that it is sold by itself."""
    assert agent.hear("A handle is used for holding").ending == "asked"
    assert [rule.object for rule in agent.hear("yes").rules] == ["handle"]
    assert agent.hear("A handle is used for lifting").ending == "done"
    assert agent.hear("To pass a mug, grab it by the handle").rules[0].part == "handle"


def test_several_sentences_are_heard_one_after_the_other(agent: Agent):
    """A lesson and a command in one utterance; the reply has what all of them led to."""
    reply = agent.hear(
        "A knife is used for cutting bread. Now pass me something to cut bread with."
    )

    assert reply.is_done
    assert reply.said == "I learned: a knife is used for cutting bread. I would pass the knife."
    assert [rule.id for rule in reply.rules] == [rule.id for rule in agent.base.rules()]


@pytest.mark.parametrize(
    "text",
    [
        "Pass me the mug. Not now.",
        "A shoe is used for pounding. Just kidding!",
        "A shoe is used for pounding. Not really.",
        "Is that right? A shoe is used for pounding.",
        "Hold the hammer by the head. No, wait. Leave it.",
    ],
)
def test_sentences_that_do_not_stand_alone_teach_and_do_nothing(agent: Agent, text: str):
    """What follows may take back what was said, so all is done or nothing."""
    reply = agent.hear(text)

    assert not reply.is_done
    assert agent.base.rules() == []


def test_sentences_of_which_one_is_not_listened_for_are_not_heard_by_half(agent: Agent):
    """`hilt tell` learns nothing from an utterance that also commands something."""
    reply = agent.hear("A knife is used for cutting bread. Bring me one.", only="tell")

    assert not reply.is_done
    assert agent.base.rules() == []
