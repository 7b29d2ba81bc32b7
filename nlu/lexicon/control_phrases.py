"""Control phrases: "stop", "please wait", "put it down", which are obeyed before any parsing.

An utterance is a control only as a whole, so "stop using the knife" and "never drop it" are none.
"""

from collections.abc import Callable
from dataclasses import dataclass

from ..grammar.word_patterns import WordLists
from .tokenizer import BREAK

Named = Callable[[int, int], str | None]


@dataclass(frozen=True)
class ControlPhrases:
    """The words of `controls.yaml`: phrases of each control, and those that may stand round them.

    Of several controls in an utterance that counts whose phrases come first.
    """

    words: WordLists

    def match(self, words: tuple[str, ...], named: Named) -> tuple[str, str | None] | None:
        """Return the control that an utterance is, and what it names, as `named` tells, if any."""
        found: dict[str, str | None] = {}
        place = 0
        while place < len(words):
            if words[place] == BREAK:
                place += 1
                continue
            control, end, thing = self._control(words, place, named)
            if end == place:
                end = self.words.end("polite", words, place)
            if end == place:
                return None
            place = end
            if control:
                found[control] = thing or found.get(control)
        controls = self.words.names("controls")
        return next(((each, found[each]) for each in controls if each in found), None)

    def _control(
        self, words: tuple[str, ...], start: int, named: Named
    ) -> tuple[str, int, str | None]:
        spans = self.words.of_group("controls", words, start)
        for control, end, slots in sorted(spans, key=lambda each: each[1], reverse=True):
            slot, place = next(iter(slots.items()), ("", (0, 0)))
            is_pronoun = self.is_pronoun(words[slice(*place)])
            if not slot or (is_pronoun and slot == "THING"):
                return control, end, None
            kind = None if is_pronoun else named(*place)
            if kind is not None:
                return control, end, kind
        return "", start, None

    def is_pronoun(self, words: tuple[str, ...]) -> bool:
        """Whether some words stand for the object in the hand."""
        return self.words.has("pronouns", *words)

    def after_polite(self, words: tuple[str, ...]) -> int:
        """Return the place after the phrases that change nothing at the beginning of some words."""
        place = 0
        while (end := self.words.end("polite", words, place)) > place:
            place = end
        return place
