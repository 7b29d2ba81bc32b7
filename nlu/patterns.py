# SPDX-License-Identifier: Apache-2.0
"""Spellings written short: `when (you|we) [want to]` for four of them.

A choice stands in round brackets, what may be left out in square ones, as in the paper's Table 3
and the JSpeech Grammar Format.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from ..ontology.source import Field

MAX_SPELLINGS = 4000
MANY = 3
"""From this number of choices on, a group of words is looked up on its own."""


def spellings(field: Field) -> list[tuple[str, ...]]:
    """All that a pattern stands for, each as its words, in the order of the choices.

    Raises:
        DataError: a bracket is missing, or there are more than `MAX_SPELLINGS`.
    """
    text = field.text()
    found, end = _choices(text, 0, field)
    if end != len(text):
        raise field.fail(f'expected no "{text[end]}" here, or a bracket before it.')
    if any(not words for words in found):
        raise field.fail("expected at least one word that cannot be left out.")
    return list(dict.fromkeys(found))


@dataclass(frozen=True)
class Group:
    """A choice of many words, as it stands in a pattern: `(what|which|whose|...)`.

    Attributes:
        text: how the pattern writes it, which is its name.
        choices: all that it stands for.
    """

    text: str
    choices: tuple[tuple[str, ...], ...]


def factored(field: Field) -> list[tuple[str | Group, ...]]:
    """All that a pattern stands for, where choices of many words stay together as groups.

    Without this, five choices of ten words in one line would stand for 100,000 spellings.

    Raises:
        DataError: as for `spellings`.
    """
    groups: dict[str, Group] = {}
    text, place = "", 0
    whole = field.text()
    for start, end in _outermost(whole):
        text += whole[place:start] + _grouped(whole[start:end], field, groups)
        place = end
    rest = replace(field, value=text + whole[place:])
    return [tuple(groups.get(word, word) for word in words) for words in spellings(rest)]


def _grouped(text: str, field: Field, groups: dict[str, Group]) -> str:
    """A bracket of a pattern, or the mark of the group that it is."""
    if "{" in text:
        return text
    found = dict.fromkeys(_choices(text[1:-1], 0, field)[0])
    choices = tuple(words for words in found if words)
    if len(choices) < MANY:
        return text
    group = Group(text, choices)
    mark = f"<{len(groups)}>"
    groups[mark] = group
    return f"[{mark}]" if text.startswith("[") or len(choices) < len(found) else mark


def _outermost(text: str) -> Iterator[tuple[int, int]]:
    depth = start = 0
    for place, letter in enumerate(text):
        if letter in "([":
            start = place if depth == 0 else start
            depth += 1
        elif letter in ")]":
            depth -= 1
            if depth == 0:
                yield start, place + 1


def _choices(text: str, start: int, field: Field) -> tuple[list[tuple[str, ...]], int]:
    alternatives: list[tuple[str, ...]] = []
    current: list[tuple[str, ...]] = [()]
    place = start
    while place < len(text) and text[place] not in ")]":
        if text[place] in "([":
            inner, end = _choices(text, place + 1, field)
            closing = ")" if text[place] == "(" else "]"
            if text[end : end + 1] != closing:
                raise field.fail(f'expected "{closing}" after character {end}.')
            if closing == "]":
                inner = [*inner, ()]
            current = [(*before, *after) for before in current for after in inner]
            place = end + 1
        elif text[place] == "|":
            alternatives += current
            current, place = [()], place + 1
        elif text[place] == " ":
            place += 1
        else:
            end = place
            while end < len(text) and text[end] not in " |()[]":
                end += 1
            current = [(*before, text[place:end]) for before in current]
            place = end
        if len(current) + len(alternatives) > MAX_SPELLINGS:
            raise field.fail(f"stands for more than {MAX_SPELLINGS} spellings.")
    return alternatives + current, place
