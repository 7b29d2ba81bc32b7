"""Measure grasping: each object by each part, from many random poses.

    python benchmarks/grasping.py                                   # all of it, from a fresh seed
    python benchmarks/grasping.py --seed 1000 --poses 1             # a slice of all of it
    python benchmarks/grasping.py --settings alone,eight --poses 4
    python benchmarks/grasping.py --settings alone --only knife/blade,mug --verbose
    python benchmarks/grasping.py --settings noise --vision learned

An episode builds a scene from its seed, detects the object, grasps it by the part, lifts it, holds
it for a second and hands it over; it is held by physical contact only. Where there are two of a
type, the one that is seen best is taken. The settings:

    alone       the object alone on the table
    eight       all eight objects, 2 cm apart or more
    twelve      the eight and four doubles
    heap        all eight, dropped onto one place one after the other
    recoloured  alone, with a random colour of each part, seen by the learned eyes (masks have none)
    noise       alone, with 5 mm of noise (standard deviation) in the depth of each pixel
    learned     alone, seen by the learned eyes
    meshes      four objects of mesh files (`scanned_meshes.py`), each alone
    free        alone, the hand chooses the part
    kuka        alone, with another arm

The table counts: `right part`, closings of both fingers that touched only that part; `held`,
objects lifted by 10 cm or more and held for a second after up to three closings, `first` of these
after one; `judged`, lifts that the robot, by sight and touch, judges as they were; `given`, objects
handed over and still held then; `facing`, those of them whose free part
leads from the grip towards the receiver, within 45 degrees of the level direction. This is taken
from the poses in the world; objects whose free part is less than 1 cm aside of the grip, such as
upright glasses, have no such direction and do not count. `taken`, of those handed over, those that
the receiver had after pulling at them, when the hand had felt it and opened. `tries` is the mean
number of closings, `put aside` that of neighbours that were in the way; `bumped` are other
neighbours that moved by a centimetre or more; `hits` are episodes in which another link
of the robot than its fingers touched anything but an object of the type to be grasped, and `palm`
those in which it touched one of these.
Processor time is that of a whole episode, from building the world (heaps are there before) to the
handover, in a process that has run one before, without what watching for hits takes. For
comparison, the same number of steps is timed with a robot that stands still in the same scene.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Collection, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from secrets import randbelow
from tempfile import TemporaryDirectory
from time import process_time
from unittest.mock import patch
from zlib import crc32

import numpy as np
from grasping_scenes import heap, recoloured, scene_of
from grasping_tables import Episode, contrast_table, pair_table, summary_table, time_table
from grasping_truth import GroundTruth, Lift
from scanned_meshes import scanned_objects
from stopwatch import Stopwatch
from trimesh.convex import convex_hull

from hilt.ontology.objects import ObjectType, load_objects
from hilt.sim import poses
from hilt.sim.body import Body
from hilt.sim.manipulation.hand_motions import AHEAD
from hilt.sim.manipulation.motion_report import MotionReport
from hilt.sim.models.object_models import object_model
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.robot import MIN_FORCE, NAME, Robot
from hilt.sim.scene.scene import Scene, graspable
from hilt.sim.scene.world import World
from hilt.sim.vision.perception_noise import NoiseLevels

MIN_ASIDE = 0.01  # [m] from the grip to the free part, level, else it has no direction
SEEDS = 900_000  # a fresh seed is below


@dataclass(frozen=True)
class Setting:
    """The conditions of an episode.

    Attributes:
        poses: number of random poses of each object and part.
        table: what is on the table: "alone", "eight", "twelve" or "heap".
        vision: where percepts come from.
        recoloured: whether the object has other colours.
        meshes: whether the objects are those of mesh files.
        free: whether the hand may choose the part.
        depth_m: standard deviation of the depth of each pixel [m].
        robot: name of the robot.
    """

    poses: int
    table: str = "alone"
    vision: str = "mask"
    recoloured: bool = False
    meshes: bool = False
    free: bool = False
    depth_m: float = 0.0
    robot: str = "panda"


SETTINGS = {
    "alone": Setting(30),
    "eight": Setting(8, "eight"),
    "twelve": Setting(4, "twelve"),
    "heap": Setting(2, "heap"),
    "recoloured": Setting(8, vision="learned", recoloured=True),
    "noise": Setting(8, depth_m=0.005),
    "learned": Setting(8, vision="learned"),
    "meshes": Setting(8, meshes=True),
    "free": Setting(15, free=True),
    "kuka": Setting(3, robot="kuka"),
}


def main() -> None:
    """Run the settings of the command line, and print the tables."""
    options = _options()
    print(f"Seeds from {options.seed} (`--seed {options.seed}`).\n", flush=True)
    measured = {title: _measure(title, options) for title in options.settings.split(",")}
    print(summary_table(measured))
    for title, episodes in measured.items():
        print(f"\n## {title}\n\n{pair_table(episodes)}")
        if SETTINGS[title].free:
            print(f"\n{contrast_table(episodes)}")
    print(f"\n## Processor time\n\n{time_table(measured)}")


def _measure(title: str, options: argparse.Namespace) -> list[Episode]:
    setting, episodes = SETTINGS[title], list[Episode]()
    if options.vision:
        setting = replace(setting, vision=options.vision)
    household = load_objects()
    objects = scanned_objects(household) if setting.meshes else household
    run(SETTINGS["alone"], "knife", "blade", options.seed, objects=household)  # warms up
    for name, part in _pairs(objects, options.only, free=setting.free):
        for seed in range(options.seed, options.seed + (options.poses or setting.poses)):
            bare = seed == options.seed
            episode = run(setting, name, part, seed, objects={**household, **objects}, bare=bare)
            episodes.append(episode)
            if options.verbose or episode.trouble:
                print(f"{title}: {episode}", file=sys.stderr, flush=True)
    return episodes


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
    with ExitStack() as stack:
        if setting.recoloured:
            # Models of random colours are of no use to anyone later.
            own_cache = {"HILT_CACHE": stack.enter_context(TemporaryDirectory())}
            stack.enter_context(patch.dict(os.environ, own_cache))
            objects = {**objects, name: recoloured(objects[name], seed=seed)}
        scene = scene_of(setting.table, name, seed=seed, objects=objects)
        for kind in scene.types:
            object_model(objects[kind])  # made before the clock starts
        own = crc32(f"{name}/{part}".encode())  # a heap for each object and part
        piled = heap(scene, objects, number=own) if setting.table == "heap" else {}
        return _timed(setting, scene, name, part, objects=objects, piled=piled, bare=bare)


def _timed(
    setting: Setting,
    scene: Scene,
    name: str,
    part: str,
    *,
    objects: Mapping[str, ObjectType],
    piled: Mapping[str, poses.Array],
    bare: bool,
) -> Episode:
    noise, seed = NoiseLevels(depth_m=setting.depth_m, seed=scene.seed), scene.seed
    options = {"robot": setting.robot, "vision": setting.vision, "noise": noise}
    started = process_time()
    with Stopwatch() as watch, Body(scene, objects, seed=seed, **options) as body:
        _pile(body.world, piled)
        hits, watching_s = _watch_links(body)
        body.movable = lambda _: (None,)  # anything in the way, by any part
        allowed = (part,) if part else tuple(objects[name].parts)
        truth = GroundTruth(body, name, allowed)
        reports, lift = _reports(body, truth, name, part or None)
        steps, facing_deg, taken = body.world.engine.steps, None, False
        watch.seconds["stepping"] -= sum(watching_s)
        cpu_s = process_time() - started - sum(watching_s)
        put_aside = [kind for report in reports for kind in report.moved]
        bumped = truth.bumped(put_aside)
        if reports[-1].action == "hand_over" and reports[-1].ok:
            facing_deg, taken = _facing_deg(body, truth.lift().touched), truth.release()
    shares = {**watch.seconds, "other": cpu_s - sum(watch.seconds.values())}
    bare_s = _bare_s(setting, scene, objects, piled, steps) if bare else None
    seen = (lift, lift is not None and lift.is_good(allowed), truth.closed, truth.wrong, bumped)
    rest = (facing_deg, taken, tuple(sorted(hits)), cpu_s, shares, steps, bare_s)
    return Episode(name, part, seed, reports, *seen, *rest)


def _watch_links(body: Body) -> tuple[set[tuple[str, str]], list[float]]:
    """Return what gathers, from now on, links but the fingers and the types they touch.

    With it comes the processor time that this takes, which is not the robot's.
    """
    contacts, arm, fingers = body.world.engine.bodies.contacts, body.robot.chain.links, ()
    if body.robot.kind.gripper:
        fingers = body.robot.gripper.links
    hits, kinds, spent_s = set[tuple[str, str]](), body.world.kinds, list[float]()

    def look() -> None:
        started = process_time()
        if len(contacts(NAME)) > sum(len(contacts(NAME, finger)) for finger in fingers):
            for link in arm:
                found = (each for each in contacts(NAME, link) if each.force > MIN_FORCE)
                hits.update(
                    (link, kinds[c.other].name if c.other in kinds else c.other) for c in found
                )
        spent_s.append(process_time() - started)

    body.world.engine.watchers.append(look)
    return hits, spent_s


def _pile(world: World, piled: Mapping[str, poses.Array]) -> None:
    for name, world_from_object in piled.items():
        world.engine.bodies.place(name, world_from_object)
    if piled:
        world.settle()
        world.let_sleep()


def _bare_s(
    setting: Setting,
    scene: Scene,
    objects: Mapping[str, ObjectType],
    piled: Mapping[str, poses.Array],
    steps: int,
) -> float:
    with World.build(scene, objects) as world:
        _pile(world, piled)
        Robot(world.engine, find_robot(setting.robot))
        started = process_time()
        world.engine.step(steps)
        return process_time() - started


def _reports(
    body: Body, truth: GroundTruth, name: str, part: str | None
) -> tuple[tuple[MotionReport, ...], Lift | None]:
    """Return the reports of grasp, lift and hand-over, up to a failure, and the lift itself."""
    percepts = body.search([f"object:{name}"])
    if not percepts:
        return (MotionReport("grasp", ok=False, reason="nothing_seen"),), None
    reports = [body.grasp(percepts[0], part)]
    if not reports[0].ok:
        return tuple(reports), None
    reports.append(body.lift())
    lift = truth.lift()
    if reports[-1].ok:
        reports.append(body.hand_over())
    return tuple(reports), lift


def _facing_deg(body: Body, touched: Collection[str]) -> float | None:
    """Return the level angle from the free part of the held object to the receiver [deg].

    The free part is what the fingers have not `touched`. None where there is none, or it is not
    aside.
    """
    name = body.holding or ""
    corners = body.world.models[body.world.kinds[name].name].corners
    free = [points for part, points in corners.items() if part not in touched]
    if not free:
        return None
    middle = convex_hull(np.vstack(free)).centroid
    at = poses.transform(body.world.pose(name), middle[None])[0] - body.robot.world_from_grip[:3, 3]
    aside = float(np.hypot(at[0], at[1]))
    return float(np.degrees(np.arccos(at @ AHEAD / aside))) if aside > MIN_ASIDE else None


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
    parser.add_argument("--seed", type=int, default=randbelow(SEEDS), help="the first (fresh)")
    parser.add_argument("--settings", default=",".join(SETTINGS), help="of " + ", ".join(SETTINGS))
    parser.add_argument("--vision", default="", help='"mask", "learned" or "learned:FILE" for all')
    parser.add_argument("--only", default="", help="objects or object/parts, comma-separated")
    parser.add_argument("--verbose", action="store_true", help="print each episode")
    return parser.parse_args()


if __name__ == "__main__":
    main()
