"""The experiment on experience: less regret with it, and questions where the interval says."""

from __future__ import annotations

import pytest
from experience import ExperienceExperiment, is_contradicted

from hilt.agent.evaluation.reports.report import EvaluationReport, render_page
from hilt.agent.evaluation.runners.runner import run_serially
from hilt.inference.experience import contradiction, credible_interval
from hilt.kb.interval import Interval


@pytest.mark.parametrize("trials", [*range(12), 40])
def test_binomial_and_beta_say_the_same(trials: int):
    """The check of the experiment agrees with the interval, and is worked out without it."""
    for held in range(trials + 1):
        mass = contradiction(Interval(0.95, 1), credible_interval(held, trials))
        assert is_contradicted(held, trials) == (mass > 0.25)


def test_experience_lessens_regret_and_is_reported():
    """A short run is right, and its report has both lines of the curve."""
    experiment = ExperienceExperiment(trials=1, episodes=60)
    cases = experiment.cases()

    report = EvaluationReport.from_runs(experiment, list(run_serially(experiment, cases)))
    page = render_page(experiment, cases, report)

    (curve,) = report.as_json()["curves"]
    learned, other = (curve["lines"][name][-1]["regret"] for name in ("with experience", "without"))
    assert report.is_right
    assert 0 < learned < other
    assert report.summary["questions_a_trial"] > 0
    assert 'aria-label="regret against episodes"' in page


def test_run_is_repeated_exactly():
    """The result depends on the seed only."""
    experiment = ExperienceExperiment(seed=3, trials=1, episodes=20)
    (case,) = experiment.cases()

    assert experiment.run(case) == experiment.run(case)


@pytest.mark.sim
def test_simulated_robot_asks_after_it_failed():
    """The mug without friction slips, Hilt asks, and the handle holds."""
    experiment = ExperienceExperiment(sim=True)
    (case,) = experiment.cases()

    result = experiment.run(case)

    assert result.right
    assert result.facts["questions"] > 0
    assert "handle held" in result.facts["trials"]
