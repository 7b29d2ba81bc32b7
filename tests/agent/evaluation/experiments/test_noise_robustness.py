"""Accuracy against noise: its trials, its curves, and their confidence bands."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.agent.evaluation.experiment import Case, CaseResult
from hilt.agent.evaluation.experiments.noise_robustness import (
    CURVES,
    NoiseExperiment,
    clustered_interval,
    curve_points,
    garble,
    wilson_interval,
)
from hilt.ontology.errors import UnknownNameError

RUN = NoiseExperiment(trials=1)
WORDS = ("knife", "mug", "cutting")


def run(curve: str, line: str, value: float, trial: int = 0) -> CaseResult:
    """One trial at one point."""
    spec = {"curve": curve, "line": line, "value": value, "trial": trial}
    return RUN.run(Case("noise", f"{curve}/{line}/{value:g}/{trial}", spec))


@pytest.mark.parametrize("name", CURVES)
def test_all_is_right_without_trouble(name):
    """At the beginning of each curve all 15 commands are carried out as the scenario wants."""
    line = next(line for line in CURVES[name].lines if line not in CURVES[name].doubtful)

    result = run(name, line, CURVES[name].values[0])

    assert result.right
    assert result.facts["right"] == result.facts["commands"] == 15


@pytest.mark.parametrize(
    ("curve", "line", "value"),
    [("missed", "default", 0.5), ("speech", "dropped", 0.2), ("wrong", "mean", 1.0)],
)
def test_trouble_lowers_the_score(curve, line, value):
    """Eyes that miss, ears that drop words, and teachers who are wrong cost right decisions."""
    result = run(curve, line, value)

    assert result.facts["right"] < result.facts["commands"]


def test_trial_is_the_same_again():
    """A trial depends on its case and the seed only."""
    assert run("confused", "default", 0.3) == run("confused", "default", 0.3)


def test_teacher_whom_nobody_trusts_does_no_harm():
    """What is told with trust 0 is refused."""
    assert run("trust", "yager", 0.0).facts["right"] == 15


def test_only_the_wanted_curves_are_run():
    """One that there is not is refused, with those there are."""
    cases = NoiseExperiment(trials=1, curves="missed, trust").cases()

    assert {case.spec["curve"] for case in cases} == {"missed", "trust"}
    with pytest.raises(UnknownNameError, match='no curve "mist"'):
        NoiseExperiment(curves="mist")


@pytest.mark.sim
def test_robot_acts_in_spite_of_noise():
    """A trial can be carried out; without noise the robot does nearly all that is asked."""
    spec = {"curve": "missed", "line": "default", "value": 0.0, "trial": 0}
    experiment = NoiseExperiment(trials=1, curves="missed", sim=True)

    result = experiment.run(Case("noise", "missed/default/0/0", spec))

    assert result.facts["right"] >= 13


def test_curves_have_a_point_for_each_line_and_value():
    """Trials at the same point are counted together."""
    facts = {"commands": 15, "right": 12, "wrong": 2, "declined": 1}
    keys = [f"trust/{line}/{value}/{trial}" for line in ("yager", "mean") for value in (0, 0.5)
            for trial in (0, 1)]  # fmt: skip
    results = [CaseResult(key, True, "check", 0, "", "", facts) for key in keys]

    (curve,) = curve_points(results)

    assert list(curve["lines"]) == ["yager", "mean"]
    assert [point["x"] for point in curve["lines"]["mean"]] == [0.0, 0.5]
    assert curve["lines"]["mean"][1]["right"] == 24
    assert curve["lines"]["mean"][1]["accuracy"] == 0.8


@given(st.integers(1, 500), st.data())
def test_wilson_holds_the_share(count, data):
    """The band is in [0, 1] and has the share in it, also at its ends."""
    successes = data.draw(st.integers(0, count))
    band = wilson_interval(successes, count)

    assert 0 <= band.lower <= successes / count <= band.upper <= 1


def test_wilson_is_that_of_the_textbook():
    """Ten of ten leaves [.722, 1]; five of ten [.237, .763]."""
    assert wilson_interval(10, 10).lower == pytest.approx(0.7225, abs=1e-4)
    assert (wilson_interval(5, 10).lower, wilson_interval(5, 10).upper) == pytest.approx(
        (0.2366, 0.7634), abs=1e-4
    )


def test_questions_of_one_trial_count_as_fewer_when_they_fail_together():
    """Trials that fail as a whole tell less than as many failures spread over all trials."""
    together = clustered_interval([15, 15, 0, 0], 15)
    spread = clustered_interval([8, 7, 8, 7], 15)

    assert together.upper - together.lower > 1.5 * (spread.upper - spread.lower)


@given(st.lists(st.sampled_from(WORDS), min_size=1), st.integers(0, 99))
def test_garbling_keeps_to_its_rate(words, seed):
    """At rate 0 nothing changes; dropped words are gone, swapped ones are all still there."""
    text = " ".join(words)

    def heard(how: str, rate: float) -> str:
        return garble(text, how, rate, Random(seed), WORDS)  # noqa: S311 - no secrets

    assert all(heard(how, 0.0) == text for how in ("misheard", "dropped", "swapped"))
    assert heard("dropped", 1.0) == ""
    assert sorted(heard("swapped", 0.5).split()) == sorted(words)
