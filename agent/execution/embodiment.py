"""The embodiment of an agent: its scene, its robot, and how reliably it perceives.

An `Embodiment` is what an `AgentConfig` says about the robot once all names in it are resolved; it
makes the simulated body and the vision of the agent.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ...ontology.errors import DataError, check_simulator
from ...ontology.objects import Household
from ...ontology.plugins import call_plugin, plugin_names
from ...sim.scene.scene import Scene, parse_scene
from ..config import AgentConfig, household, is_plugin
from ..protocols import Motion, Vision
from .perception import PerfectVision

if TYPE_CHECKING:
    from ...sim.body import Body
    from ...sim.robot.interruption import Interruption
    from ...sim.vision.perception_noise import NoiseLevels

_DEFAULTS = AgentConfig()
ROBOT_OPTIONS = ("robot", "vision", "noise", "simulate")  # of a configuration, without the window


@dataclass(frozen=True)
class Embodiment:
    """A scene, a robot and its vision."""

    scene: Scene  #: what is on the table; its seed is that of everything random
    household: Household
    objects_file: Path | None = None  #: the user's own file among them, if any
    #: its name, or a file of robots and the name in it; see `find_robot`
    robot: str = _DEFAULTS.robot
    #: the source of percepts: "mask", "learned", "learned:FILE", or a plug-in
    vision: str = _DEFAULTS.vision
    #: how perception fails, as text ("missed=0.1,confused=0.05"); empty for not at all
    noise: str = _DEFAULTS.noise
    #: whether there is a simulated body; without one all is seen with certainty
    simulate: bool = True
    gui: bool = False

    def __post_init__(self) -> None:
        # The modules that know the other names import numpy.
        if self.robot != _DEFAULTS.robot:
            from ...sim.robot.models import find_robot

            find_robot(self.robot)
        if self.vision != _DEFAULTS.vision and not is_plugin(self.vision):
            from ...sim.body import check_vision

            check_vision(self.vision)
        self.noise_model()

    @classmethod
    def from_config(cls, config: AgentConfig) -> "Embodiment":
        """Return the embodiment that a configuration names.

        DataError for a wrong scene, objects file or noise; UnknownNameError for any unknown name.
        """
        kinds = household(config.objects)
        scene = parse_scene(config.scene, seed=config.seed, objects=kinds.objects)
        robot = {name: getattr(config, name) for name in ROBOT_OPTIONS}
        return cls(scene, kinds, config.objects, gui=config.gui, **robot)

    def open_body(self, interruption: "Interruption | None" = None) -> "Body":
        """Return a new simulated body, whose motions can be interrupted.

        MissingExtraError without the simulator; SimulationError if there is no room for the scene.
        """
        check_simulator()
        from ...sim.body import Body

        return Body(
            self.scene,
            self.household.objects,
            seed=self.scene.seed,
            gui=self.gui,
            robot=self.robot,
            vision=self.vision,
            noise=self.noise_model(),
            interruption=interruption,
        )

    def open_plugins(self, motion: str) -> tuple[Vision | None, Motion | None]:
        """Return vision and motion where plug-ins make them; a motion by its name, "" for none.

        UnknownNameError if there is no such plug-in; PluginError if one cannot be used; DataError
        if there is a motion, but no vision that goes with it.
        """
        if not is_plugin(self.vision):
            if motion:
                known = ", ".join(plugin_names("hilt.vision")) or "none"
                problem = f"a motion needs a vision that is a plug-in too. Known: {known}."
                raise DataError(problem, source="--motion")
            return None, None
        sees = call_plugin("hilt.vision", self.vision, self, methods=("search",))
        needs = ("abilities", "grasp", "lift")
        return sees, call_plugin("hilt.motion", motion, self, methods=needs) if motion else None

    def open_vision(self, body: "Body | None") -> Vision:
        """Return the vision of a body, or perfect vision without one; noise included."""
        vision = body or PerfectVision(self.scene, self.household.objects)
        if (noise := self.noise_model()) is None:
            return vision
        from ...sim.vision.perception_noise import NoisyDetector

        return NoisyDetector(vision.search, noise, self.household.objects)

    @property
    def sees_all(self) -> bool:
        """Whether perception cannot fail, so that the scene itself says what is in view."""
        return not self.noise and (not self.simulate or self.vision == _DEFAULTS.vision)

    def noise_model(self) -> "NoiseLevels | None":
        """Return how perception fails, None if it does not; DataError if the text is wrong."""
        if not self.noise:
            return None  # saves the import of numpy
        from ...sim.vision.perception_noise import NoiseLevels

        return NoiseLevels.parse(self.noise, seed=self.scene.seed)
