"""Lambda terms: what a word contributes to the meaning of a sentence.

Bound variables are de Bruijn indices (0 is the innermost binder), so terms that differ only in
the names of their variables are equal, and no substitution can capture. A term is brought to its
beta-normal form by evaluation: `evaluate` turns it into a Python value in which functions are
functions, and `quote` reads the normal form back (Berger and Schwichtenberg 1991). Terms are
checked against their category before they are used (`typecheck`), so evaluation ends.

    >>> f, x = BoundVariable(1), BoundVariable(0)
    >>> twice = Lambda(Lambda(Application(f, Application(f, x))))
    >>> str(quote(evaluate(Application(Application(twice, Constant("f")), Constant("a")))))
    'f(f(a))'
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import chain, count
from typing import TypeAlias, cast

VARIABLE_NAMES = "xyzuvwpqrs"


class _Shown:
    __slots__ = ()

    def __str__(self) -> str:
        return show(cast("Term", self))


@dataclass(frozen=True, slots=True)
class BoundVariable(_Shown):
    """A variable, as the number of binders between it and its own."""

    index: int


@dataclass(frozen=True, slots=True)
class Constant(_Shown):
    """A name that no function binds: `knife`, `implies`, `self`."""

    name: str


@dataclass(frozen=True, slots=True)
class Lambda(_Shown):
    """A function; `hint` is only the name its variable is shown with."""

    body: "Term"
    hint: str = field(default="x", compare=False)


@dataclass(frozen=True, slots=True)
class Application(_Shown):
    """A function applied to one argument."""

    function: "Term"
    argument: "Term"


Leaf: TypeAlias = BoundVariable | Constant
Term: TypeAlias = Leaf | Lambda | Application


@dataclass(frozen=True, slots=True)
class NeutralTerm:
    """A value that cannot be evaluated further: a constant or free variable, with arguments."""

    head: str | int
    """The name of the constant, or the depth of the binder of the free variable."""
    arguments: "tuple[Value, ...]" = ()

    def __call__(self, argument: "Value") -> "Value":
        """This value with one more argument."""
        return NeutralTerm(self.head, (*self.arguments, argument))


Value: TypeAlias = "NeutralTerm | Callable[[Value], Value]"
Environment: TypeAlias = "tuple[Value, ...]"


def evaluate(term: Term, environment: Environment = ()) -> Value:
    """The value of a term; `environment[i]` is the value of the bound variable i."""
    if isinstance(term, Application):
        return evaluate(term.function, environment)(evaluate(term.argument, environment))
    if isinstance(term, BoundVariable):
        return environment[term.index]
    if isinstance(term, Constant):
        return NeutralTerm(term.name)
    return partial(_applied, term.body, environment)  # can be pickled, as a closure cannot


def _applied(body: Term, environment: Environment, argument: Value) -> Value:
    return evaluate(body, (argument, *environment))


def quote(value: Value, depth: int = 0) -> Term:
    """The term in beta-normal form that has this value, under `depth` binders."""
    if not isinstance(value, NeutralTerm):
        hint = VARIABLE_NAMES[depth % len(VARIABLE_NAMES)]
        return Lambda(quote(value(NeutralTerm(depth)), depth + 1), hint)
    head = value.head
    term: Term = Constant(head) if isinstance(head, str) else BoundVariable(depth - head - 1)
    for argument in value.arguments:
        term = Application(term, quote(argument, depth))
    return term


def compose(outer: Value, inner: Value) -> Value:
    """The function that applies `inner`, then `outer`."""
    return lambda argument: outer(inner(argument))


def replace_constants(term: Term, names: Mapping[str, str]) -> Term:
    """The term with constants renamed, as the templates of verbs and nouns need it."""

    def renamed(leaf: Leaf, _: int) -> Term:
        return Constant(names.get(leaf.name, leaf.name)) if isinstance(leaf, Constant) else leaf

    return _mapped(term, renamed, 0)


def bind(term: Term, name: str) -> Lambda:
    """The function that results when a constant of a closed term becomes its variable."""

    def bound(leaf: Leaf, depth: int) -> Term:
        if isinstance(leaf, Constant):
            return BoundVariable(depth) if leaf.name == name else leaf
        # A variable from outside is now one binder further away.
        return BoundVariable(leaf.index + 1) if leaf.index >= depth else leaf

    return Lambda(_mapped(term, bound, 0), name)


def _mapped(term: Term, change: Callable[[Leaf, int], Term], depth: int) -> Term:
    if isinstance(term, Application):
        function, argument = (_mapped(x, change, depth) for x in (term.function, term.argument))
        return Application(function, argument)
    if isinstance(term, Lambda):
        return Lambda(_mapped(term.body, change, depth + 1), term.hint)
    return change(term, depth)


def spine(term: Term) -> tuple[Term, tuple[Term, ...]]:
    """The head of nested applications, and the arguments in order."""
    arguments: list[Term] = []
    while isinstance(term, Application):
        arguments.append(term.argument)
        term = term.function
    return term, tuple(reversed(arguments))


def show(term: Term, names: tuple[str, ...] = ()) -> str:
    """The term as text, `λx.f(x)`, with the names of its free variables, innermost first."""
    match term:
        case BoundVariable(index):
            return names[index] if index < len(names) else f"#{index}"
        case Constant(name):
            return name
        case Lambda(body, hint):
            candidates = chain([hint], (f"{hint}{number}" for number in count(2)))
            name = next(each for each in candidates if each not in names)
            return f"λ{name}.{show(body, (name, *names))}"
        case Application():
            head, arguments = spine(term)
            shown = show(head, names)
            listed = ",".join(show(argument, names) for argument in arguments)
            return f"({shown})({listed})" if isinstance(head, Lambda) else f"{shown}({listed})"
