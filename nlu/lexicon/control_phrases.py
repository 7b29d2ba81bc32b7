"""Control phrases: "stop", "please wait", "put it down", which are obeyed before any parsing.

An utterance is a control only as a whole, so "stop using the knife" and "never drop it" are none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...ontology.yaml_reader import read_yaml
from ..grammar.word_patterns import Steps, read_patterns
from .tokenizer import BREAK

_THING, _OBJECT = "THING", "OBJECT"
_MAX_NAME = 5  # words of an object with its article

Span = tuple[int, int]


@dataclass(frozen=True)
class ControlPhrases:
    """The phrases of each control and those that may stand round them.

    Attributes:
        phrases: control -> its patterns; of several in an utterance the first counts.
        polite: patterns that change nothing.
        pronouns: the words for the object in the hand.
    """

    phrases: dict[str, tuple[Steps, ...]]
    polite: tuple[Steps, ...]
    pronouns: frozenset[tuple[str, ...]]

    def match(
        self, words: Sequence[str], named: Callable[[int, int], str | None]
    ) -> tuple[str, str | None] | None:
        """Return the control that an utterance is, and what it names, as `named` tells, if any."""
        found: dict[str, str | None] = {}
        place = 0
        while place < len(words):
            if words[place] == BREAK:
                place += 1
                continue
            step = self._control(words, place, named) or self._polite(words, place)
            if step is None:
                return None
            control, place, thing = step
            if control:
                found[control] = thing or found.get(control)
        return next(((each, found[each]) for each in self.phrases if each in found), None)

    def _control(
        self, words: Sequence[str], start: int, named: Callable[[int, int], str | None]
    ) -> tuple[str, int, str | None] | None:
        """The longest control phrase from a place on: its control, its end, the object named."""
        spans = (
            (end, control, thing)
            for control, patterns in self.phrases.items()
            for steps in patterns
            for end, thing in self._ends(steps, words, start)
        )
        for end, control, thing in sorted(spans, key=lambda each: each[0], reverse=True):
            if thing is None:
                return control, end, None
            kind = named(*thing)
            if kind is not None:
                return control, end, kind
        return None

    def after_polite(self, words: Sequence[str]) -> int:
        """Return the place after the phrases that change nothing at the beginning of some words."""
        place = 0
        while place < len(words) and (step := self._polite(words, place)):
            place = step[1]
        return place

    def _polite(self, words: Sequence[str], start: int) -> tuple[str, int, None] | None:
        ends = [end for steps in self.polite for end, _ in self._ends(steps, words, start)]
        return ("", max(ends), None) if ends else None

    def _ends(
        self, steps: Steps, words: Sequence[str], start: int, thing: Span | None = None
    ) -> Iterator[tuple[int, Span | None]]:
        """Where a pattern may end that begins at a place, with the span of the object in it."""
        for step in steps:
            if isinstance(step, int):
                yield start, thing
            elif step[0] in {_THING, _OBJECT}:
                for end in range(start + 1, min(len(words), start + _MAX_NAME) + 1):
                    is_pronoun = tuple(words[start:end]) in self.pronouns
                    if is_pronoun and step[0] == _THING:
                        yield from self._ends(step[1], words, end)
                    elif not is_pronoun:
                        yield from self._ends(step[1], words, end, (start, end))
            elif start < len(words) and words[start] == step[0]:
                yield from self._ends(step[1], words, start + 1, thing)


def load_controls(path: Path) -> ControlPhrases:
    """Read the control phrases of a language; `DataError` where the file is not as expected."""
    parts = read_yaml(path).entries(required=("controls", "polite", "pronouns"))
    phrases = {name: read_patterns(each) for name, each in parts["controls"].entries().items()}
    pronouns = frozenset(tuple(text.split()) for text in parts["pronouns"].texts())
    return ControlPhrases(phrases, read_patterns(parts["polite"]), pronouns)
