# SPDX-License-Identifier: Apache-2.0
"""Touch: what meets what, by contact, by nearness and by rays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..poses import Array
from .bodies import Bodies
from .types import Contact, Hit

NO_BODY = -1


class ContactQueries(Bodies):
    """Contacts and rays, told by names."""

    def contacts(
        self, body: str, link: str | None = None, *, other: str | None = None
    ) -> tuple[Contact, ...]:
        """What a body (or one of its links) touched in the last step, and with which force."""
        options: dict[str, int] = {"bodyA": self._body(body).number}
        if link is not None:
            options["linkIndexA"] = self._link(body, link)[1]
        if other is not None:
            options["bodyB"] = self._body(other).number
        return tuple(self._contact(raw) for raw in self._call("getContactPoints", **options))

    def near(
        self, body: str, other: str, *, within: float, link: str | None = None
    ) -> tuple[Contact, ...]:
        """Where two bodies are nearer to each other than `within` [m], without a step."""
        options = {} if link is None else {"linkIndexA": self._link(body, link)[1]}
        raw = self._call(
            "getClosestPoints",
            self._body(body).number,
            self._body(other).number,
            within,
            **options,
        )
        return tuple(self._contact(each) for each in raw)

    def bounds(self, body: str, link: str) -> tuple[Array, Array]:
        """The lowest and the highest corner (3,) of a box round what is felt of a link [m]."""
        low, high = self._call("getAABB", *self._link(body, link))
        return np.array(low), np.array(high)

    def _contact(self, raw: Sequence[Any]) -> Contact:
        body, other = self._names[raw[1]], self._names[raw[2]]
        return Contact(
            body,
            self._link_name(body, raw[3]),
            other,
            self._link_name(other, raw[4]),
            raw[5],
            raw[7],
            raw[8],
            raw[9],
        )

    def rays(self, starts: Array, ends: Array) -> tuple[Hit, ...]:
        """What each ray from a start (n, 3) to an end (n, 3) meets first."""
        raw = self._call("rayTestBatch", starts.tolist(), ends.tolist())
        return tuple(self._hit(each) for each in raw)

    def _hit(self, raw: Sequence[Any]) -> Hit:
        if raw[0] == NO_BODY:
            return Hit(None, None, raw[3])
        body = self._names[raw[0]]
        return Hit(body, self._link_name(body, raw[1]), raw[3])
