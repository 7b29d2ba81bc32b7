"""The registry of experiments."""

import pytest

from hilt.agent.evaluation.experiment import EXPERIMENTS, make_experiment


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_every_registered_experiment_can_be_made(name: str):
    """Its module exists, and it has the name it is registered under."""
    assert make_experiment(name, {"seed": 3}).name == name
