# SPDX-License-Identifier: Apache-2.0
"""Whether something looks like anything that was learned."""

import numpy as np
import pytest

from hilt.sim.vision.familiarity import LOOSEST, Familiarity

RNG = np.random.default_rng(7)
CENTRES = np.array([[0.0, 0, 0, 0], [9.0, 0, 0, 0], [0.0, 9, 0, 0]])


def drawn(count: int) -> tuple[np.ndarray, np.ndarray]:
    """So many inputs round the centre of each of three classes."""
    classes = np.repeat(np.arange(3), count)
    return CENTRES[classes] + RNG.normal(0, 0.2, (len(classes), 4)), classes


@pytest.fixture(scope="module")
def usual() -> Familiarity:
    """What was learned of three classes, of which the last was held back with one odd example."""
    inputs, classes = drawn(60)
    held, held_classes = drawn(20)
    held[-1] = (50, 50, 50, 50)
    return Familiarity.learned(inputs, classes, held, held_classes, count=30)


def test_what_is_like_the_examples_is_familiar(usual: Familiarity):
    """Almost all that comes from a class is."""
    inputs, classes = drawn(200)

    assert (usual.of(inputs, classes) == 1.0).mean() > 0.95


def test_one_odd_example_does_not_open_a_class(usual: Familiarity):
    """The limit of a class is not much wider than those of the others."""
    strange = np.full((1, 4), 4.5)

    assert usual.limit.max() <= LOOSEST * np.median(usual.limit) + 1e-9
    assert usual.of(strange, np.array([2])) < 0.05


def test_class_that_was_not_held_back_gets_the_limit_of_the_others():
    """There is always a limit, and it is not 0."""
    inputs, classes = drawn(60)
    held = classes < 2

    usual = Familiarity.learned(inputs, classes, inputs[held], classes[held], count=60)

    assert np.isfinite(usual.limit).all()
    assert (usual.limit > 0).all()
