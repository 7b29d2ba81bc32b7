"""An open question of Hilt: who was asked, and what each answer leads to.

It is answered by "yes" or "no", by a short answer ("the red one", "the second", "neither"), or not
at all: an answer that does not fit is an utterance like any other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ...nlu.semantics.meaning import Answer
from .reply import Reply


@dataclass(frozen=True)
class OpenQuestion:
    """A question of Hilt that waits for an answer.

    Attributes:
        asked: the only speaker who can answer it.
        yes: called after a "yes"; None where there is nothing to agree to.
        no: called after a "no"; None only acknowledges.
        choices: called after the number of a choice, by number from 1 on.
        choose: called with an answer that names something; it returns None where the answer does
            not fit, which must change nothing.
        tell: called with the text of any other answer; it returns None where it does not fit.
        needs_yes: whether "okay" only acknowledges it, and does not agree.
        word: the word that may be a slip, if it is asked about one.
    """

    asked: str
    yes: Callable[[], Reply] | None = None
    no: Callable[[], Reply] | None = None
    choices: tuple[Callable[[], Reply], ...] = ()
    choose: Callable[[Answer], Reply | None] | None = None
    tell: Callable[[str], Reply | None] | None = None
    needs_yes: bool = False
    word: str = ""

    def reply_to(self, answer: Answer) -> Reply | None:
        """Return the reply to a short answer; None where it does not fit."""
        if answer.number:
            return self.choices[answer.number - 1]()
        if answer.choice == "any" and (self.choices or self.yes):
            return self.choices[0]() if self.choices else self.yes and self.yes()
        return self.choose(answer) if answer.name and self.choose else None
