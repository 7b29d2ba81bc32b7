# SPDX-License-Identifier: Apache-2.0
"""How long a query may take, and how much memory."""

from __future__ import annotations

from dataclasses import dataclass

from ..ontology.errors import QueryError

SECONDS = 30.0
MEGABYTES = 2048


@dataclass(frozen=True)
class Limits:
    """What a query may use up before it is stopped.

    Attributes:
        seconds: time from asking to the last row; above 0.
        megabytes: memory of the process that works on it, and of what it answers; the embedded
            engine itself needs about 100.
    """

    seconds: float = SECONDS
    megabytes: int = MEGABYTES

    def __post_init__(self) -> None:
        if not self.seconds > 0:
            raise QueryError(f"A query needs some time: {self.seconds} s is none.")
        if self.megabytes < 1:
            raise QueryError(f"A query needs some memory: {self.megabytes} MB is none.")

    def too_long(self) -> QueryError:
        """The error of a query that was stopped because of its time."""
        return QueryError(
            f"The query took longer than {self.seconds:g} s and was stopped. "
            "Narrow it, or give it more time."
        )

    def too_large(self) -> QueryError:
        """The error of a query that was stopped because of its memory."""
        return QueryError(
            f"The query needed more than {self.megabytes} MB and was stopped. "
            "Narrow it, add a LIMIT, or give it more memory."
        )
