r"""Categories of combinatory categorial grammar: what a word is, by what it combines with.

`NP` is complete. `S/NP` gives an `S` when an `NP` follows it, `S\NP` when one goes before it;
slashes group to the left. A plain slash only applies, which is the safe default: a slash with a
`^` may also compose harmonically (`X/^Y Y/^Z` gives `X/^Z`). Nothing crosses and nothing is raised
(Steedman 2000; modalities after Baldridge 2002).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from .types import FunctionType, Type


@dataclass(frozen=True, slots=True)
class AtomicCategory:
    """A category that needs nothing to be complete."""

    name: str

    def __str__(self) -> str:
        return self.name

    @property
    def is_words(self) -> bool:
        """Whether it stands for certain words of a construction, and nothing else."""
        return self.name.startswith('"')


@dataclass(frozen=True, slots=True)
class Functor:
    """A category that gives `result` once it has found `argument`."""

    result: Category
    argument: Category
    forward: bool  # whether the argument is sought to the right
    composes: bool = False  # whether the slash allows harmonic composition

    def __str__(self) -> str:
        slash = ("/" if self.forward else "\\") + ("^" if self.composes else "")
        return f"{_bracketed(self.result)}{slash}{_bracketed(self.argument)}"


Category: TypeAlias = AtomicCategory | Functor


def type_of(category: Category, atoms: Mapping[str, Type]) -> Type:
    """The type of the meanings of a category; `KeyError` with the name of an unknown atom."""
    if isinstance(category, AtomicCategory):
        return atoms[category.name]
    return FunctionType(type_of(category.argument, atoms), type_of(category.result, atoms))


def _bracketed(category: Category) -> str:
    return f"({category})" if isinstance(category, Functor) else str(category)
