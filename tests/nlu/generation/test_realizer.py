"""Round trip: the sentence generated for a meaning is parsed to that meaning."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.nlu import (
    ANY_OBJECT,
    Acknowledgement,
    ActionRule,
    AskBack,
    Command,
    FunctionalRule,
    Language,
    Meaning,
    ObjectReference,
    Question,
    Retraction,
    Rule,
    Statement,
    ToolCommand,
)
from hilt.ontology.errors import UnknownNameError

OBJECTS = st.sampled_from(
    ["knife", "spatula", "spoon", "shoe", "hammer", "glass", "mug", "screwdriver", "wine glass"]
)
PARTS = st.sampled_from(["handle", "blade", "bowl", "upper", "sole", "head", "stem", "shaft"])
USES = st.sampled_from(["cutting", "containing", "pounding", "rolling", "poking"])
MATERIALS = st.none() | st.sampled_from(["bread", "wood", "wall", "tent peg", "mug", "old knife"])
PROPS = st.sets(st.sampled_from(["red", "sharp", "wooden"]), max_size=2).map(
    lambda props: tuple(sorted(props))
)
CONFIDENCES = st.sampled_from(
    [(1.0, 1.0), (0.95, 1.0), (0.75, 1.0), (0.5, 1.0), (0.25, 1.0), (0.0, 0.25), (0.0, 0.05)]
)
CONTEXTS = st.sampled_from(["pass", "pickUp", "pointTo", "grasp", "use", "cut", "pound", "poke"])
SOME = st.sampled_from([("red",), ("sharp",), ("sharp", "wooden")])

functional = st.one_of(
    st.builds(FunctionalRule, OBJECTS, USES, CONFIDENCES, PROPS, material=MATERIALS),
    st.builds(FunctionalRule, st.just(ANY_OBJECT), USES, CONFIDENCES, SOME, material=MATERIALS),
)
action = st.builds(
    ActionRule, st.one_of(OBJECTS, st.just(ANY_OBJECT)), CONTEXTS, PARTS, CONFIDENCES, PROPS
)
rules = st.one_of(functional, action)
targets = st.one_of(
    st.builds(lambda name, props: ObjectReference(object=name, props=props), OBJECTS, PROPS),
    st.builds(lambda props: ObjectReference(object=ANY_OBJECT, props=props), SOME),
    st.builds(ObjectReference, used_for=USES, props=PROPS, material=MATERIALS),
    st.builds(ObjectReference, not_used_for=USES, props=PROPS, material=MATERIALS),
)
parts = st.one_of(st.none(), PARTS)
commands = st.one_of(
    st.builds(
        Command,
        st.sampled_from(["pickUp", "pointTo", "grasp", "use"]),
        targets,
        parts,
        st.none(),
        st.booleans(),
    ),
    st.builds(
        Command,
        st.just("pass"),
        targets,
        parts,
        st.one_of(st.none(), st.sampled_from(["bob", "kim"])),
        st.booleans(),
    ),
    st.builds(
        ToolCommand, st.sampled_from(["cut", "pound", "poke"]), OBJECTS, targets, st.booleans()
    ).filter(lambda command: command.tool.object != command.patient),
)
HELD = st.sampled_from(["pass", "pickUp", "pointTo", "cut", "pound"])
ACTS = st.sampled_from(["pass", "pickUp", "pointTo"])
questions = st.one_of(
    st.builds(Question, st.sampled_from(["about", "uses_of", "see", "source"]), OBJECTS),
    st.builds(Question, st.just("see"), OBJECTS, property=st.sampled_from(["red", "clean"])),
    st.builds(Question, st.sampled_from(["why", "why_not"]), OBJECTS),
    st.builds(
        Question,
        st.sampled_from(["confidence", "source", "is_used_for"]),
        OBJECTS,
        affordance=USES,
        material=MATERIALS,
    ),
    st.builds(
        Question,
        st.sampled_from(["about", "best_for", "objects_for", "see"]),
        affordance=USES,
        material=MATERIALS,
    ),
    st.builds(Question, st.just("how"), OBJECTS, context=HELD),
    st.builds(Question, st.just("how"), affordance=USES, context=ACTS, material=MATERIALS),
    st.builds(
        Question,
        st.sampled_from(["how", "confidence", "source"]),
        OBJECTS,
        context=HELD,
        part=PARTS,
    ),
    st.builds(Question, st.sampled_from(["why", "why_not"]), OBJECTS, context=ACTS),
    st.builds(Question, st.just("why"), OBJECTS, context=ACTS, part=PARTS),
    st.builds(Question, st.sampled_from(["why", "why_not"]), part=PARTS),
    st.builds(Question, st.just("what_if"), affordance=USES, material=MATERIALS),
    st.builds(Question, st.just("which_context"), OBJECTS, part=PARTS),
    st.builds(
        Question, st.sampled_from(["capabilities", "see", "trust", "why", "confidence", "source"])
    ),
    st.just(Question("trust", speaker="sam")),
)
replies = st.builds(
    Acknowledgement, st.sampled_from(["okay", "thanks", "praise", "yes", "no", "greeting"])
)


def revised(rule: Rule) -> Statement:
    """A rule that takes the place of another."""
    return Statement((replace(rule, revises=True),))


meanings = st.one_of(
    st.lists(
        rules, min_size=1, max_size=3, unique_by=lambda rule: replace(rule, confidence=(0, 1))
    ).map(lambda each: Statement(tuple(each))),
    rules.map(revised),
    commands,
    questions,
    st.one_of(st.just(Retraction()), st.builds(Retraction, rules)),
    replies,
)


@settings(max_examples=600, deadline=None)
@given(meanings)
def test_a_generated_sentence_is_parsed_to_its_meaning(
    language: Language, meaning: Meaning
) -> None:
    """parse(generate(m)) == m."""
    text = language.generate(meaning)

    assert language.understand(text).meaning == meaning, text


@settings(max_examples=150, deadline=None)
@given(st.one_of(functional, action))
def test_the_sentence_of_a_rule_teaches_it(language: Language, rule: Rule) -> None:
    """The sentence for one rule is one that a person could teach it with."""
    text = language.generate(Statement((rule,)))

    assert language.understand(text).kind == "statement"


@settings(max_examples=100, deadline=None)
@given(st.one_of(functional, action), st.sampled_from(["anna", "kim"]))
def test_a_generated_report_is_parsed_to_its_meaning(
    language: Language, told: Rule, source: str
) -> None:
    """The sentence says who told it."""
    meaning = Statement((replace(told, source=source),))
    text = language.generate(meaning)

    assert language.understand(text).meaning == meaning, text


@pytest.mark.parametrize(
    ("meaning", "text"),
    [
        (
            Statement((FunctionalRule("mug", "containing", (0.75, 1.0), ("red",)),)),
            "a red mug is often used for containing",
        ),
        (
            Statement((ActionRule("knife", "pickUp", "handle", (0.95, 1.0)),)),
            "to pick up a knife, grab it by the handle",
        ),
        (
            Command("pass", ObjectReference(object="knife"), "handle", "kim", True),
            "I do not want you to pass the knife to Kim by the handle",
        ),
        (ToolCommand("pound", "nail", ObjectReference(used_for="pounding")), "pound the nail"),
        (Question("about", "knife"), "what do you know about knives?"),
    ],
)
def test_sentences_are_good_english(language: Language, meaning: Meaning, text: str) -> None:
    """Articles, plurals, particles and word order are right."""
    assert language.generate(meaning) == text


def test_a_meaning_without_a_sentence_is_an_error(language: Language) -> None:
    """A shape without a sentence, or a confidence without a word, is an error."""
    with pytest.raises(UnknownNameError, match="sentence"):
        language.generate(AskBack())
    with pytest.raises(UnknownNameError, match="confidence"):
        language.generate(Statement((FunctionalRule("knife", "cutting", (0.3, 0.4)),)))
