"""A calibrated neural classifier with one hidden layer, and detection of novel inputs.

Both are trained by `examples/train_recognition.py`. Inputs are standardised, hidden units are tanh,
outputs a softmax. Networks are overconfident: dividing the logits by a temperature found on
held-out data calibrates them (Guo et al. 2017).

A classifier is confident even of inputs that belong to no class. `NoveltyDetector` compares them
with stored examples of the class, and lowers the confidence beyond a distance that hardly any
known input exceeds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..poses import Array

MAX_DEVIATIONS = 6.0  # standardised inputs are clipped to it, so that none decides alone
STEEPNESS = 6.0  # at 1.5 times the limit a twelfth of the confidence is left

_T = TypeVar("_T", "Classifier", "NoveltyDetector")


@dataclass(frozen=True, eq=False)
class Classifier:
    """A trained network.

    Attributes:
        mean, deviation: of the inputs (d,).
        hidden, hidden_bias: weights (d, h) and biases (h,) of the hidden layer.
        output, output_bias: weights (h, c) and biases (c,) of the output layer.
        temperature: by which the logits are divided.
    """

    mean: Array
    deviation: Array
    hidden: Array
    hidden_bias: Array
    output: Array
    output_bias: Array
    temperature: Array | float = 1.0

    def standardised(self, inputs: Array) -> Array:
        """Inputs (n, d) in standard deviations from their means, clipped."""
        return np.clip((inputs - self.mean) / self.deviation, -MAX_DEVIATIONS, MAX_DEVIATIONS)

    def logits(self, inputs: Array) -> Array:
        """Calibrated logits (n, c) of inputs (n, d)."""
        units = np.tanh(self.standardised(inputs) @ self.hidden + self.hidden_bias)
        return (units @ self.output + self.output_bias) / self.temperature

    def probabilities(self, inputs: Array) -> Array:
        """Class probabilities (n, c) of inputs (n, d)."""
        logits = self.logits(inputs)
        raised = np.exp(logits - logits.max(axis=1, keepdims=True))
        return raised / raised.sum(axis=1, keepdims=True)


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
    classes: Array
    limit: Array

    def novelty(self, row: Array, kind: int) -> float:
        """The root mean square distance of an input (d,) from a class; the limit is 1."""
        deviations = np.abs(self.examples[self.classes == kind] - row) / self.deviation
        squares = np.minimum(deviations, MAX_DEVIATIONS) ** 2
        return float(np.sqrt(squares.mean(axis=1).min()) / self.limit[kind])

    def confidence(self, row: Array, kind: int) -> float:
        """Confidence in (0, 1] that an input (d,) is a member of its class at all."""
        return max(self.novelty(row, kind), 1.0) ** -STEEPNESS


def read_arrays(kind: type[_T], arrays: Mapping[str, NDArray[np.float32]], prefix: str) -> _T:
    """Return a classifier or a detector from those arrays whose names begin with a prefix."""
    names = [each.name for each in fields(kind)]
    return kind(**{name: arrays[f"{prefix}_{name}"].astype(np.float64) for name in names})
