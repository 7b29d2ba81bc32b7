# SPDX-License-Identifier: Apache-2.0
"""Predicate forms: meanings without variables of their own, as the paper writes them.

`implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high)` is one. In the pattern of a
pragmatic rule a name of one capital letter stands for any form. Paper, section 3.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from ..grammar.terms import Apply, Constant, Neutral, Term, Value, spine


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
        """Whether it stands for any form in a pattern."""
        return len(self.name) == 1 and self.name.isupper() and not self.arguments

    def mapped(self, change: Callable[[Form], Form | None]) -> Form:
        """This form with parts replaced; `change` gives None for what stays as it is."""
        changed = change(self)
        if changed is not None:
            return changed
        if not self.arguments:
            return self
        return Form(self.name, tuple(argument.mapped(change) for argument in self.arguments))


def form_of(value: Value) -> Form:
    """The form of a value without free variables, which must not be a function."""
    if not isinstance(value, Neutral) or not isinstance(value.head, str):
        raise ValueError("A function is no predicate form.")
    return Form(value.head, tuple(form_of(argument) for argument in value.arguments))


def form_of_term(term: Term) -> Form:
    """The form that a term without functions writes down."""
    head, arguments = spine(term)
    if not isinstance(head, Constant):
        raise ValueError("A function is no predicate form.")
    return Form(head.name, tuple(form_of_term(argument) for argument in arguments))


def term_of(form: Form) -> Term:
    """The term that writes a form down."""
    term: Term = Constant(form.name)
    for argument in form.arguments:
        term = Apply(term, term_of(argument))
    return term


def match(
    pattern: Form, form: Form, found: Mapping[str, Form] | None = None
) -> dict[str, Form] | None:
    """What the variables of a pattern stand for, None where it does not fit.

    Args:
        pattern: with variables; the same variable always stands for the same form.
        form: without.
        found: what is known of the variables already.
    """
    result = dict(found or {})
    if pattern.is_variable:
        return result if result.setdefault(pattern.name, form) == form else None
    if pattern.name != form.name or len(pattern.arguments) != len(form.arguments):
        return None
    for below, argument in zip(pattern.arguments, form.arguments, strict=True):
        step = match(below, argument, result)
        if step is None:
            return None
        result = step
    return result


def fill(pattern: Form, found: Mapping[str, Form]) -> Form:
    """The pattern with its variables replaced by what they stand for."""
    return pattern.mapped(lambda part: found.get(part.name) if part.is_variable else None)
