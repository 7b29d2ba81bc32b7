# SPDX-License-Identifier: Apache-2.0
"""Predicate forms, the closed terms in which the paper writes meanings, and pattern matching.

An example is `implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high)`. In the pattern
of a pragmatic rule a name of one capital letter is a variable. Paper, section 3.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from ..grammar.terms import Constant, Neutral, Term, Value, spine


@dataclass(frozen=True, slots=True)
class Form:
    """A name and its arguments, which are forms.

    >>> str(Form("partOf", (Form("blade"), Form("knife"))))
    'partOf(blade,knife)'
    """

    name: str
    arguments: tuple[Form, ...] = ()

    def __str__(self) -> str:
        if not self.arguments:
            return self.name
        return f"{self.name}({','.join(map(str, self.arguments))})"

    def __iter__(self) -> Iterator[Form]:
        """This form and all forms within it, from the outside in, left to right."""
        yield self
        for argument in self.arguments:
            yield from argument

    @property
    def is_variable(self) -> bool:
        """Whether this is a variable of a pattern."""
        return len(self.name) == 1 and self.name.isupper() and not self.arguments

    def mapped(self, change: Callable[[Form], Form | None]) -> Form:
        """Return the form with parts replaced; `change` returns None for a part to keep."""
        changed = change(self)
        if changed is not None:
            return changed
        if not self.arguments:
            return self
        return Form(self.name, tuple(argument.mapped(change) for argument in self.arguments))


def form_of(value: Value) -> Form:
    """Return the predicate form of a value without free variables.

    Raises:
        ValueError: the value is a function.
    """
    if not isinstance(value, Neutral) or not isinstance(value.head, str):
        raise ValueError("A function is not a predicate form.")
    return Form(value.head, tuple(form_of(argument) for argument in value.arguments))


def form_of_term(term: Term) -> Form:
    """Return the predicate form of a term without functions.

    Raises:
        ValueError: the term has a function.
    """
    head, arguments = spine(term)
    if not isinstance(head, Constant):
        raise ValueError("A function is not a predicate form.")
    return Form(head.name, tuple(form_of_term(argument) for argument in arguments))


def match(
    pattern: Form, form: Form, found: Mapping[str, Form] | None = None
) -> dict[str, Form] | None:
    """Return the bindings of the variables of a pattern, None when it does not match.

    A variable that occurs twice, or that is bound in `found`, must match the same form.
    """
    result: dict[str, Form] | None = dict(found or {})
    if pattern.is_variable:
        return result if result.setdefault(pattern.name, form) == form else None
    if pattern.name != form.name or len(pattern.arguments) != len(form.arguments):
        return None
    for below, argument in zip(pattern.arguments, form.arguments, strict=True):
        if result is not None:
            result = match(below, argument, result)
    return result


def fill(pattern: Form, found: Mapping[str, Form]) -> Form:
    """Return the pattern with its variables replaced by their bindings."""
    return pattern.mapped(lambda part: found.get(part.name) if part.is_variable else None)
