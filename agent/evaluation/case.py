"""Cases of an experiment and their results.

Both are plain JSON, so that they can be sent to other processes and written to files. They contain
nothing that differs from run to run: a case gives the same bytes with any runner. `TimedResult`
adds the processor time and the number of attempts.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from ..execution.outcome import Json

Kind = Literal["unique", "tie", "none", "grasp", "check", "error", "lost"]


@dataclass(frozen=True)
class Case:
    """A case of an experiment: a question with a known answer.

    Attributes:
        key: identifies the case within the experiment, in any run.
        spec: everything needed to run it, including its seed.
    """

    experiment: str
    key: str
    spec: Json


@dataclass(frozen=True)
class CaseResult:
    """The result of a case.

    Attributes:
        right: whether it agrees with the ground truth.
        kind: for decisions "unique", "tie" or "none", the number of right choices; "grasp" for
            grasps; "check" for anything else; "error" if the case raised an exception; "lost" if
            no worker finished it.
        principle: the principle of section 4.1 of the paper, 1 to 4; 0 if none applies.
        found: what was chosen or done.
        expected: what the ground truth allows.
    """

    key: str
    right: bool
    kind: Kind
    principle: int
    found: str
    expected: str
    facts: Json = field(default_factory=dict[str, object])


@dataclass(frozen=True)
class TimedResult:
    """A result with its processor time [s] and how often the case was started."""

    result: CaseResult
    cpu_s: float
    attempts: int = 1

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> TimedResult:
        """Return the result that `to_json_line` wrote; KeyError or TypeError if it is none."""
        result = CaseResult(**document["result"])
        return cls(result, document["cpu_s"], document["attempts"])


def to_json_line(document: object) -> str:
    """Return a document, a case or a result as a line of JSON: equal bytes for equal content."""
    return json.dumps(
        document, default=vars, ensure_ascii=False, sort_keys=True, separators=(",", ":")
    )
