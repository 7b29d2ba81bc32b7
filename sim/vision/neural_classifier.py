# SPDX-License-Identifier: Apache-2.0
"""A calibrated neural classifier with one hidden layer, and detection of novel inputs.

Inputs are standardised, hidden units are tanh, outputs a softmax. Training minimises the cross
entropy with weight decay by Adam (Kingma & Ba 2015). Networks are overconfident: dividing the
logits by a temperature found on held-out data calibrates them (Guo et al. 2017).

A classifier is confident even of inputs that belong to no class. `NoveltyDetector` compares them
with stored examples of the class, and lowers the confidence beyond a distance that hardly any
known input exceeds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..poses import Array
from .point_cloud_operations import Integers, farthest_points

RATE = 0.003  # of the first steps; falls to zero in half a cosine
DECAY = 1e-4
MEAN_DECAY, SQUARE_DECAY, EPSILON = 0.9, 0.999, 1e-8  # of Adam
BATCH = 256
MIN_DEVIATION = 1e-3  # so that inputs that hardly vary in training do not dominate later
MAX_DEVIATIONS = 6.0  # standardised inputs are clipped to it, so that none decides alone
TEMPERATURES = np.geomspace(0.25, 10.0, 200)

LIMIT_QUANTILE = 0.99  # of held-out inputs that are within the limit
MIN_LIMIT = 0.1  # hardly any two inputs are nearer
MAX_LIMIT_RATIO = 1.25  # of a limit to the median of all limits
STEEPNESS = 6.0  # at 1.5 times the limit a twelfth of the confidence is left


@dataclass(frozen=True, eq=False)
class Classifier:
    """A trained network.

    Attributes:
        mean: means of the inputs (d,).
        deviation: standard deviations of the inputs (d,).
        hidden: weights of the hidden layer (d, h).
        hidden_bias: biases of the hidden layer (h,).
        output: weights of the output layer (h, c).
        output_bias: biases of the output layer (c,).
        temperature: by which the logits are divided.
    """

    mean: Array
    deviation: Array
    hidden: Array
    hidden_bias: Array
    output: Array
    output_bias: Array
    temperature: float = 1.0

    def logits(self, inputs: Array) -> Array:
        """Calibrated logits (n, c) of inputs (n, d)."""
        units = np.tanh(
            _standardised(inputs, self.mean, self.deviation) @ self.hidden + self.hidden_bias
        )
        return (units @ self.output + self.output_bias) / self.temperature

    def probabilities(self, inputs: Array) -> Array:
        """Class probabilities (n, c) of inputs (n, d)."""
        return softmax(self.logits(inputs))

    def calibrated(self, inputs: Array, classes: Integers) -> Classifier:
        """The same network at the temperature that makes these classes (n,) most probable."""
        logits = self.logits(inputs) * self.temperature
        rows = np.arange(len(classes))
        losses = [
            -np.log(softmax(logits / t)[rows, classes] + EPSILON).mean() for t in TEMPERATURES
        ]
        return replace(self, temperature=float(TEMPERATURES[int(np.argmin(losses))]))

    def as_arrays(self, prefix: str) -> dict[str, NDArray[np.float32]]:
        """Its numbers by name, for a file."""
        return {f"{prefix}_{n}": np.asarray(v, dtype=np.float32) for n, v in vars(self).items()}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[np.float32]], prefix: str) -> Classifier:
        """The classifier whose numbers `as_arrays` returned."""
        names = ("mean", "deviation", "hidden", "hidden_bias", "output", "output_bias")
        values = (np.asarray(arrays[f"{prefix}_{name}"], dtype=np.float64) for name in names)
        return cls(*values, temperature=float(arrays[f"{prefix}_temperature"]))


def _standardised(inputs: Array, mean: Array, deviation: Array) -> Array:
    return np.clip((inputs - mean) / deviation, -MAX_DEVIATIONS, MAX_DEVIATIONS)


def softmax(logits: Array) -> Array:
    """Probabilities (n, c) from logits (n, c)."""
    raised = np.exp(logits - logits.max(axis=1, keepdims=True))
    return raised / raised.sum(axis=1, keepdims=True)


def train_classifier(
    inputs: Array,
    classes: Integers,
    *,
    count: int,
    units: int,
    epochs: int,
    rng: np.random.Generator,
) -> Classifier:
    """Train a classifier with `units` in its hidden layer on inputs (n, d) of `count` classes.

    The classes (n,) are in [0, count). Each input is used `epochs` times; `rng` draws the initial
    weights and the order of the inputs.
    """
    mean, deviation = inputs.mean(axis=0), inputs.std(axis=0) + MIN_DEVIATION
    standardised = _standardised(inputs, mean, deviation)
    d = inputs.shape[1]
    hidden = rng.normal(0, 1 / np.sqrt(d), (d, units))
    output = rng.normal(0, 1 / np.sqrt(units), (units, count))
    weights = [hidden, np.zeros(units), output, np.zeros(count)]
    means, squares = ([np.zeros_like(each) for each in weights] for _ in range(2))
    steps, step = epochs * -(-len(inputs) // BATCH), 0
    for _ in range(epochs):
        order = rng.permutation(len(inputs))
        for start in range(0, len(order), BATCH):
            chosen = order[start : start + BATCH]
            step += 1
            rate = RATE * 0.5 * (1 + np.cos(np.pi * step / steps))
            gradients = _gradients(weights, standardised[chosen], classes[chosen])
            for i, gradient in enumerate(gradients):
                means[i] += (1 - MEAN_DECAY) * (gradient - means[i])
                squares[i] += (1 - SQUARE_DECAY) * (gradient**2 - squares[i])
                deviations = np.sqrt(squares[i] / (1 - SQUARE_DECAY**step))
                weights[i] -= rate * (means[i] / (1 - MEAN_DECAY**step)) / (deviations + EPSILON)
    hidden, hidden_bias, output, output_bias = weights
    return Classifier(mean, deviation, hidden, hidden_bias, output, output_bias)


def _gradients(weights: list[Array], inputs: Array, classes: Integers) -> tuple[Array, ...]:
    """The gradient of the mean loss of a batch, for each of the weights."""
    hidden, hidden_bias, output, output_bias = weights
    units = np.tanh(inputs @ hidden + hidden_bias)
    error = softmax(units @ output + output_bias)
    error[np.arange(len(classes)), classes] -= 1
    error /= len(classes)
    back = (error @ output.T) * (1 - units**2)
    return (
        inputs.T @ back + DECAY * hidden,
        back.sum(axis=0),
        units.T @ error + DECAY * output,
        error.sum(axis=0),
    )


@dataclass(frozen=True, eq=False)
class NoveltyDetector:
    """Examples of each class, to tell known inputs from novel ones.

    Attributes:
        deviation: standard deviation of each input within the classes (d,); the unit of distances.
        examples: some members of all classes (m, d).
        classes: class of each example (m,).
        limit: for each class, the distance to the nearest example up to which an input is known
            (c,).
    """

    deviation: Array
    examples: Array
    classes: Integers
    limit: Array

    @classmethod
    def fit(
        cls,
        inputs: Array,
        classes: Integers,
        held_inputs: Array,
        held_classes: Integers,
        *,
        count: int,
    ) -> NoveltyDetector:
        """Choose `count` examples of each class among inputs (n, d), and limits from held-out ones.

        The examples of a class lie far from each other (farthest point sampling).
        """
        kinds = range(int(classes.max()) + 1)
        centres = np.array([inputs[classes == kind].mean(axis=0) for kind in kinds])
        deviation = (inputs - centres[classes]).std(axis=0) + MIN_DEVIATION
        members = [np.flatnonzero(classes == kind) for kind in kinds]
        index = np.concatenate(
            [each[farthest_points(inputs[each] / deviation, count, first=0)] for each in members]
        )
        unlimited = cls(deviation, inputs[index], classes[index], np.ones(len(members)))
        novelty = unlimited.novelty(held_inputs, held_classes)
        held = [novelty[held_classes == kind] for kind in kinds]
        limits = [np.quantile(each, LIMIT_QUANTILE) if len(each) else np.nan for each in held]
        # Few inputs of some classes are held out; one outlier must not accept everything.
        limit = np.fmin(limits, MAX_LIMIT_RATIO * np.nanmedian(limits))
        return replace(unlimited, limit=np.maximum(limit, MIN_LIMIT))

    def novelty(self, inputs: Array, classes: Integers) -> Array:
        """Distances (n,) of inputs (n, d) from known members of their classes; the limit is 1."""
        pairs = zip(inputs, classes, strict=True)
        return np.array([self._distance(row, kind) / self.limit[kind] for row, kind in pairs])

    def _distance(self, row: Array, kind: int) -> float:
        """The root mean square deviation from the nearest example of a class."""
        deviations = np.abs(self.examples[self.classes == kind] - row) / self.deviation
        squares = np.minimum(deviations, MAX_DEVIATIONS) ** 2
        return float(np.sqrt(squares.mean(axis=1).min()))

    def confidence(self, inputs: Array, classes: Integers) -> Array:
        """Confidence (n,) in (0, 1] that inputs (n, d) are members of their classes at all."""
        return np.maximum(self.novelty(inputs, classes), 1.0) ** -STEEPNESS

    def as_arrays(self, prefix: str) -> dict[str, NDArray[np.float32]]:
        """Its numbers by name, for a file."""
        return {f"{prefix}_{n}": np.asarray(v, dtype=np.float32) for n, v in vars(self).items()}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[np.float32]], prefix: str) -> NoveltyDetector:
        """The detector whose numbers `as_arrays` returned."""
        names = ("deviation", "examples", "classes", "limit")
        deviation, examples, classes, limit = (
            np.asarray(arrays[f"{prefix}_{name}"], dtype=np.float64) for name in names
        )
        return cls(deviation, examples, classes.astype(np.int64), limit)
