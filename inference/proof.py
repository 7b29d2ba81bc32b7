# SPDX-License-Identifier: Apache-2.0
"""Proofs: how an interval was worked out, step by step, so that it can be shown and checked.

A `Proof` is a tree. Its leaves are evidence: what vision reports, what holds in this situation, and
what speakers told. Its inner nodes are operators. `evaluate` works the tree out again, from the
leaves up, by the same operators: it gives the interval that stands at the root, to the last bit, or
another one when leaves are exchanged (what would change your mind?).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from ..kb.interval import VACUOUS, Interval
from ..kb.rule import Rule
from .evidence import Operators, negation

Step = Literal["seen", "given", "told", "unknown", "and", "not", "fuse", "modus ponens"]
Json = dict[str, object]

LEAVES = ("seen", "given", "told", "unknown")


@dataclass(frozen=True, slots=True)
class Proof:
    """One step of a proof, with the steps it rests on.

    Attributes:
        step: a kind of evidence, or the operator.
        interval: what it comes to.
        label: what the evidence is ("object:knife seen on knife 1", the text of a rule).
        inputs: the proofs it is worked out from; of modus ponens the antecedent, then the rule.
        rule: the rule that was told, for such evidence.
    """

    step: Step
    interval: Interval
    label: str = ""
    inputs: tuple[Proof, ...] = ()
    rule: Rule | None = None

    def __iter__(self) -> Iterator[Proof]:
        """This step and all below it, the conclusion first."""
        yield self
        for each in self.inputs:
            yield from each

    @property
    def about(self) -> str:
        """What the evidence is about; empty for an operator."""
        if self.rule is None:
            return self.label
        return f"{self.rule!r}, said {self.rule.speaker} in utterance {self.rule.utterance}"

    @property
    def leaves(self) -> tuple[Proof, ...]:
        """The evidence it rests on, each once, in the order of the proof."""
        return tuple(dict.fromkeys(each for each in self if each.step in LEAVES))

    def evaluate(
        self, operators: Operators, instead: Mapping[Proof, Interval] | None = None
    ) -> Interval:
        """Work the proof out again.

        Args:
            operators: the choices it was made with.
            instead: other intervals for some of its leaves.

        Raises:
            ConflictError: the operators are not defined for what comes together.
        """
        if self.step in LEAVES:
            return (instead or {}).get(self, self.interval)
        inputs = [each.evaluate(operators, instead) for each in self.inputs]
        return apply(self.step, inputs, operators)

    def as_json(self) -> Json:
        """This proof as nested objects."""
        found: Json = {
            "step": self.step,
            "lower": self.interval.lower,
            "upper": self.interval.upper,
        }
        if self.about:
            found["about"] = self.about
        if self.rule:
            found["rule"] = self.rule.id
        if self.inputs:
            found["inputs"] = [each.as_json() for each in self.inputs]
        return found

    def lines(self, depth: int = 0) -> Iterator[str]:
        """This proof as indented text, the conclusion first."""
        yield f"{'  ' * depth}{self.interval}  {self.step}  {self.about}".rstrip()
        for each in self.inputs:
            yield from each.lines(depth + 1)


def unknown(name: str) -> Proof:
    """The proof of what nobody told anything about."""
    return Proof("unknown", VACUOUS, f"nothing was told of {name}")


def apply(step: Step, inputs: Sequence[Interval], operators: Operators) -> Interval:
    """What an operator makes of its inputs."""
    if step == "and":
        return operators.all_of(inputs)
    if step == "not":
        return negation(inputs[0])
    if step == "fuse":
        return operators.fuse(inputs)
    return operators.conclude(inputs[0], inputs[1])


def derived(step: Step, inputs: Sequence[Proof], operators: Operators, label: str = "") -> Proof:
    """The proof that an operator makes of its inputs; of one input, AND and fusion are that."""
    if step in {"and", "fuse"} and len(inputs) == 1:
        return inputs[0]
    interval = apply(step, [each.interval for each in inputs], operators)
    return Proof(step, interval, label, tuple(inputs))


def told(rule: Rule) -> Proof:
    """A rule as evidence: as it was told, discounted by the trust in its speaker."""
    return Proof("told", rule.support, rule=rule)
