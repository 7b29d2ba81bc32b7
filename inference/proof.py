"""Proof trees: the derivation of an interval, which can be displayed and evaluated again.

The leaves of a `Proof` are evidence: observations, given contexts, taught rules and experience. Its
inner nodes are operators. `evaluate` computes the tree again from its leaves with the same
operators: it returns the interval of the root, or with leaves replaced a counterfactual one.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from ..kb.interval import Interval
from ..kb.rule import Rule
from .interval_operators import Operators

Leaf = Literal["seen", "given", "told", "unknown", "experienced"]
Step = Leaf | Literal["and", "not", "fuse", "modus ponens", "discount"]
Json = dict[str, object]

LEAVES: tuple[Leaf, ...] = get_args(Leaf)


@dataclass(frozen=True, slots=True)
class Proof:
    """A step of a proof, which is a kind of evidence or an operator, with the proofs of its inputs.

    The inputs of modus ponens are the antecedent, then the rule; those of a discount what was told,
    then the experience. `label` describes evidence ("object:knife seen on knife 1"), and `rule` is
    a taught one; `overruled` are rules that would apply, but that more specific ones override.
    """

    step: Step
    interval: Interval
    label: str = ""
    inputs: "tuple[Proof, ...]" = ()
    rule: Rule | None = None
    overruled: tuple[Rule, ...] = ()

    def __iter__(self) -> "Iterator[Proof]":
        yield self
        for each in self.inputs:
            yield from each

    @property
    def about(self) -> str:
        """A description of the evidence; empty for an operator without label."""
        return self.label if self.rule is None else _told(self.rule)

    @property
    def leaves(self) -> "tuple[Proof, ...]":
        """The evidence of the proof, each leaf once, in order."""
        return tuple(dict.fromkeys(each for each in self if each.step in LEAVES))

    def evaluate(
        self, operators: Operators, instead: "Mapping[Proof, Interval] | None" = None
    ) -> Interval:
        """Evaluate it again, `instead` with other intervals of leaves; errors as of operators."""
        if self.step in LEAVES:
            return (instead or {}).get(self, self.interval)
        inputs = [each.evaluate(operators, instead) for each in self.inputs]
        return apply_operator(self.step, inputs, operators)

    def as_json(self) -> Json:
        """Return the proof as nested JSON objects."""
        lower, upper = self.interval
        optional: Json = {
            "about": self.about,
            "rule": self.rule and self.rule.id,
            "inputs": [each.as_json() for each in self.inputs],
            "overruled": [rule.id for rule in self.overruled],
        }
        given = {key: value for key, value in optional.items() if value}
        return {"step": self.step, "lower": lower, "upper": upper, **given}

    def lines(self, depth: int = 0) -> Iterator[str]:
        """Yield the proof as lines of indented text, the conclusion first."""
        yield f"{'  ' * depth}{self.interval}  {self.step}  {self.about}".rstrip()
        for each in self.inputs:
            yield from each.lines(depth + 1)
        for rule in self.overruled:
            yield f"{'  ' * (depth + 1)}overruled by a more specific rule  {_told(rule)}"


def apply_operator(step: Step, inputs: Sequence[Interval], operators: Operators) -> Interval:
    """Return the result of an operator."""
    if step == "and":
        return operators.all_of(inputs)
    if step == "not":
        return inputs[0].negated()
    if step == "fuse":
        return operators.fuse(inputs)
    if step == "discount":
        return Interval(inputs[0].lower * inputs[1].upper, inputs[0].upper)
    return operators.conclude(inputs[0], inputs[1])


def derive(step: Step, inputs: Sequence[Proof], operators: Operators) -> Proof:
    """Return the proof that applies an operator; AND and fusion of one input are that input."""
    if step in {"and", "fuse"} and len(inputs) == 1:
        return inputs[0]
    interval = apply_operator(step, [each.interval for each in inputs], operators)
    return Proof(step, interval, inputs=tuple(inputs))


def _told(rule: Rule) -> str:
    return f"{rule!r}, said {rule.speaker} in utterance {rule.utterance}"
