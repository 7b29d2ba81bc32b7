"""Answers to a question with numbered choices: "2", "the first one", "neither of them"."""

from __future__ import annotations

from pathlib import Path

from ..grammar.word_lists import Phrase, load_word_lists


def choice_of(words: Phrase, count: int, path: Path) -> int | None:
    """Return which of `count` choices words take, from 1 on: 0 for none, None for no answer.

    `path` is the file of the words that choose.
    """
    lists = load_word_lists(path, groups=("numbers",), phrases=("last", "around", "none"))
    if lists.has("none", *words):
        return 0
    # "The first one", but also "one": it is a number only where there is no other.
    named = tuple(word for word in words if not lists.has("around", word)) or words[-1:]
    if len(named) != 1:
        return None
    if count > 1 and named in lists.phrases["last"]:
        return count
    numbers = (int(number) for number, _, _ in lists.of_group("numbers", named))
    return next((number for number in numbers if number <= count), None)
