r"""Categories of combinatory categorial grammar: what a word is, by what it combines with.

`NP` is complete. `S/NP` gives an `S` when an `NP` follows it, `S\NP` when one goes before it;
slashes group to the left. A plain slash only applies, which is the safe default: a slash with a
`^` may also compose harmonically (`X/^Y Y/^Z` gives `X/^Z`). Nothing crosses and nothing is raised
(Steedman 2000; modalities after Baldridge 2002). Every category has a simple type: e, what a name
stands for; t, what is so or is to be done; d, a degree of confidence; and functions between them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from .terms import BoundVariable, Constant, Lambda, Term, show, spine


@dataclass(frozen=True, slots=True)
class AtomicCategory:
    """A category that needs nothing to be complete."""

    name: str

    def __str__(self) -> str:
        return self.name

    @property
    def atom(self) -> "AtomicCategory":
        """The category itself."""
        return self

    @property
    def is_words(self) -> bool:
        """Whether it stands for certain words of a construction, and nothing else."""
        return self.name.startswith('"')

    @property
    def words(self) -> str:
        """The pattern of these words."""
        return self.name.strip('"')


@dataclass(frozen=True, slots=True)
class Functor:
    """A category that gives `result` once it has found `argument`."""

    result: "Category"
    argument: "Category"
    forward: bool  # whether the argument is sought to the right
    composes: bool = False  # whether the slash allows harmonic composition

    @property
    def atom(self) -> AtomicCategory:
        """The category that is left once all arguments are found."""
        return self.result.atom

    def __str__(self) -> str:
        slash = ("/" if self.forward else "\\") + ("^" if self.composes else "")
        result, argument = (
            f"({each})" if isinstance(each, Functor) else str(each)
            for each in (self.result, self.argument)
        )
        return f"{result}{slash}{argument}"


Category: TypeAlias = AtomicCategory | Functor


def type_of(category: Category, atoms: "Mapping[str, Type]") -> "Type":
    """The type of the meanings of a category; `KeyError` with the name of an unknown atom."""
    if isinstance(category, AtomicCategory):
        return atoms[category.name]
    return FunctionType(type_of(category.argument, atoms), type_of(category.result, atoms))


@dataclass(frozen=True, slots=True)
class FunctionType:
    """The type of functions from `source` to `target`."""

    source: "Type"
    target: "Type"

    def __str__(self) -> str:
        source = f"({self.source})" if isinstance(self.source, FunctionType) else str(self.source)
        return f"{source} -> {self.target}"


Type: TypeAlias = str | FunctionType  # a type that is no function is `e`, `t` or `d`
Signature: TypeAlias = Mapping[str, Sequence[Type]]


class TypeMismatchError(TypeError):
    """A term does not have the type that is expected of it; the message is one clause."""


def check_type(term: Term, wanted: Type, names: Signature, context: tuple[Type, ...] = ()) -> None:
    """Check that a term has a type; `context` has those of its free variables, innermost first.

    It raises `TypeMismatchError`, also for a constant that the signature does not know.
    """
    if isinstance(term, Lambda):
        if not isinstance(wanted, FunctionType):
            raise TypeMismatchError(f"expected {wanted}, found the function {show(term)}")
        check_type(term.body, wanted.target, names, (wanted.source, *context))
        return
    head, arguments = spine(term)
    failures: list[TypeMismatchError] = []
    for candidate in _types_of(head, names, context):
        found = candidate
        try:
            for argument in arguments:
                if not isinstance(found, FunctionType):
                    raise TypeMismatchError(f"{_shown(head)} takes fewer arguments than given")
                check_type(argument, found.source, names, context)
                found = found.target
        except TypeMismatchError as error:
            failures.append(error)
            continue
        if found == wanted:
            return
        failures.append(TypeMismatchError(f"expected {wanted}, but {_shown(head)} gives {found}"))
    raise failures[0]


def _types_of(head: Term, signature: Signature, context: tuple[Type, ...]) -> Sequence[Type]:
    match head:
        case BoundVariable(index) if index < len(context):
            return (context[index],)
        case Constant(name) if name in signature:
            return signature[name]
        case Constant(name):
            raise TypeMismatchError(f'the name "{name}" is neither bound nor declared')
        case _:
            raise TypeMismatchError(f"{show(head)} cannot stand before arguments")


def _shown(head: Term) -> str:
    return f'"{head.name}"' if isinstance(head, Constant) else "a variable"
