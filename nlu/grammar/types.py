"""Types of meanings, and the check of a term against the type its category demands.

There are three basic types: `e`, things and their names; `t`, acts and states of affairs; `d`,
degrees of confidence. All others are functions, written `e -> t`. A constant may have several types
(`implies` joins two names or two clauses); its arguments determine which one applies.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from .terms import BoundVariable, Constant, Lambda, Term, show, spine


@dataclass(frozen=True, slots=True)
class BasicType:
    """A type that is not a function: `e`, `t` or `d`."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class FunctionType:
    """The type of functions from `source` to `target`."""

    source: Type
    target: Type

    def __str__(self) -> str:
        source = f"({self.source})" if isinstance(self.source, FunctionType) else str(self.source)
        return f"{source} -> {self.target}"


Type: TypeAlias = BasicType | FunctionType
Signature: TypeAlias = Mapping[str, Sequence[Type]]


class TypeMismatchError(TypeError):
    """A term does not have the type that is expected of it; the message is one clause."""


def check_type(
    term: Term, expected: Type, signature: Signature, context: tuple[Type, ...] = ()
) -> None:
    """Check that a term has a type; `context` has those of its free variables, innermost first.

    It raises `TypeMismatchError`, also for a constant that the signature does not know.
    """
    if isinstance(term, Lambda):
        if not isinstance(expected, FunctionType):
            raise TypeMismatchError(f"expected {expected}, found the function {show(term)}")
        check_type(term.body, expected.target, signature, (expected.source, *context))
        return
    head, arguments = spine(term)
    failures: list[TypeMismatchError] = []
    for candidate in _types_of(head, signature, context):
        found = candidate
        try:
            for argument in arguments:
                if not isinstance(found, FunctionType):
                    raise TypeMismatchError(
                        f"{_shown(head)} takes fewer arguments than it is given"
                    )
                check_type(argument, found.source, signature, context)
                found = found.target
        except TypeMismatchError as error:
            failures.append(error)
            continue
        if found == expected:
            return
        problem = f"expected {expected}, but {_shown(head)} gives {found}"
        failures.append(TypeMismatchError(problem))
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
