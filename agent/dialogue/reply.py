"""The reply to one utterance: what was understood, what was learned or done, and the answer.

Its JSON documents are those of `hilt tell`, `hilt do` and `hilt ask`; other programs rely on their
keys.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from ...kb.rule import Rule
from ...nlu.parsing.understanding import Understanding
from ..execution.outcome import Ending, GoalResult, Json
from ..execution.outcome_answer import INTERRUPTED


@dataclass(frozen=True)
class Reply:
    """The reply to one utterance.

    Attributes:
        said: the spoken answer.
        ending: how the request ended; "done" for a statement that is accepted.
        rules: the rules that were learned, or that the answer rests on.
        seed: the seed of everything random in it.
    """

    text: str
    speaker: str
    understanding: Understanding
    said: str
    ending: Ending
    rules: tuple[Rule, ...] = ()
    result: GoalResult | None = None
    seed: int = 0

    @property
    def is_done(self) -> bool:
        """Whether what was asked for was done; decides the exit code."""
        return self.ending == "done"

    @property
    def is_interrupted(self) -> bool:
        """Whether a command was ended while it was carried out."""
        return self.result is not None and self.result.answer.cause == INTERRUPTED

    def with_pictures(self, *files: str) -> Reply:
        """Return this reply with pictures of what was done, if anything was."""
        result = self.result
        if result is None or not result.world.executed:
            return self
        world = replace(result.world, pictures=files)
        return replace(self, result=replace(result, world=world))

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
