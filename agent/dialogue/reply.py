"""The reply to one utterance, and the question of Hilt that it may leave open.

Its JSON documents are those of `hilt tell`, `do` and `ask`; other programs rely on their keys.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from ...inference.types import Candidate
from ...kb.rule import Rule
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics.meaning import Answer
from ..execution.outcome import Decision, Ending, GoalResult, Json
from ..execution.outcome_answer import INTERRUPTED


@dataclass(frozen=True)
class Reply:
    """The reply to one utterance."""

    text: str
    speaker: str
    understanding: Understanding
    said: str  #: the spoken answer
    ending: Ending  #: how the request ended; "done" for a statement that is accepted
    rules: tuple[Rule, ...] = ()  #: the rules that were learned, or that the answer rests on
    result: GoalResult | None = None
    seed: int = 0
    heard: float = 1.0  #: how surely a recogniser heard what was meant, in [0, 1]

    @property
    def is_done(self) -> bool:
        """Whether what was asked for was done; decides the exit code."""
        return self.ending == "done"

    @property
    def decision(self) -> Decision | None:
        """The decision of a command; None where none was made."""
        return self.result.decision if self.result else None

    @property
    def chosen(self) -> Candidate | None:
        """The object that was chosen for a command, if any."""
        return self.decision.object.best if self.decision else None

    @property
    def is_interrupted(self) -> bool:
        """Whether a command was ended while it was carried out."""
        return self.result is not None and self.result.answer.cause == INTERRUPTED

    def with_pictures(self, *files: str) -> "Reply":
        """Return this reply with pictures of what was done, if anything was."""
        if self.result is None or not self.result.world.executed:
            return self
        world = replace(self.result.world, pictures=files)
        return replace(self, result=replace(self.result, world=world))

    def as_tell_json(self) -> Json:
        """As `hilt tell --json` prints it."""
        return {
            "utterance": self.text,
            "accepted": self.is_done,
            "said": self.said,
            "rules": [rule.as_json() for rule in self.rules] if self.is_done else [],
            "new_words": [word.as_json() for word in self.understanding.new_words],
        }

    def as_ask_json(self) -> Json:
        """As `hilt ask --json` prints it."""
        return {
            "utterance": self.text,
            "answered": self.is_done,
            "said": self.said,
            "rules": [rule.as_json() for rule in self.rules],
        }

    def as_do_json(self) -> Json:
        """As `hilt do --json` prints it."""
        nothing: Json = {"decision": None, "steps": [], "world": {"executed": False}}
        return {
            "utterance": self.text,
            "goal": self.understanding.content,
            "outcome": self.ending,
            "said": self.said,
            **(self.result.as_json() if self.result else nothing),
            "seed": self.seed,
        }


def joined(text: str, replies: Sequence[Reply]) -> Reply:
    """The reply to several sentences, with all that was said and learned; it ends as the worst."""
    reply = next((each for each in replies if not each.is_done), replies[-1])
    rules = tuple(rule for each in replies for rule in each.rules)
    return replace(reply, text=text, said=" ".join(each.said for each in replies), rules=rules)


@dataclass(frozen=True)
class OpenQuestion:
    """A question of Hilt that waits for an answer: "yes", "no", or a short one ("the second").

    An answer that does not fit is an utterance like any other.
    """

    asked: str  #: the only speaker who can answer it
    #: called after a "yes"; None where there is nothing to agree to
    yes: Callable[[], Reply] | None = None
    no: Callable[[], Reply] | None = None  #: called after a "no"; None only acknowledges
    #: called after the number of a choice, by number from 1 on
    choices: tuple[Callable[[], Reply], ...] = ()
    #: called with an answer that names something; it returns None where the answer does not fit,
    #: which must change nothing
    choose: Callable[[Answer], Reply | None] | None = None
    #: called with the text of any other answer; it returns None where it does not fit
    tell: Callable[[str], Reply | None] | None = None
    needs_yes: bool = False  #: whether "okay" only acknowledges it, and does not agree
    is_lesson: bool = False  #: whether it asks to be told what Hilt does not know
    word: str = ""  #: the word that may be a slip, if it is asked about one
    meanings: tuple[object, ...] = ()  #: what the choices mean, where it reads back what was heard

    def reply_to(self, answer: Answer) -> Reply | None:
        """Return the reply to a short answer; None where it does not fit."""
        if answer.number:
            return self.choices[answer.number - 1]()
        first = self.choices[0] if self.choices else self.yes
        if answer.choice == "any" and first:
            return first()
        return self.choose(answer) if answer.name and self.choose else None
