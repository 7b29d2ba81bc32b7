"""The robot's body: vision, one arm with a hand, and the world it acts in.

It knows nothing of rules: which object and which part is decided elsewhere. A motion that fails is
tried again with another grasp where that can help; what cannot be done is reported without trying.
"""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..ontology.errors import UnknownNameError
from ..ontology.objects import ObjectType
from ..ontology.plugins import plugin_names
from .manipulation.striking import Striking
from .robot.interruption import Interruption
from .robot.models import find_robot
from .robot.robot import Robot
from .scene.scene import Scene
from .scene.world import World
from .vision.camera import CAMERAS_ROUND_TABLE, Camera
from .vision.learned_detector import LearnedDetector, Recogniser
from .vision.object_detector import MaskDetector, ObjectDetector
from .vision.percept import Percept, visible_features
from .vision.perception_noise import NoiseLevels

if TYPE_CHECKING:
    from .media.recording import WorldRecorder

VISIONS = ("mask", "learned")
HAND_ABILITIES = {"graspObject", "moveTo", "handOver", "moveAbove", "raise", "lower"}


class Body(Striking, AbstractContextManager["Body"]):
    """A robot at a table with the objects of a scene.

    Use it in a `with` block, or `close` it. All choices of the motions are drawn from the seed. The
    robot is named as for `find_robot`, and the vision, where percepts come from, as for
    `open_vision`; `load_cameras` reads other cameras. The noise is that of their depths. By the
    `interruption` another thread pauses motions or ends them: these report "interrupted".
    """

    def __init__(
        self,
        scene: Scene,
        objects: Mapping[str, ObjectType],
        *,
        seed: int,
        gui: bool = False,
        robot: str = "panda",
        vision: str = "mask",
        noise: NoiseLevels | None = None,
        cameras: Sequence[Camera] = CAMERAS_ROUND_TABLE,
        interruption: Interruption | None = None,
    ) -> None:
        kind = find_robot(robot)
        world = World.build(scene, objects, gui=gui)
        seen = open_vision(world, source=vision, noise=noise, cameras=cameras)
        world.let_sleep()
        arm = Robot(world.engine, kind, interruption=interruption)
        super().__init__(world, arm, seen, seed=seed)

    def close(self) -> None:
        """Stop the simulator."""
        self.world.close()

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def abilities(self) -> frozenset[str]:
        """The primitives of the action trees that it can perform."""
        hand = HAND_ABILITIES if self.robot.kind.gripper else set[str]()
        return frozenset({"findObject", "pointAt", *hand})

    @property
    def eyes(self) -> LearnedDetector | None:
        """The learned eyes, to which new kinds can be shown; None with another vision."""
        return self._vision if isinstance(self._vision, LearnedDetector) else None

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """Return the objects in view that have one of the features ("object:knife"), surest first.

        An object in the hand is known as it was seen before, also where vision misses it now.
        """
        found, held = self._vision.search(features), self.in_hand
        if held is None:
            return found
        is_missed = all(percept.name != held.name for percept in found)
        is_wanted = not visible_features(held.context.kind).isdisjoint(features)
        return (*found, held.context.percept) if is_missed and is_wanted else found

    def picture(self, path: Path) -> Path:
        """Write a picture of the scene as it is now, and return the path."""
        from .media.pictures import save_picture, take_picture

        save_picture(take_picture(self.world.engine), path)
        return path

    def record(self, path: Path) -> "WorldRecorder":
        """Return a recorder of everything that happens inside its `with` block."""
        from .media.recording import WorldRecorder

        return WorldRecorder(self.world, path)

    def state_hash(self) -> str:
        """Return a hash, equal only where all poses, joints and the time are, to the last bit."""
        numbers = [self.world.pose(name) for name in self.world.kinds]
        numbers += [self.robot.joints, np.array(self.world.engine.steps)]
        return sha256(b"".join(each.tobytes() for each in numbers)).hexdigest()[:16]


def open_vision(
    world: World,
    *,
    source: str = "mask",
    noise: NoiseLevels | None = None,
    cameras: Sequence[Camera] = CAMERAS_ROUND_TABLE,
) -> ObjectDetector:
    """Open the detector that `--vision` names: "mask", "learned" or "learned:FILE".

    "mask" uses the simulator's segmentation mask, as a perfect detector; "learned" only colours and
    depths. The file is one of classifiers of one's own, a `DataError` when it cannot be read.
    """
    check_vision(source)
    kind, _, file = source.partition(":")
    if kind == "mask":
        return MaskDetector(world, noise or NoiseLevels(), cameras)
    recogniser = Recogniser.load(Path(file)) if file else Recogniser.default()
    return LearnedDetector(world, noise or NoiseLevels(), cameras, recogniser)


def check_vision(source: str) -> None:
    """Check the name of a source of percepts before anything is made, by `UnknownNameError`."""
    kind, _, file = source.partition(":")
    if kind not in VISIONS or (file and kind != "learned"):
        known = (*VISIONS, "learned:FILE", *plugin_names("hilt.vision"))
        raise UnknownNameError("source of vision", source, known)
