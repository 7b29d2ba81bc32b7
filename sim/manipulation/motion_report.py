"""Reports of motions, with the reasons of failures."""

from dataclasses import dataclass


@dataclass(frozen=True)
class MotionReport:
    """The result of one motion."""

    action: str  #: the primitive: "grasp", "lift", ...
    ok: bool  #: whether it succeeded
    reason: str = ""  #: why not: a failure of `ontology/actions.yaml`, "no_room" or "interrupted"
    touched: tuple[str, ...] = ()  #: the parts of the object that the fingers touch
    lifted_m: float = 0.0  #: height of the object above where it was taken up [m]
    held_s: float = 0.0  #: how long it was held still [s]
    attempts: int = 0  #: how often the gripper closed
    failures: tuple[str, ...] = ()  #: why attempts failed, in order
    score: float = 0.0  #: of the grasp that was used, at most 1; 0 without one
    slip_m: float = 0.0  #: how far it moved in the hand, at the grip [m]; at most 1 cm is firm
    slip_rad: float = 0.0  #: how far it turned there [rad]; at most 15 degrees are firm
    moved: tuple[str, ...] = ()  #: the kinds of neighbours that were put aside for it, in order
    barred_by: tuple[str, ...] = ()  #: the kinds of those that leave no room, if that is why
    depth_m: float = 0.0  #: how deep the struck object stands in the other one [m]; 0 without one
    driven: bool = False  #: whether it is driven in completely
    facing_rad: float | None = None  #: level angle at the handover, free part to receiver [rad]
    clearance_m: float | None = None  #: gap between that part and the fingers [m]
    taken: bool = False  #: whether the receiver took what was released
    at: tuple[float, ...] = ()  #: grip at the handover, x, y, z [m] and quaternion x, y, z, w
