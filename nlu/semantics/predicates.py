"""Predicate forms, the closed terms in which the paper writes meanings, and pragmatic rules.

An example is `implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high)`. The pragmatic
rules go from a speech act to the speaker's intention. `STATEMENT(A,B,X) => wantBelieve(A,B,X)`: a
person who states something to an agent wants the agent to believe it; a name of one capital letter
is a variable. The rules are data (`pragmatics.yaml`), each with an interval of confidence, as in
Scheutz et al. (2013) and Williams et al. (2015). Paper, section 3.2.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ...ontology.confidence import read_interval
from ...ontology.evidence_operators import (
    certainty,
    fuse_yager,
    modus_ponens,
    relative_plausibility,
)
from ...ontology.yaml_reader import YamlNode, read_yaml
from ..grammar.grammar import PREDICATES_FILE
from ..grammar.notation import read_rule
from ..grammar.terms import NeutralTerm, Value, evaluate
from .meaning import Confidence

CERTAIN: Confidence = (1.0, 1.0)

PRAGMATICS_FILE = Path(__file__).parents[2] / "ontology" / "pragmatics.yaml"


@dataclass(frozen=True, slots=True)
class PredicateForm:
    """A name and its arguments, which are forms.

    >>> str(PredicateForm("partOf", (PredicateForm("blade"), PredicateForm("knife"))))
    'partOf(blade,knife)'
    """

    name: str
    arguments: "tuple[PredicateForm, ...]" = ()

    @classmethod
    def named(cls, name: str) -> "PredicateForm":
        """Return the form of a name as people spell it: `wine_glass` for "wine glass"."""
        return cls(name.replace(" ", "_"))

    @property
    def said(self) -> str:
        """The name as people spell it."""
        return self.name.replace("_", " ").rstrip()

    @property
    def innermost(self) -> "PredicateForm":
        """The thing that a form describes: the mug of "the red mug for tea"."""
        return self.arguments[0].innermost if self.arguments else self

    def __str__(self) -> str:
        if not self.arguments:
            return self.name
        return f"{self.name}({','.join(map(str, self.arguments))})"

    def __iter__(self) -> "Iterator[PredicateForm]":
        """This form and all forms within it, from the outside in, left to right."""
        yield self
        for argument in self.arguments:
            yield from argument

    @property
    def is_variable(self) -> bool:
        """Whether this is a variable of a pattern."""
        return len(self.name) == 1 and self.name.isupper() and not self.arguments

    def mapped(self, change: "Callable[[PredicateForm], PredicateForm | None]") -> "PredicateForm":
        """Return the form with parts replaced; `change` returns None for a part to keep."""
        changed = change(self)
        if changed is not None:
            return changed
        if not self.arguments:
            return self
        return PredicateForm(self.name, tuple(each.mapped(change) for each in self.arguments))

    def replacing(self, old: "PredicateForm", new: "PredicateForm") -> "PredicateForm":
        """Return the form with every part that is `old` replaced."""
        return self.mapped(lambda part: new if part == old else None)


def form_of(value: Value) -> PredicateForm:
    """Return the form of a value without free variables; `ValueError` for a function."""
    if not isinstance(value, NeutralTerm) or not isinstance(value.head, str):
        raise ValueError("A function is not a predicate form.")
    return PredicateForm(value.head, tuple(form_of(argument) for argument in value.arguments))


def match(
    pattern: PredicateForm, form: PredicateForm, found: Mapping[str, PredicateForm] | None = None
) -> dict[str, PredicateForm] | None:
    """Return the bindings of the variables of a pattern, None when it does not match.

    A variable that occurs twice, or that is bound in `found`, must match the same form.
    """
    result: dict[str, PredicateForm] | None = dict(found or {})
    if pattern.is_variable:
        return result if result.setdefault(pattern.name, form) == form else None
    if pattern.name != form.name or len(pattern.arguments) != len(form.arguments):
        return None
    for below, argument in zip(pattern.arguments, form.arguments, strict=True):
        if result is not None:
            result = match(below, argument, result)
    return result


def fill(pattern: PredicateForm, found: Mapping[str, PredicateForm]) -> PredicateForm:
    """Return the pattern with its variables replaced by their bindings."""
    return pattern.mapped(lambda part: found.get(part.name) if part.is_variable else None)


@dataclass(frozen=True)
class PredicateTable:
    """What `predicates.yaml` says of the forms of questions and fragments, by their predicates."""

    asks: Mapping[str, str]  # how questions are called that are not called like their forms
    bare: frozenset[str]  # the questions that may name nothing
    named: Mapping[str, str]  # what a question names that has one argument
    fragments: Mapping[str, tuple[str, str]]  # the slot that each fragment fills, and its mode


@cache
def load_predicates() -> PredicateTable:
    """Return the table of all languages; `DataError` says where it is not as expected."""
    keys = ("types", "asks", "bare", "named", "fragments")
    parts = read_yaml(PREDICATES_FILE).entries(required=keys, optional=())
    kinds, modes = (parts[key].entries() for key in ("named", "fragments"))
    return PredicateTable(
        {name: ask.text() for name, ask in parts["asks"].entries().items()},
        frozenset(parts["bare"].texts()),
        {name: kind for kind, names in kinds.items() for name in names.texts()},
        {
            name.text(): (slot, mode)
            for mode, slots in modes.items()
            for slot, name in slots.entries().items()
        },
    )


@dataclass(frozen=True)
class PragmaticRule:
    """A rule from the pattern of a speech act to an intention, and its (lower, upper) in [0, 1]."""

    act: PredicateForm
    intention: PredicateForm
    interval: Confidence


@dataclass(frozen=True)
class Pragmatics:
    """The pragmatic rules, and the least certainty of an intention, in [0, 1]."""

    rules: tuple[PragmaticRule, ...]
    threshold: float

    def intentions(self, act: PredicateForm, heard: Confidence = CERTAIN) -> "list[Intention]":
        """Return what an act `heard` as (lower, upper) in [0, 1] may intend, the surest first."""
        found: dict[PredicateForm, list[Confidence]] = {}
        for rule in self.rules:
            variables = match(rule.act, act) if rule.act.name == act.name else None
            if variables is not None:
                concluded = modus_ponens(heard, rule.interval)
                found.setdefault(fill(rule.intention, variables), []).append(concluded)
        fused = {form: fuse_yager(intervals) for form, intervals in found.items()}
        intentions = [Intention(form, each, _certainty(each)) for form, each in fused.items()]
        return sorted(intentions, key=lambda each: -each.certainty)

    def meant(self, act: PredicateForm, heard: Confidence = CERTAIN) -> "list[Intention]":
        """Return the intentions that are sure enough; unless it is one, Hilt must ask."""
        return [each for each in self.intentions(act, heard) if self.is_enough(each.interval)]

    def is_enough(self, interval: Confidence) -> bool:
        """Whether an intention is sure enough to go by."""
        return _certainty(interval) > self.threshold


@dataclass(frozen=True)
class Intention:
    """What a speaker may want, as a form like `want(sam,pass(self,knife))`."""

    form: PredicateForm
    interval: Confidence  # how sure it is, (lower, upper) in [0, 1]
    certainty: float  # the same in one number, in [0, 1]; 0 when it rather is not meant


def load_pragmatics(path: Path = PRAGMATICS_FILE) -> Pragmatics:
    """Read the pragmatic rules; `DataError` says where the file is not as expected."""
    entries = read_yaml(path).entries(required=("rules", "threshold"), optional=())
    rules = tuple(_rule(field) for field in entries["rules"].items())
    return Pragmatics(rules, entries["threshold"].number(low=0, high=1))


def _rule(field: YamlNode) -> PragmaticRule:
    parts = field.entries(required=("rule", "interval"), optional=())
    left, right = read_rule(parts["rule"])
    try:
        act, intention = form_of(evaluate(left)), form_of(evaluate(right))
    except ValueError as error:
        raise parts["rule"].fail("expected predicate forms without functions.") from error
    unbound = {part.name for part in intention if part.is_variable}
    unbound -= {part.name for part in act if part.is_variable}
    if unbound:
        raise parts["rule"].fail(f"{', '.join(sorted(unbound))} stands only on the right.")
    return PragmaticRule(act, intention, read_interval(parts["interval"]))


def _certainty(interval: Confidence) -> float:
    return certainty(interval) if relative_plausibility(interval) > 0.5 else 0.0


class UninterpretableError(ValueError):
    """A predicate form has no meaning for Hilt.

    The reason is the answer template `key` with its slots; it may ask a clarification question.
    """

    def __init__(self, key: str, *, asks: bool = False, **slots: str) -> None:
        self.key, self.asks, self.slots = key, asks, slots
        super().__init__(key)


class UnlearnableError(UninterpretableError):
    """What was said is clear as a whole, but is nothing that Hilt learns."""
