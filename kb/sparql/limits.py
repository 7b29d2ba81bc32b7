# SPDX-License-Identifier: Apache-2.0
"""How long a query may take, and how much memory."""

from __future__ import annotations

import threading
from dataclasses import dataclass

from ...ontology.errors import QueryError, StoppedError

SECONDS = 30.0
MEGABYTES = 2048
MAX_SECONDS = threading.TIMEOUT_MAX  # what a timer takes: some hundred years, days on Windows
MAX_MEGABYTES = 10**9  # more than any machine has


@dataclass(frozen=True)
class Limits:
    """What a query may use up before it is stopped.

    Attributes:
        seconds: time from asking to the last row, in ]0, `MAX_SECONDS`].
        megabytes: memory of the process that works on it, and of what it answers, in
            [1, `MAX_MEGABYTES`]; the embedded engine itself needs about 100.
    """

    seconds: float = SECONDS
    megabytes: int = MEGABYTES

    def __post_init__(self) -> None:
        if not 0 < self.seconds <= MAX_SECONDS:
            raise QueryError(
                f"The time of a query is above 0 s and at most {MAX_SECONDS:.0f} s, "
                f"not {self.seconds:g} s."
            )
        if not 1 <= self.megabytes <= MAX_MEGABYTES:
            raise QueryError(
                f"The memory of a query is between 1 MB and {MAX_MEGABYTES} MB, "
                f"not {self.megabytes} MB."
            )

    def too_long(self) -> StoppedError:
        """The error of a query that was stopped because of its time."""
        return StoppedError(
            f"The query took longer than {self.seconds:g} s and was stopped. "
            "Narrow it, or give it more time."
        )

    def too_large(self) -> StoppedError:
        """The error of a query that was stopped because of its memory."""
        return StoppedError(
            f"The query needed more than {self.megabytes} MB and was stopped. "
            "Narrow it, add a LIMIT, or give it more memory."
        )
