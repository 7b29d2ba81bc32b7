"""Reports of motions, with the reasons of failures."""

from dataclasses import dataclass

REASONS = {
    "nothing_seen": "the object or its part is not visible",
    "no_grasp": "no place on the part can be held",
    "too_wide": "the part is wider than the gripper opens",
    "blocked": "other objects or parts leave no room for the fingers",
    "unreachable": "the arm cannot bring the hand there without a collision",
    "wrong_part": "the fingers closed on something else than the part",
    "missed": "the fingers closed on nothing",
    "slipped": "the object slipped out of the fingers while it was lifted",
    "dropped": "the object was lost after it had been lifted",
    "bumped": "something was touched that must not be",
    "nothing_held": "the hand is empty",
    "nothing_to_strike": "the object to be struck is not there, or does not stand in another one",
    "not_driven": "the object that was struck does not go in",
    "no_gripper": "the robot has no gripper",
    "no_room": "there is no free place on the table",
    "interrupted": "the motion was ended while it ran",
}


@dataclass(frozen=True)
class MotionReport:
    """The result of one motion.

    Attributes:
        action: the primitive: "grasp", "lift", ...
        ok: whether it succeeded.
        reason: why not, one of `REASONS`.
        touched: the parts of the object that the fingers touch.
        lifted_m: height of the object above where it was taken up [m].
        held_s: how long it was held still [s].
        attempts: how often the gripper closed.
        failures: why attempts failed, in order.
        score: of the grasp that was used, at most 1; 0 without one.
        slip_m: how far the object moved in the hand [m].
        slip_rad: how far it turned there [rad].
        bumped: neighbours that were moved by more than a centimetre.
        depth_m: how deep the struck object stands in the other one [m]; 0 without one.
        driven: whether it is driven in completely.
        at: grip at the handover, x, y, z [m] and quaternion x, y, z, w; empty for other motions.
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
