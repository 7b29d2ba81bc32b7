"""Contacts between bodies: which there are, with which friction, and which are computed at all."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from .bodies import BASE, Bodies
from .pybullet_client import PhysicsClient


@dataclass(frozen=True)
class Contact:
    """What the body touches that was asked for, and with which force along the normal [N]."""

    other: str
    other_link: str
    force: float


class Contacts:
    """The contacts of bodies, their friction, and which of them are computed."""

    def __init__(self, client: PhysicsClient, bodies: Bodies) -> None:
        self._client, self._bodies = client, bodies

    def find(self, body: str, link: str | None = None) -> tuple[Contact, ...]:
        """A body's contacts in the last step: of one link, if it is given."""
        options = {"bodyA": self._bodies.number(body)}
        if link is not None:
            options["linkIndexA"] = self._bodies.link_id(body, link)[1]
        name = self._bodies.link_name
        return tuple(
            Contact(*name(raw[2], raw[4]), raw[9])
            for raw in self._client.call("getContactPoints", **options)
        )

    def set_surface(
        self,
        body: str,
        link: str | None = None,
        *,
        friction: float | None = None,
        spinning: float | None = None,
        rolling: float | None = None,
    ) -> None:
        """Set the friction of a link, or of all links when `link` is None.

        `friction` is the lateral coefficient; between two surfaces their product counts. `spinning`
        and `rolling` are the resistances against turning on the spot and rolling [m].
        """
        wanted = {
            "lateralFriction": friction,
            "spinningFriction": spinning,
            "rollingFriction": rolling,
        }
        options = {key: value for key, value in wanted.items() if value is not None}
        for number, index in self._bodies.link_ids(body, link):
            self._client.call("changeDynamics", number, index, **options)

    def enable(self, body: str, other: str, *, enabled: bool) -> None:
        """Compute contacts between two bodies from now on, or let them pass through each other."""
        pairs = product(self._bodies.link_ids(body), self._bodies.link_ids(other))
        for (number, link), (other_number, other_link) in pairs:
            numbers = number, other_number, link, other_link
            self._client.call("setCollisionFilterPair", *numbers, int(enabled))

    def set_sleeping(self, body: str, *, asleep: bool) -> None:
        """Put a body that lies still to sleep, or wake it and compute it at every step from now on.

        One that sleeps is computed once something touches it, until it has lain still for a while.
        """
        states = ("ENABLE_SLEEPING", "SLEEP") if asleep else ("WAKE_UP", "DISABLE_SLEEPING")
        for state in states:
            constant = self._client.constant(f"ACTIVATION_STATE_{state}")
            number = self._bodies.number(body)
            self._client.call("changeDynamics", number, BASE, activationState=constant)
