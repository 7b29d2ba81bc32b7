# SPDX-License-Identifier: Apache-2.0
"""Matter: how surfaces behave, what may touch what, and what need not be reckoned with."""

from __future__ import annotations

from .bodies import BASE, Bodies


class Matter(Bodies):
    """The surfaces of bodies, and which of their contacts count."""

    def set_surface(
        self,
        body: str,
        link: str | None = None,
        *,
        friction: float | None = None,
        spinning: float | None = None,
        rolling: float | None = None,
        bounce: float | None = None,
    ) -> None:
        """Set how a link's surface behaves; of all links when `link` is None.

        Args:
            body: whose.
            link: which one.
            friction: lateral coefficient; the product of both surfaces counts.
            spinning: resistance against turning on the spot [m].
            rolling: resistance against rolling [m].
            bounce: restitution in [0, 1].
        """
        wanted = {
            "lateralFriction": friction,
            "spinningFriction": spinning,
            "rollingFriction": rolling,
            "restitution": bounce,
        }
        options = {key: value for key, value in wanted.items() if value is not None}
        for each in self.links(body) if link is None else (link,):
            self._call("changeDynamics", *self._link(body, each), **options)

    def set_damping(self, body: str, *, linear: float, angular: float) -> None:
        """Set how much a body's motion is damped, as shares of its speed per second."""
        self._call(
            "changeDynamics",
            self._body(body).number,
            BASE,
            linearDamping=linear,
            angularDamping=angular,
        )

    def ignore_contacts(self, body: str, link: str, other: str, other_link: str) -> None:
        """Let two links pass through each other from now on."""
        number, index = self._link(body, link)
        other_number, other_index = self._link(other, other_link)
        self._call("setCollisionFilterPair", number, other_number, index, other_index, 0)

    def enable_collisions(self, body: str, other: str, *, wanted: bool) -> None:
        """Reckon with contacts between two bodies from now on, or no longer."""
        first, second = self._body(body), self._body(other)
        for index in first.links.values():
            for other_index in second.links.values():
                self._call(
                    "setCollisionFilterPair",
                    first.number,
                    second.number,
                    index,
                    other_index,
                    int(wanted),
                )

    def enable_sleeping(self, body: str) -> None:
        """Reckon with a body that lies still only once something that moves touches it.

        It is woken by what bumps into it, and sleeps again when it has lain still for a while.
        """
        number = self._body(body).number
        for state in (self._p.ACTIVATION_STATE_ENABLE_SLEEPING, self._p.ACTIVATION_STATE_SLEEP):
            self._call("changeDynamics", number, BASE, activationState=state)

    def keep_awake(self, body: str) -> None:
        """Reckon with a body at every step, from now on."""
        number = self._body(body).number
        for state in (self._p.ACTIVATION_STATE_WAKE_UP, self._p.ACTIVATION_STATE_DISABLE_SLEEPING):
            self._call("changeDynamics", number, BASE, activationState=state)
