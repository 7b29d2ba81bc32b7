# SPDX-License-Identifier: Apache-2.0
"""The small network: it learns, says how sure it is, and knows what it has not seen."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.sim.vision.classifier import Network, fit, softmax
from hilt.sim.vision.familiarity import Familiarity


def rings(
    count: int, rng: np.random.Generator, noise: float = 0.2
) -> tuple[np.ndarray, np.ndarray]:
    """Points on three rings round each other, which no straight line parts."""
    classes = rng.integers(0, 3, count)
    angle = rng.uniform(0, 2 * np.pi, count)
    radius = 1.0 + classes + rng.normal(0, noise, count)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), classes


@pytest.fixture(scope="module")
def network() -> Network:
    """Trained on three noisy rings."""
    inputs, classes = rings(3000, np.random.default_rng(0), noise=0.4)
    return fit(inputs, classes, count=3, units=24, epochs=60, rng=np.random.default_rng(1))


def test_network_learns_what_no_line_parts(network: Network):
    """Rings without noise are told apart."""
    inputs, classes = rings(500, np.random.default_rng(2), noise=0.05)

    assert (network.shares(inputs).argmax(axis=1) == classes).mean() > 0.97


def test_same_seed_trains_the_same_network():
    """Training depends on its data and its seed only."""
    inputs, classes = rings(200, np.random.default_rng(0))

    first, second = (
        fit(inputs, classes, count=3, units=5, epochs=2, rng=np.random.default_rng(7))
        for _ in range(2)
    )

    assert (first.hidden == second.hidden).all()


def test_calibrated_shares_mean_what_they_say(network: Network):
    """Of what is said with a confidence, as many are right, to five in a hundred."""
    held, held_classes = rings(2000, np.random.default_rng(3), noise=0.4)
    inputs, classes = rings(4000, np.random.default_rng(4), noise=0.4)

    shares = network.calibrated(held, held_classes).shares(inputs)

    sure, right = shares.max(axis=1), shares.argmax(axis=1) == classes
    bins = np.minimum((sure * 10).astype(int), 9)
    errors = [abs(sure[bins == b].mean() - right[bins == b].mean()) for b in np.unique(bins)]
    assert np.average(errors, weights=np.bincount(bins)[np.unique(bins)]) < 0.05


@settings(max_examples=15, deadline=None)
@given(st.floats(0.3, 8))
def test_calibration_undoes_a_wrong_temperature(network: Network, factor: float):
    """A network made too sure or too modest comes back to the same temperature."""
    inputs, classes = rings(400, np.random.default_rng(3), noise=0.4)
    spoilt = Network(
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


def test_network_is_kept_in_arrays(network: Network):
    """What is kept and read again answers alike, to single precision."""
    inputs, _ = rings(20, np.random.default_rng(5))

    again = Network.from_arrays(network.as_arrays("it"), "it")

    assert again.shares(inputs) == pytest.approx(network.shares(inputs), abs=1e-4)


def test_softmax_of_large_scores_is_finite():
    """Scores of any size become shares that add up to 1."""
    shares = softmax(np.array([[1000.0, 0.0], [-1000.0, -1000.0]]))

    assert shares == pytest.approx(np.array([[1.0, 0.0], [0.5, 0.5]]))


def test_what_was_never_seen_is_unfamiliar():
    """Nearly all that is like the data is fully familiar; what is far off hardly at all."""
    rng = np.random.default_rng(0)
    classes = rng.integers(0, 2, 2000)
    inputs = rng.normal(0, 1, (2000, 30)) + 5 * classes[:, None]

    usual = Familiarity.learned(
        inputs[:1000], classes[:1000], inputs[1000:], classes[1000:], count=60
    )

    assert (usual.of(inputs, classes) == 1.0).mean() > 0.98
    assert usual.of(inputs + 4.0, classes).max() < 0.1
    assert usual.of(inputs, 1 - classes).max() < 0.1
