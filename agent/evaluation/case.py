# SPDX-License-Identifier: Apache-2.0
"""One case of an experiment, and what came of it.

Both are plain JSON, so that they pass between processes and machines and stay readable in files.
Nothing that differs from run to run is in them: the same case gives the same bytes on any engine.
How long a case took is kept beside its result, in `Done`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, cast

from ..execution.outcome import Json

Kind = Literal["unique", "tie", "none", "grasp", "check", "error", "lost"]


@dataclass(frozen=True)
class Case:
    """One case.

    Attributes:
        experiment: the name of the experiment it belongs to.
        key: what it is called; no other case of the experiment is called so, in any run.
        spec: all that running it needs, its seed too.
    """

    experiment: str
    key: str
    spec: Json

    def as_json(self) -> Json:
        """As it is sent to a worker."""
        return dict(vars(self))

    @classmethod
    def from_json(cls, document: Mapping[str, object]) -> Case:
        """The case that `as_json` wrote."""
        spec = cast("Json", document["spec"])
        return cls(str(document["experiment"]), str(document["key"]), spec)


@dataclass(frozen=True)
class Result:
    """What came of a case.

    Attributes:
        key: of the case.
        right: whether it is what the ground truth allows.
        kind: "unique", "tie" or "none", how many choices are right, for decisions; "grasp" for
            grasps; "check" for anything else; "error" when the case raised an error; "lost" when
            no worker lived to finish it.
        principle: of the paper's section 4.1, 1 to 4; 0 where none applies.
        found: what was chosen or done.
        expected: what the ground truth allows.
        facts: whatever else is worth keeping, as plain JSON.
    """

    key: str
    right: bool
    kind: Kind
    principle: int
    found: str
    expected: str
    facts: Json = field(default_factory=dict[str, object])

    def as_json(self) -> Json:
        """As a line of a file of results."""
        return dict(vars(self))

    @classmethod
    def from_json(cls, document: Mapping[str, object]) -> Result:
        """The result that `as_json` wrote.

        Raises:
            KeyError, TypeError, ValueError: it is no such document.
        """
        return cls(
            key=str(document["key"]),
            right=bool(document["right"]),
            kind=cast("Kind", document["kind"]),
            principle=int(cast("int", document["principle"])),
            found=str(document["found"]),
            expected=str(document["expected"]),
            facts=dict(cast("Json", document["facts"])),
        )


@dataclass(frozen=True)
class Done:
    """A result, with what differs from run to run.

    Attributes:
        result: what came of the case.
        cpu_s: processor time that it took [s].
        attempts: how often it was begun.
    """

    result: Result
    cpu_s: float
    attempts: int = 1


def line_of(document: Json) -> str:
    """A document as one line: the same bytes for the same content."""
    return json.dumps(document, ensure_ascii=False, sort_keys=True, separators=(",", ":"))
