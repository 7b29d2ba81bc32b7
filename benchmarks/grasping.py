"""Measure grasping: each object by each part, from many random poses.

    python benchmarks/grasping.py --seed 1000                       # all of it: about 900 episodes
    python benchmarks/grasping.py --seed 1000 --poses 1             # a slice of all of it
    python benchmarks/grasping.py --settings alone,crowd --poses 4
    python benchmarks/grasping.py --settings alone --only knife/blade,mug --verbose

An episode builds a scene from its seed, detects the object, grasps it by the part, lifts it, holds
it for a second and hands it over; it is held by physical contact only. The tables count: `right`,
closings of both fingers that touched only that part; `first`, objects lifted by 10 cm or more and
held for a second after one closing; `ok`, the same after up to three closings; `given`, objects
handed over and still held then. Processor time is that of a whole episode, from building the world
to the last step, in a process that has run one before. For comparison, the same number of steps is
timed with a robot that stands still in the same scene.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from time import process_time

from grasping_tables import Episode, contrast_table, pair_table, summary_table, time_table
from stopwatch import Stopwatch

from hilt.ontology.objects import ObjectType, load_objects
from hilt.sim.body import Body
from hilt.sim.manipulation.motion_report import MotionReport
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.robot import Robot
from hilt.sim.scene.scene import graspable, scene_with
from hilt.sim.scene.world import World
from hilt.sim.vision.perception_noise import NoiseLevels


@dataclass(frozen=True)
class Setting:
    """The conditions of an episode.

    Attributes:
        poses: number of random poses of each object and part.
        crowd: whether all objects are on the table.
        free: whether the hand may choose the part.
        depth_m: standard deviation of the depth of each pixel [m].
        robot: name of the robot.
    """

    poses: int
    crowd: bool = False
    free: bool = False
    depth_m: float = 0.0
    robot: str = "panda"


SETTINGS = {
    "alone": Setting(30),
    "crowd": Setting(8, crowd=True),
    "noise": Setting(5, depth_m=0.002),
    "free": Setting(15, free=True),
    "kuka": Setting(3, robot="kuka"),
}


def main() -> None:
    """Run the settings of the command line, and print the tables."""
    options = _options()
    objects = load_objects()
    run(SETTINGS["alone"], "knife", "blade", options.seed, objects=objects)  # warms the process up
    measured = dict[str, list[Episode]]()
    for title in options.settings.split(","):
        setting, episodes = SETTINGS[title], list[Episode]()
        for name, part in _pairs(objects, options.only, free=setting.free):
            for seed in range(options.seed, options.seed + (options.poses or setting.poses)):
                bare = seed == options.seed
                episode = run(setting, name, part, seed, objects=objects, bare=bare)
                episodes.append(episode)
                if options.verbose or episode.trouble:
                    print(f"{title}: {episode}", file=sys.stderr, flush=True)
        measured[title] = episodes
        print(f"## {title}\n\n{pair_table(episodes)}\n", flush=True)
    print(f"## together\n\n{summary_table(measured)}\n\n{time_table(measured)}")
    if "free" in measured:
        print(f"\n{contrast_table(measured['free'])}")


def run(
    setting: Setting,
    name: str,
    part: str,
    seed: int,
    *,
    objects: Mapping[str, ObjectType],
    bare: bool = False,
) -> Episode:
    """Return one episode of grasping `name` by `part`; an empty part leaves the choice to the hand.

    Args:
        setting: the conditions.
        name: of the object.
        part: of it.
        seed: of the scene and of all choices.
        objects: the types there are.
        bare: whether to time bare stepping as well.
    """
    scene = scene_with(graspable(objects) if setting.crowd else (name,), seed=seed, objects=objects)
    noise = NoiseLevels(depth_m=setting.depth_m, seed=seed)
    started = process_time()
    with (
        Stopwatch() as watch,
        Body(scene, objects, seed=seed, robot=setting.robot, noise=noise) as body,
    ):
        reports = _reports(body, name, part or None)
        steps = body.world.engine.steps
    cpu_s = process_time() - started
    shares = {**watch.seconds, "other": cpu_s - sum(watch.seconds.values())}
    bare_s = None
    if bare:
        with World.build(scene, objects) as world:
            Robot(world.engine, find_robot(setting.robot))
            started = process_time()
            world.engine.step(steps)
            bare_s = process_time() - started
    return Episode(name, part, seed, reports, cpu_s, shares, steps, bare_s)


def _reports(body: Body, name: str, part: str | None) -> tuple[MotionReport, ...]:
    """Return the reports of grasp, lift and hand-over, up to the first that failed."""
    percepts = body.search([f"object:{name}"])
    if not percepts:
        return (MotionReport("grasp", ok=False, reason="nothing_seen"),)
    reports = [body.grasp(percepts[0], part)]
    for act in (body.lift, body.hand_over):
        if reports[-1].ok:
            reports.append(act())
    return tuple(reports)


def _pairs(
    objects: Mapping[str, ObjectType], only: str, *, free: bool
) -> Iterator[tuple[str, str]]:
    chosen = only.split(",") if only else []
    for name in graspable(objects):
        for part in [""] if free else objects[name].parts:
            if not chosen or name in chosen or f"{name}/{part}" in chosen:
                yield name, part


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Measure grasping.")
    parser.add_argument("--poses", type=int, default=0, help="of each (default: the full measure)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (default 0)")
    parser.add_argument("--settings", default=",".join(SETTINGS), help="of " + ", ".join(SETTINGS))
    parser.add_argument("--only", default="", help="objects or object/parts, comma-separated")
    parser.add_argument("--verbose", action="store_true", help="print each episode")
    return parser.parse_args()


if __name__ == "__main__":
    main()
