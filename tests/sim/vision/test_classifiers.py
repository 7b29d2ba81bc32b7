"""The classifier gives probabilities, novel inputs are told, and both are read from arrays."""

import numpy as np
import pytest

from hilt.sim.vision.learned_detector import Classifier, NoveltyDetector, read_arrays


def network(scale: float, temperature: float = 1.0) -> Classifier:
    """Two inputs, one hidden unit each, whose signs are the logits of two classes."""
    plain = np.zeros(2), np.ones(2)
    return Classifier(*plain, np.eye(2), np.zeros(2), scale * np.eye(2), np.zeros(2), temperature)


def test_class_of_the_larger_input_is_more_probable():
    """Probabilities add up to 1, and the temperature takes them towards each other."""
    inputs = np.array([[2.0, -1.0]])

    sure, unsure = (network(3.0, t).probabilities(inputs)[0] for t in (1.0, 5.0))

    assert sure.sum() == pytest.approx(1.0)
    assert sure[0] > unsure[0] > 0.5


def test_probabilities_of_large_scores_are_finite():
    """Scores of any size become probabilities."""
    assert network(1e4).probabilities(np.array([[1.0, -1.0], [1.0, 1.0]])) == pytest.approx(
        np.array([[1.0, 0.0], [0.5, 0.5]])
    )


def test_distant_inputs_are_clipped():
    """No input counts for more than six deviations."""
    assert network(1.0).standardised(np.array([[100.0, -3.0]])).tolist() == [[6.0, -3.0]]


def test_distant_inputs_are_novel():
    """An input near an example of its class keeps its confidence; others hardly any."""
    examples = np.array([[0.0, 0.0], [9.0, 0.0]])
    detector = NoveltyDetector(np.ones(2), examples, np.array([0.0, 1.0]), np.ones(2))

    assert detector.confidence(np.array([0.5, 0.5]), 0) == 1.0
    assert detector.confidence(np.array([9.0, 0.0]), 0) < 0.1
    assert detector.confidence(np.array([9.0, 0.0]), 1) == 1.0


def test_classifier_is_read_from_arrays():
    """The names of its arrays begin with a prefix."""
    made = network(2.0, 1.5)
    arrays = {f"x_{name}": np.asarray(value, np.float32) for name, value in vars(made).items()}

    again = read_arrays(Classifier, arrays, "x")

    inputs = np.array([[0.3, -0.2]])
    assert again.probabilities(inputs) == pytest.approx(made.probabilities(inputs))
