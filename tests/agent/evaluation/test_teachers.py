"""Scenarios in which teachers disagree: the exact reference, and that the agent agrees with it."""

from __future__ import annotations

from fractions import Fraction

import pytest
from teachers import DisputedScenario, Opinion, TeachersExperiment, fused, plausibility, standing

from hilt.inference.interval_operators import Operators
from hilt.inference.settings import Settings


def opinion(speaker: str, word: str, rank: int = 1, conclusion: str = "cutting") -> Opinion:
    """What a teacher says of knives."""
    return Opinion(speaker, word, ("cutlery", "knife", "long knife")[rank], rank, conclusion)


@pytest.mark.parametrize(
    ("opinions", "wanted"),
    [
        ([], (0, 1)),
        ([opinion("sam", "often")], (Fraction(3, 4), 1)),
        ([opinion("eve", "always")], (Fraction(1, 2), 1)),
        ([opinion("eve", "never")], (0, Fraction(21, 40))),
        ([opinion("sam", "sometimes"), opinion("eve", "always")], (Fraction(3, 4), 1)),
        ([opinion("sam", "always"), opinion("sam", "never")], (Fraction(1, 20), 1)),
    ],
)
def test_opinions_are_fused_exactly(opinions, wanted):
    """By Yager's rule, each discounted by the trust in its teacher."""
    assert fused(opinions) == wanted


def test_what_may_not_be_acted_on_has_no_score():
    """Ignorance, denial, and what is hardly more true than false."""
    assert plausibility((Fraction(0), Fraction(1))) is None
    assert plausibility((Fraction(0), Fraction(1, 20))) is None
    assert plausibility((Fraction(1, 100), Fraction(1))) is None
    assert plausibility((Fraction(1, 2), Fraction(1))) == Fraction(2, 3)


def test_more_specific_opinions_stand_alone():
    """Of one conclusion the most specific stand; a denied part leaves the other parts standing."""
    general, own, exact = (opinion("sam", "often", rank) for rank in range(3))
    assert standing([general, own, exact]) == [exact]

    never_blade = opinion("sam", "never", 2, "blade")
    handle, blade = (opinion("ann", "often", 1, part) for part in ("handle", "blade"))
    assert standing([handle, blade, never_blade]) == [never_blade, handle]


def test_scenarios_are_drawn_from_the_seed():
    """The same seed says the same, another one something else, each sentence once."""
    told = DisputedScenario("A", 5).told()

    assert told == DisputedScenario("A", 5).told() != DisputedScenario("A", 6).told()
    assert len(told) == len(set(told)) > 100


def wrong_keys(experiment: TeachersExperiment) -> list[str]:
    """The cases that come out wrong."""
    return [case.key for case in experiment.cases() if not experiment.run(case).right]


def test_agent_agrees_with_the_reference():
    """Every command of three scenes, in two scenarios."""
    assert wrong_keys(TeachersExperiment(seed=4, scenes=3)) == []


def test_another_fusion_is_noticed(monkeypatch: pytest.MonkeyPatch):
    """The paper's own run has one rule for each cell, where all fusions agree."""
    other = Settings(operators=Operators(fusion="mean"))
    monkeypatch.setattr(Settings, "load", lambda *_: other)

    assert wrong_keys(TeachersExperiment(seed=4, scenes=1)) != []
