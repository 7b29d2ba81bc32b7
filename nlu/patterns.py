# SPDX-License-Identifier: Apache-2.0
"""Spellings written short: `when (you|we) [want to]` for four of them.

A choice stands in round brackets, what may be left out in square ones, as in the paper's Table 3
and the JSpeech Grammar Format.
"""

from __future__ import annotations

from ..ontology.source import Field

MAX_SPELLINGS = 4000


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
