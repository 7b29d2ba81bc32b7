"""Answers and phrases from templates."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.nlu import ANY_OBJECT, ActionRule, FunctionalRule, Language, Rule
from hilt.nlu.generation.templates import PHRASES, load_answers
from hilt.ontology.errors import DataError, UnknownNameError

SURE = (0.95, 1.0)
NEVER = (0.0, 0.05)


@pytest.mark.parametrize(
    ("rule", "words"),
    [
        (FunctionalRule("knife", "cutting", SURE), "a knife is used for cutting"),
        (FunctionalRule("egg", "rolling", NEVER), "an egg is not used for rolling"),
        (ActionRule("knife", "pass", "blade", SURE), "to pass a knife, grab it by the blade"),
        (
            ActionRule("mug", "pickUp", "handle", SURE, ("red",)),
            "to pick up a red mug, grab it by the handle",
        ),
        (
            ActionRule("knife", "cut", "blade", NEVER),
            "to cut with a knife, never grab it by the blade",
        ),
        (
            ActionRule(ANY_OBJECT, "pass", "handle", SURE, ("sharp",)),
            "to pass something sharp, grab it by the handle",
        ),
    ],
)
def test_rules_are_put_into_words(language: Language, rule: Rule, words: str) -> None:
    """Articles, particles and prepositions are right."""
    assert language.answers.rule_phrase(rule) == words


@pytest.mark.parametrize(
    "rule",
    [
        FunctionalRule("wine glass", "containing", SURE),
        FunctionalRule("spoon", "cutting", NEVER),
        FunctionalRule(ANY_OBJECT, "cutting", SURE, ("sharp",)),
        ActionRule("knife", "pointTo", "blade", SURE),
        ActionRule("hammer", "pound", "handle", SURE),
        ActionRule("hammer", "use", "handle", SURE),
        ActionRule(ANY_OBJECT, "pass", "handle", SURE),
        ActionRule("mug", "pickUp", "handle", NEVER, ("red",)),
    ],
)
def test_the_phrase_of_a_rule_is_parsed_to_it(language: Language, rule: Rule) -> None:
    """Hilt parses its own phrases."""
    meaning = language.understand(language.answers.rule_phrase(rule)).meaning

    assert meaning.as_json() == rule.as_json()


@pytest.mark.parametrize(
    ("key", "slots", "said"),
    [
        (
            "learned",
            {"rules": ("to pass a knife, grab it by the blade",)},
            "I learned: to pass a knife, grab it by the blade.",
        ),
        ("learned", {"rules": ("x", "y")}, "I learned: x, and y."),
        (
            "passed_by",
            {"object": "knife", "part": "blade"},
            "Here is the knife. I'm holding it by the blade.",
        ),
        ("nothing_used_for", {"affordance": "rolling"}, "I don't see anything for rolling."),
        ("will_not", {"goal": "pickUp", "object": "mug"}, "All right, I won't pick up the mug."),
        ("see", {"objects": ["knife", "mug", "egg"]}, "I see a knife, a mug and an egg."),
        (
            "done_with_tool",
            {"goal": "pound", "patient": "nail", "tool": "hammer"},
            "I pounded the nail with the hammer.",
        ),
        ("why_not_seen", {"object": "knife"}, "Not the knife, because I don't see it."),
        ("why_not_seen", {"object": "scissors"}, "Not the scissors, because I don't see them."),
        ("hello", {"speaker": "zoë ünal"}, "Hello Zoë Ünal."),
        ("trusts", {"speaker": "Ada de la Cruz"}, "Yes, I trust Ada de la Cruz."),
        (
            "known_many",
            {"number": "4", "objects": ("knife", "mug")},
            "I was taught 4 rules, for example about knives and mugs. Ask me about one of them.",
        ),
    ],
)
def test_answers_are_filled_in(
    language: Language, key: str, slots: dict[str, object], said: str
) -> None:
    """Each slot takes the form that its place asks for."""
    assert language.say(key, **slots) == said  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("key", "slots"), [("hum", {}), ("passed", {}), ("okay", {"object": "mug"})]
)
def test_a_wrong_key_or_slot_is_an_error(
    language: Language, key: str, slots: dict[str, str]
) -> None:
    """The error lists what there is."""
    with pytest.raises(UnknownNameError):
        language.say(key, **slots)


@pytest.mark.parametrize(
    ("answer", "message"),
    [("[Yes]", "expected a text"), ('"{object:dual}"', 'there is no form "dual"')],
)
def test_a_wrong_template_is_an_error(
    language: Language, tmp_path: Path, answer: str, message: str
) -> None:
    """A template is checked when it is read."""
    path = tmp_path / "answers.yaml"
    path.write_text(
        f"answers: {{a: {answer}}}\nphrases: {{{', '.join(f'{each}: x' for each in PHRASES)}}}\n",
        encoding="utf-8",
    )

    with pytest.raises(DataError, match=message):
        load_answers(path, language.builder, {})
