"""Reports of motions, with the reasons of failures."""

from dataclasses import dataclass


@dataclass(frozen=True)
class MotionReport:
    """The result of one motion.

    Attributes:
        action: the primitive: "grasp", "lift", ...
        ok: whether it succeeded.
        reason: why not: a failure of `ontology/actions.yaml`, "no_room" or "interrupted".
        touched: the parts of the object that the fingers touch.
        lifted_m: height of the object above where it was taken up [m].
        held_s: how long it was held still [s].
        attempts: how often the gripper closed.
        failures: why attempts failed, in order.
        score: of the grasp that was used, at most 1; 0 without one.
        slip_m: how far the object moved in the hand, at the grip [m]; more than 1 cm is a failure.
        slip_rad: how far it turned there [rad]; more than 15 degrees are a failure.
        moved: the kinds of neighbours that were put aside for it, in order.
        barred_by: the kinds of those that leave no room for the hand, when that is the reason.
        bumped: other neighbours that were moved by more than a centimetre.
        depth_m: how deep the struck object stands in the other one [m]; 0 without one.
        driven: whether it is driven in completely.
        facing_rad: level angle at the handover from the free part to the receiver [rad], and
            `clearance_m` the gap between it and the fingers [m]; None without one.
        taken: whether the receiver took what was released.
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
    moved: tuple[str, ...] = ()
    barred_by: tuple[str, ...] = ()
    bumped: tuple[str, ...] = ()
    depth_m: float = 0.0
    driven: bool = False
    facing_rad: float | None = None
    clearance_m: float | None = None
    taken: bool = False
    at: tuple[float, ...] = ()
