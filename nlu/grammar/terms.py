# SPDX-License-Identifier: Apache-2.0
"""Lambda terms: what a word contributes to the meaning of a sentence.

Bound variables are de Bruijn indices (0 is the innermost binder), so terms that differ only in
the names of their variables are equal, and no substitution can capture. A term is brought to its
beta-normal form by evaluation: `evaluate` turns it into a Python value in which functions are
functions, and `quote` reads the normal form back (Berger and Schwichtenberg 1991). Terms are
checked against their category before they are used (`typecheck`), so evaluation ends.

    >>> twice = Lambda(Lambda(Apply(Bound(1), Apply(Bound(1), Bound(0)))))
    >>> str(normal_form(Apply(Apply(twice, Constant("f")), Constant("a"))))
    'f(f(a))'
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import chain, count
from typing import TypeAlias

VARIABLE_NAMES = "xyzuvwpqrs"


@dataclass(frozen=True, slots=True)
class Bound:
    """A variable, as the number of binders between it and its own."""

    index: int

    def __str__(self) -> str:
        return show(self)


@dataclass(frozen=True, slots=True)
class Constant:
    """A name that no function binds: `knife`, `implies`, `self`."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class Lambda:
    """A function; `hint` is only the name its variable is shown with."""

    body: Term
    hint: str = field(default="x", compare=False)

    def __str__(self) -> str:
        return show(self)


@dataclass(frozen=True, slots=True)
class Apply:
    """A function applied to one argument."""

    function: Term
    argument: Term

    def __str__(self) -> str:
        return show(self)


Term: TypeAlias = Bound | Constant | Lambda | Apply


@dataclass(frozen=True, slots=True)
class Neutral:
    """A value that cannot be evaluated further: a constant or free variable, with arguments."""

    head: str | int
    """The name of the constant, or the depth of the binder of the free variable."""
    arguments: tuple[Value, ...] = ()

    def __call__(self, argument: Value) -> Value:
        """This value with one more argument."""
        return Neutral(self.head, (*self.arguments, argument))


Value: TypeAlias = "Neutral | Callable[[Value], Value]"
Environment: TypeAlias = "tuple[Value, ...]"


def evaluate(term: Term, environment: Environment = ()) -> Value:
    """The value of a term; `environment[i]` is the value of the bound variable i."""
    if isinstance(term, Apply):
        return evaluate(term.function, environment)(evaluate(term.argument, environment))
    if isinstance(term, Bound):
        return environment[term.index]
    if isinstance(term, Constant):
        return Neutral(term.name)
    body = term.body
    return lambda argument: evaluate(body, (argument, *environment))


def quote(value: Value, depth: int = 0) -> Term:
    """The term in beta-normal form that has this value, under `depth` binders."""
    if not isinstance(value, Neutral):
        hint = VARIABLE_NAMES[depth % len(VARIABLE_NAMES)]
        return Lambda(quote(value(Neutral(depth)), depth + 1), hint)
    head = value.head
    term: Term = Constant(head) if isinstance(head, str) else Bound(depth - head - 1)
    for argument in value.arguments:
        term = Apply(term, quote(argument, depth))
    return term


def normal_form(term: Term) -> Term:
    """The beta-normal form of a closed, well-typed term."""
    return quote(evaluate(term))


def compose(outer: Value, inner: Value) -> Value:
    """The function that applies `inner`, then `outer`."""
    return lambda argument: outer(inner(argument))


def replace_constants(term: Term, names: Mapping[str, str]) -> Term:
    """The term with constants renamed, as the templates of verbs and nouns need it."""
    match term:
        case Constant(name):
            return Constant(names.get(name, name))
        case Apply(function, argument):
            return Apply(replace_constants(function, names), replace_constants(argument, names))
        case Lambda(body, hint):
            return Lambda(replace_constants(body, names), hint)
        case Bound():
            return term


def bind(term: Term, name: str) -> Lambda:
    """The function that results when a constant of a closed term becomes its variable."""
    return Lambda(_bound(term, name, 0), name)


def _bound(term: Term, name: str, depth: int) -> Term:
    match term:
        case Constant(found):
            return Bound(depth) if found == name else term
        case Apply(function, argument):
            return Apply(_bound(function, name, depth), _bound(argument, name, depth))
        case Lambda(body, hint):
            return Lambda(_bound(body, name, depth + 1), hint)
        case Bound(index):
            # A variable from outside is now one binder further away.
            return Bound(index + 1) if index >= depth else term


def spine(term: Term) -> tuple[Term, tuple[Term, ...]]:
    """The head of nested applications, and the arguments in order."""
    arguments: list[Term] = []
    while isinstance(term, Apply):
        arguments.append(term.argument)
        term = term.function
    return term, tuple(reversed(arguments))


def show(term: Term, names: tuple[str, ...] = ()) -> str:
    """The term as text, `λx.f(x)`, with the names of its free variables, innermost first."""
    match term:
        case Bound(index):
            return names[index] if index < len(names) else f"#{index}"
        case Constant(name):
            return name
        case Lambda(body, hint):
            name = _fresh(hint, names)
            return f"λ{name}.{show(body, (name, *names))}"
        case Apply():
            head, arguments = spine(term)
            shown = show(head, names)
            listed = ",".join(show(argument, names) for argument in arguments)
            return f"({shown})({listed})" if isinstance(head, Lambda) else f"{shown}({listed})"


def _fresh(hint: str, names: tuple[str, ...]) -> str:
    candidates = chain([hint], (f"{hint}{number}" for number in count(2)))
    return next(name for name in candidates if name not in names)
