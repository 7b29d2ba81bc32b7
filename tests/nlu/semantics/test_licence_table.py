"""The licence: which features of a sentence let it become a rule, and how sure it is then."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.nlu import Language
from hilt.nlu.semantics.clause_features import UtteranceFeatures
from hilt.nlu.semantics.licence_table import ACCEPT, KINDS, bounded, load_licence
from hilt.nlu.semantics.meaning import ActionRule, AskBack, FunctionalRule, Retraction, Statement
from hilt.ontology.errors import DataError

HOLDING = Statement((ActionRule("knife", "pass", "blade", (0.95, 1.0)),))
USE = Statement((FunctionalRule("shoe", "pounding", (0.95, 1.0)),))
VALUES = {"agent": frozenset({"other"}), "modality": frozenset({"weak"})}
DEGREES = {"sometimes": (0.5, 1.0)}

INTERVALS = st.tuples(st.floats(0, 1), st.floats(0, 1)).map(lambda pair: (min(pair), max(pair)))


def features(**values: str) -> UtteranceFeatures:
    """The features of a main clause."""
    return UtteranceFeatures({name: frozenset({value}) for name, value in values.items()})


@pytest.mark.parametrize("feature", [{"agent": "other"}, {"tense": "past"}, {"modality": "weak"}])
def test_a_report_of_holding_is_asked_about(language: Language, feature: dict[str, str]) -> None:
    """What somebody else does, did or might do is no rule for the robot."""
    licence = language.parser.licence

    assert licence.outcome(HOLDING, features()) == ACCEPT
    assert licence.outcome(HOLDING, features(**feature)) != ACCEPT


@pytest.mark.parametrize("feature", [{"modality": "weak"}, {"attitude": "perhaps"}])
def test_a_possible_use_is_asked_about(language: Language, feature: dict[str, str]) -> None:
    """Nobody said that it is so."""
    assert language.parser.licence.outcome(USE, features(**feature)) == "ask_belief"


@pytest.mark.parametrize(
    "text",
    [
        "a spatula might be used for cutting",
        "you might pass a knife by the blade",
        "it might be better to pick up a spoon by the handle",
    ],
)
def test_what_is_only_possible_is_asked_about_as_less_sure(language: Language, text: str) -> None:
    """A "yes" to the question teaches no more than was said."""
    found = language.understand(text).meaning

    assert isinstance(found, AskBack)
    assert [choice.rules[0].confidence for choice in found.choices] == [(0.5, 1.0)]


def test_a_hedged_use_is_a_less_sure_rule(language: Language) -> None:
    """What is said with a hedge is sometimes so."""
    licence, hedged = language.parser.licence, features(attitude="hedged")

    assert licence.outcome(USE, hedged) == ACCEPT
    assert licence.weakened(USE, hedged) == Statement(
        (FunctionalRule("shoe", "pounding", (0.5, 1.0)),)
    )


def test_other_meanings_need_no_licence(language: Language) -> None:
    """A retraction of what was said last is no matter of who does it."""
    assert language.parser.licence.outcome(Retraction(), features(agent="other")) == ACCEPT


@given(INTERVALS, INTERVALS, INTERVALS)
def test_a_bound_never_makes_a_rule_surer(
    interval: tuple[float, float], one: tuple[float, float], other: tuple[float, float]
) -> None:
    """The result contains the interval, and a weaker bound gives a wider one."""
    weak, strong = sorted((one, other))
    wide, narrow = bounded(interval, weak), bounded(interval, strong)

    assert wide[0] <= narrow[0] <= interval[0]
    assert wide[1] + 1e-4 >= narrow[1]
    assert narrow[1] >= interval[1]


FEATURES = st.sampled_from(
    [features(), *(features(attitude=each) for each in ("think", "hedged", "certain"))]
    + [features(quantifier=each) for each in ("most", "partial")]
)


@given(INTERVALS, FEATURES, FEATURES)
def test_a_further_feature_never_makes_a_rule_surer(
    language: Language,
    interval: tuple[float, float],
    one: UtteranceFeatures,
    other: UtteranceFeatures,
) -> None:
    """That is, "I think most shoes .." is no surer than "I think shoes .."."""
    licence = language.parser.licence
    rule = Statement((FunctionalRule("shoe", "pounding", interval),))
    both = UtteranceFeatures({**one.main, **other.main}, aside=one.main)

    (alone,) = licence.weakened(rule, one).rules
    (joined,) = licence.weakened(rule, both).rules
    assert joined.confidence[0] <= alone.confidence[0] <= interval[0]
    assert joined.confidence[1] >= alone.confidence[1] >= interval[1]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("rows: [{of: [use], main: {agent: [nobody]}, then: ask}]\ndegrees: {}", "nobody"),
        ("rows: [{of: [use], main: {colour: [red]}, then: ask}]\ndegrees: {}", "colour"),
        ("rows: [{of: [wish], then: accept}]\ndegrees: {}", "wish"),
        ("rows: [{of: [use], then: accept}]\ndegrees: {}", "no last row"),
        (
            f"rows: [{{of: [{', '.join(KINDS)}], then: accept}}]\n"
            "degrees: {modality: {weak: often}}",
            "often",
        ),
    ],
)
def test_a_table_with_an_error_is_refused(tmp_path: Path, text: str, problem: str) -> None:
    """An unknown feature, value, kind or degree, and a kind without a last row."""
    path = tmp_path / "licence.yaml"
    path.write_text(text, encoding="utf-8")

    with pytest.raises(DataError, match=problem):
        load_licence(VALUES, DEGREES, path)
