# SPDX-License-Identifier: Apache-2.0
"""A small neural network: one hidden layer, trained by Adam, calibrated by one temperature.

Inputs are brought to mean 0 and deviation 1, the hidden units are tanh, the outputs a softmax.
Training minimises the cross entropy with weight decay (Kingma & Ba 2015 for the steps). Networks
are too sure of themselves: dividing their outputs by a temperature found on data that they have
not seen makes their shares mean what they say (Guo et al. 2017).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..poses import Array

RATE = 0.003  # of the first steps; falls to nothing in a half cosine
DECAY = 1e-4
MEMORY, SPREAD_MEMORY, TINY = 0.9, 0.999, 1e-8  # Adam's
BATCH = 256
LEAST_DEVIATION = 1e-3  # what hardly varies in training must not shout when it does
MOST_DEVIATIONS = 6.0  # inputs farther out are cut back to it
TEMPERATURES = np.geomspace(0.25, 10.0, 200)


@dataclass(frozen=True, eq=False)
class Network:
    """A trained network.

    Attributes:
        mean, deviation: of the inputs (d,).
        hidden, hidden_bias: (d, h), (h,).
        output, output_bias: (h, c), (c,).
        temperature: by which outputs are divided.
    """

    mean: Array
    deviation: Array
    hidden: Array
    hidden_bias: Array
    output: Array
    output_bias: Array
    temperature: float = 1.0

    def scores(self, inputs: Array) -> Array:
        """Outputs before the softmax (n, c) for inputs (n, d)."""
        units = np.tanh(self._normal(inputs) @ self.hidden + self.hidden_bias)
        return (units @ self.output + self.output_bias) / self.temperature

    def shares(self, inputs: Array) -> Array:
        """How probable each class is (n, c) for inputs (n, d)."""
        return softmax(self.scores(inputs))

    def _normal(self, inputs: Array) -> Array:
        normal = (inputs - self.mean) / self.deviation
        return np.clip(normal, -MOST_DEVIATIONS, MOST_DEVIATIONS)

    def calibrated(self, inputs: Array, classes: NDArray[np.int64]) -> Network:
        """The same network at the temperature that makes these classes (n,) most probable."""
        scores = self.scores(inputs) * self.temperature
        rows = np.arange(len(classes))
        losses = [-np.log(softmax(scores / t)[rows, classes] + TINY).mean() for t in TEMPERATURES]
        return replace(self, temperature=float(TEMPERATURES[int(np.argmin(losses))]))

    def as_arrays(self, prefix: str) -> dict[str, NDArray[np.float32]]:
        """Its numbers by name, to be kept in a file."""
        return {
            f"{prefix}_{name}": np.asarray(value, dtype=np.float32)
            for name, value in vars(self).items()
        }

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[np.float32]], prefix: str) -> Network:
        """The network whose numbers `as_arrays` gave."""
        names = ("mean", "deviation", "hidden", "hidden_bias", "output", "output_bias")
        values = (np.asarray(arrays[f"{prefix}_{name}"], dtype=np.float64) for name in names)
        return cls(*values, temperature=float(arrays[f"{prefix}_temperature"]))


def softmax(scores: Array) -> Array:
    """Scores (n, c) as shares that add up to 1."""
    raised = np.exp(scores - scores.max(axis=1, keepdims=True))
    return raised / raised.sum(axis=1, keepdims=True)


def fit(
    inputs: Array,
    classes: NDArray[np.int64],
    *,
    count: int,
    units: int,
    epochs: int,
    rng: np.random.Generator,
) -> Network:
    """Train a network.

    Args:
        inputs: (n, d).
        classes: of each input (n,), in [0, count).
        count: how many classes there are.
        units: in the hidden layer.
        epochs: how often each input is used.
        rng: for the first weights and the order of the inputs.
    """
    mean, deviation = inputs.mean(axis=0), inputs.std(axis=0) + LEAST_DEVIATION
    shapes = _Shapes(inputs.shape[1], units, count)
    normal = np.clip((inputs - mean) / deviation, -MOST_DEVIATIONS, MOST_DEVIATIONS)
    adam = _Adam(shapes.first_weights(rng), steps=epochs * -(-len(inputs) // BATCH))
    for _ in range(epochs):
        order = rng.permutation(len(inputs))
        for start in range(0, len(order), BATCH):
            chosen = order[start : start + BATCH]
            adam.move(_slope(shapes.parted(adam.weights), normal[chosen], classes[chosen]))
    return Network(mean, deviation, *shapes.parted(adam.weights))


@dataclass(frozen=True)
class _Shapes:
    """How all weights lie in one row."""

    inputs: int
    units: int
    classes: int

    def parted(self, weights: Array) -> tuple[Array, Array, Array, Array]:
        """Hidden weights and biases, output weights and biases."""
        d, h, c = self.inputs, self.units, self.classes
        hidden, hidden_bias, output, output_bias = np.split(weights, np.cumsum([d * h, h, h * c]))
        return hidden.reshape(d, h), hidden_bias, output.reshape(h, c), output_bias

    def first_weights(self, rng: np.random.Generator) -> Array:
        """Random weights that keep sums of inputs at about their size; biases of 0."""
        d, h, c = self.inputs, self.units, self.classes
        hidden = rng.normal(0, 1 / np.sqrt(d), d * h)
        output = rng.normal(0, 1 / np.sqrt(h), h * c)
        return np.concatenate([hidden, np.zeros(h), output, np.zeros(c)])


class _Adam:
    """Weights, and how they have moved so far."""

    def __init__(self, weights: Array, *, steps: int) -> None:
        self.weights, self._steps, self._step = weights, steps, 0
        self._mean, self._square = np.zeros_like(weights), np.zeros_like(weights)

    def move(self, slope: Array) -> None:
        """One step against the slope of the loss."""
        self._step += 1
        self._mean += (1 - MEMORY) * (slope - self._mean)
        self._square += (1 - SPREAD_MEMORY) * (slope**2 - self._square)
        mean = self._mean / (1 - MEMORY**self._step)
        square = self._square / (1 - SPREAD_MEMORY**self._step)
        rate = RATE * 0.5 * (1 + np.cos(np.pi * self._step / self._steps))
        self.weights -= rate * mean / (np.sqrt(square) + TINY)


def _slope(
    weights: tuple[Array, Array, Array, Array], inputs: Array, classes: NDArray[np.int64]
) -> Array:
    """How the mean loss of a batch grows with each weight, in one row."""
    hidden, hidden_bias, output, output_bias = weights
    units = np.tanh(inputs @ hidden + hidden_bias)
    error = softmax(units @ output + output_bias)
    error[np.arange(len(classes)), classes] -= 1
    error /= len(classes)
    back = (error @ output.T) * (1 - units**2)
    slopes = (
        inputs.T @ back + DECAY * hidden,
        back.sum(axis=0),
        units.T @ error + DECAY * output,
        error.sum(axis=0),
    )
    return np.concatenate([slope.ravel() for slope in slopes])
