# SPDX-License-Identifier: Apache-2.0
"""What an agent is put into: the table with its things, the robot, and how well it sees.

All of it is data that a command of the command line can name, so that an episode can say under
what circumstances it came about, and be run again under the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..ontology.objects import Household, load_household
from ..sim.scene.scene import Placement, Scene, parse_scene
from .episodes.keeping import file_as_json, file_from_json
from .execution.outcome import Json
from .execution.perception import PerfectVision
from .opening import household
from .protocols import Vision

if TYPE_CHECKING:
    from ..sim.body import Body
    from ..sim.vision.noise import Noise

ROBOT, EYES = "panda", "mask"  # what there is when nobody says


@dataclass(frozen=True)
class Embodiment:
    """A table, a robot and its eyes.

    Attributes:
        scene: what is on the table; its seed is that of everything random.
        household: the types of objects that there are.
        objects_file: the user's own file among them, if any.
        robot: its name, or a file of robots and the name in it; see `find_robot`.
        eyes: where percepts come from, "mask", "learned" or "learned:FILE".
        noise: how the eyes fail, as text ("missed=0.1,confused=0.05"); empty for not at all.
        simulate: whether there is a simulated body; without one all is seen with certainty.
        gui: whether the simulator shows a window.
    """

    scene: Scene
    household: Household
    objects_file: Path | None = None
    robot: str = ROBOT
    eyes: str = EYES
    noise: str = ""
    simulate: bool = True
    gui: bool = False

    @classmethod
    def of(
        cls,
        *,
        scene: str = "all",
        seed: int = 0,
        objects: Path | None = None,
        robot: str = ROBOT,
        eyes: str = EYES,
        noise: str = "",
        simulate: bool = True,
        gui: bool = False,
    ) -> Embodiment:
        """What the options of a command say; wrong ones are refused at once.

        Raises:
            DataError: the scene, the objects or the noise are wrong.
            UnknownNameError: there is no such object, robot or source of vision.
        """
        kinds = load_household(objects, added_to=household()) if objects else household()
        on_table = parse_scene(scene, seed=seed, objects=kinds.objects)
        _refuse_unknown(robot, eyes)
        body = cls(on_table, kinds, objects, robot, eyes, noise, simulate, gui)
        body.errors()  # refuses now what would be refused when the body is made
        return body

    def body(self) -> Body:
        """The simulated body.

        Raises:
            MissingExtraError: the simulator is not installed.
            SimulationError: there is no room for all that is in the scene.
        """
        from ..sim.body import Body

        return Body(
            self.scene,
            self.household.objects,
            seed=self.scene.seed,
            gui=self.gui,
            robot=self.robot,
            vision=self.eyes,
            noise=self.errors(),
        )

    def vision(self, body: Body | None) -> Vision:
        """The eyes of a body, with their errors; without a body those of a perfect detector."""
        eyes = body or PerfectVision(self.scene, self.household.objects)
        errors = self.errors()
        if errors is None:
            return eyes
        from ..sim.vision.noise import NoisyVision

        return NoisyVision(eyes, errors, self.household.objects)

    @property
    def sees_all(self) -> bool:
        """Whether the eyes cannot fail, so that nobody needs to look to know what they see."""
        return not self.noise and (not self.simulate or self.eyes == EYES)

    def errors(self) -> Noise | None:
        """How the eyes fail; None when they do not.

        Raises:
            DataError: the text says something else than expected.
        """
        if not self.noise:
            return None  # saves the import of numpy
        from ..sim.vision.noise import Noise

        return Noise.parse(self.noise, seed=self.scene.seed)

    def as_json(self) -> Json:
        """As an episode keeps it: all that is needed to make the same one again."""
        scene = self.scene
        return {
            "scene": {
                "placements": [asdict(placement) for placement in scene.placements],
                "seed": scene.seed,
                "gap": scene.gap,
            },
            "objects": file_as_json(self.objects_file),
            "robot": self.robot,
            "vision": self.eyes,
            "noise": self.noise,
            "simulated": self.simulate,
        }

    @classmethod
    def from_json(cls, kept: Mapping[str, Any], *, gui: bool = False) -> Embodiment:
        """The same one again.

        Args:
            kept: what `as_json` gave.
            gui: whether the simulator shows a window.

        Raises:
            DataError: the user's own file of objects is not there any more, or was changed.
            UnknownNameError: the robot is not there any more.
        """
        objects = file_from_json(kept["objects"])
        _refuse_unknown(kept["robot"], kept["vision"])
        scene = kept["scene"]
        return cls(
            Scene(tuple(map(_placement, scene["placements"])), scene["seed"], scene["gap"]),
            load_household(objects, added_to=household()) if objects else household(),
            objects,
            kept["robot"],
            kept["vision"],
            kept["noise"],
            kept["simulated"],
            gui,
        )


def _placement(kept: dict[str, Any]) -> Placement:
    placement = Placement(**kept)
    return replace(placement, at=(kept["at"][0], kept["at"][1])) if kept["at"] else placement


def _refuse_unknown(robot: str, eyes: str) -> None:
    if robot != ROBOT:  # the modules that know more of them import numpy
        from ..sim.robot.models import find_robot

        find_robot(robot)
    if eyes != EYES:
        from ..sim.vision import sensors as sources

        sources.refuse_unknown(eyes)
