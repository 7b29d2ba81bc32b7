# SPDX-License-Identifier: Apache-2.0
"""The classifier: it learns, is calibrated, and tells novel inputs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.sim.vision.neural_classifier import (
    MAX_LIMIT_RATIO,
    Classifier,
    NoveltyDetector,
    softmax,
    train_classifier,
)

RNG = np.random.default_rng(7)
CENTRES = np.array([[0.0, 0, 0, 0], [9.0, 0, 0, 0], [0.0, 9, 0, 0]])


def rings(
    count: int, rng: np.random.Generator, noise: float = 0.2
) -> tuple[np.ndarray, np.ndarray]:
    """Points on three rings round each other, which no straight line separates."""
    classes = rng.integers(0, 3, count)
    angle = rng.uniform(0, 2 * np.pi, count)
    radius = 1.0 + classes + rng.normal(0, noise, count)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), classes


@pytest.fixture(scope="module")
def network() -> Classifier:
    """Trained on three noisy rings."""
    inputs, classes = rings(3000, np.random.default_rng(0), noise=0.4)
    return train_classifier(
        inputs, classes, count=3, units=24, epochs=60, rng=np.random.default_rng(1)
    )


def test_classifier_learns_classes_that_no_line_separates(network: Classifier):
    """Rings without noise are classified correctly."""
    inputs, classes = rings(500, np.random.default_rng(2), noise=0.05)

    assert (network.probabilities(inputs).argmax(axis=1) == classes).mean() > 0.97


def test_same_seed_trains_the_same_classifier():
    """Training depends on its data and its seed only."""
    inputs, classes = rings(200, np.random.default_rng(0))

    first, second = (
        train_classifier(inputs, classes, count=3, units=5, epochs=2, rng=np.random.default_rng(7))
        for _ in range(2)
    )

    assert (first.hidden == second.hidden).all()


def test_calibrated_probabilities_are_frequencies(network: Classifier):
    """The expected calibration error is below five in a hundred."""
    held, held_classes = rings(2000, np.random.default_rng(3), noise=0.4)
    inputs, classes = rings(4000, np.random.default_rng(4), noise=0.4)

    probabilities = network.calibrated(held, held_classes).probabilities(inputs)

    sure, right = probabilities.max(axis=1), probabilities.argmax(axis=1) == classes
    bins = np.minimum((sure * 10).astype(int), 9)
    errors = [abs(sure[bins == b].mean() - right[bins == b].mean()) for b in np.unique(bins)]
    assert np.average(errors, weights=np.bincount(bins)[np.unique(bins)]) < 0.05


@settings(max_examples=15, deadline=None)
@given(st.floats(0.3, 8))
def test_calibration_undoes_a_wrong_temperature(network: Classifier, factor: float):
    """An overconfident or underconfident network gets the same calibrated probabilities."""
    inputs, classes = rings(400, np.random.default_rng(3), noise=0.4)
    spoilt = Classifier(
        network.mean,
        network.deviation,
        network.hidden,
        network.hidden_bias,
        network.output * factor,
        network.output_bias * factor,
    )

    wanted = network.calibrated(inputs, classes).temperature * factor

    assert spoilt.calibrated(inputs, classes).temperature == pytest.approx(
        np.clip(wanted, 0.25, 10), rel=0.05
    )


def test_classifier_is_restored_from_arrays(network: Classifier):
    """Its probabilities are the same to single precision."""
    inputs, _ = rings(20, np.random.default_rng(5))

    again = Classifier.from_arrays(network.as_arrays("objects"), "objects")

    assert again.probabilities(inputs) == pytest.approx(network.probabilities(inputs), abs=1e-4)


def test_softmax_of_large_scores_is_finite():
    """Scores of any size become probabilities that add up to 1."""
    probabilities = softmax(np.array([[1000.0, 0.0], [-1000.0, -1000.0]]))

    assert probabilities == pytest.approx(np.array([[1.0, 0.0], [0.5, 0.5]]))


def test_distant_inputs_are_novel():
    """Nearly all inputs like the data keep their confidence; distant ones hardly any."""
    rng = np.random.default_rng(0)
    classes = rng.integers(0, 2, 2000)
    inputs = rng.normal(0, 1, (2000, 30)) + 5 * classes[:, None]

    novelty = NoveltyDetector.fit(
        inputs[:1000], classes[:1000], inputs[1000:], classes[1000:], count=60
    )

    assert (novelty.confidence(inputs, classes) == 1.0).mean() > 0.98
    assert novelty.confidence(inputs + 4.0, classes).max() < 0.1
    assert novelty.confidence(inputs, 1 - classes).max() < 0.1


def drawn(count: int) -> tuple[np.ndarray, np.ndarray]:
    """`count` inputs round the centre of each of three classes."""
    classes = np.repeat(np.arange(3), count)
    return CENTRES[classes] + RNG.normal(0, 0.2, (len(classes), 4)), classes


@pytest.fixture(scope="module")
def novelty() -> NoveltyDetector:
    """Fitted to three classes, of which the last has an outlier among the held-out inputs."""
    inputs, classes = drawn(60)
    held, held_classes = drawn(20)
    held[-1] = (50, 50, 50, 50)
    return NoveltyDetector.fit(inputs, classes, held, held_classes, count=30)


def test_inputs_like_the_examples_keep_their_confidence(novelty: NoveltyDetector):
    """Almost all inputs drawn from a class do."""
    inputs, classes = drawn(200)

    assert (novelty.confidence(inputs, classes) == 1.0).mean() > 0.95


def test_one_outlier_does_not_widen_a_class(novelty: NoveltyDetector):
    """The limit of a class is not much wider than those of the others."""
    strange = np.full((1, 4), 4.5)

    assert novelty.limit.max() <= MAX_LIMIT_RATIO * np.median(novelty.limit) + 1e-9
    assert novelty.confidence(strange, np.array([2])) < 0.05


def test_class_without_held_out_inputs_gets_the_limit_of_the_others():
    """There is always a limit, and it is not 0."""
    inputs, classes = drawn(60)
    held = classes < 2

    novelty = NoveltyDetector.fit(inputs, classes, inputs[held], classes[held], count=60)

    assert np.isfinite(novelty.limit).all()
    assert (novelty.limit > 0).all()
