# SPDX-License-Identifier: Apache-2.0
"""What came of a motion: reports with reasons, since failing is ordinary for a robot."""

from __future__ import annotations

from dataclasses import dataclass

REASONS = {
    "nothing_seen": "the thing or its part is not in view",
    "no_grasp": "no place on the part can be held",
    "too_wide": "the part is wider than the hand opens",
    "blocked": "other things or parts leave no room for the fingers",
    "unreachable": "the arm cannot bring the hand there without bumping into something",
    "wrong_part": "the fingers closed on something else than the part",
    "missed": "the fingers closed on nothing",
    "slipped": "the thing slipped out of the fingers while it was lifted",
    "dropped": "the thing was lost after it had been lifted",
    "bumped": "something was touched that must not be",
    "nothing_held": "the hand is empty",
    "nothing_to_strike": "what is to be struck is not there, or does not stand in anything",
    "not_driven": "what was struck does not go in",
    "no_gripper": "the robot has no hand",
}


@dataclass(frozen=True)
class MotionReport:
    """What came of one motion.

    Attributes:
        action: the primitive: "grasp", "lift", ...
        ok: whether it did what it is for.
        reason: why not, one of `REASONS`; empty when it did.
        touched: the parts of the thing that the fingers touch.
        lifted_m: how far the thing is above where it was taken up [m].
        held_s: how long it was held still [s].
        attempts: how often the hand closed.
        failures: why it closed in vain, in order.
        score: of the grasp that was used, at most 1; 0 when none was.
        slip_m: how far the thing moved in the hand [m].
        slip_rad: how far it turned in the hand [rad].
        bumped: neighbours that were moved by more than a centimetre.
        depth_m: how deep what was struck stands in [m]; 0 when nothing was struck.
        driven: whether it is in all the way.
        at: where the grip hands over what it holds: x, y, z [m] and the unit quaternion x, y, z, w
            in the world; empty for other motions, and when it does not come there.
    """

    action: str
    ok: bool
    reason: str = ""
    touched: tuple[str, ...] = ()
    lifted_m: float = 0.0
    held_s: float = 0.0
    attempts: int = 0
    failures: tuple[str, ...] = ()
    score: float = 0.0
    slip_m: float = 0.0
    slip_rad: float = 0.0
    bumped: tuple[str, ...] = ()
    depth_m: float = 0.0
    driven: bool = False
    at: tuple[float, ...] = ()
