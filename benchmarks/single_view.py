"""Measure grasps on point clouds of one camera: each object by each part, from random poses.

    python benchmarks/single_view.py --seed 41000 --poses 8

An episode takes one image with one of the four cameras, in turn, plans grasps on its cloud
(`grasps_on_cloud`), and lets the simulated hand close on the best of them to which there is a path.
The table counts: `planned`, clouds with a grasp; `closed`, those with a path to one; `right`,
closings in which the fingers touched only the part; `lifted`, objects that were lifted by 10 cm or
more and held for a second after this one closing.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Mapping
from time import process_time

import numpy as np
from grasping_truth import finger_contacts

from hilt.ontology.objects import ObjectType, load_objects
from hilt.sim import Body, grasps_on_cloud, poses
from hilt.sim.manipulation.hand_motions import LIFT_PACE, HandMotion
from hilt.sim.manipulation.pick_and_place import HOLD_TIME, MIN_LIFT
from hilt.sim.physics.engine import TIME_STEP
from hilt.sim.robot.path_planner import PathPlanner
from hilt.sim.scene.scene import graspable, scene_with
from hilt.sim.vision.camera import CAMERAS_ROUND_TABLE, Camera
from hilt.sim.vision.object_detector import MaskDetector


def main() -> None:
    """Run all episodes, and print a row for each part."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=0, help="of the first pose")
    parser.add_argument("--poses", type=int, default=8, help="of each object and part")
    options = parser.parse_args()
    objects, total = load_objects(), Counter[str]()
    print("| part | clouds | planned | closed | right | lifted |\n|---|---|---|---|---|---|")
    for name in graspable(objects):
        for part in objects[name].parts:
            counts = Counter[str]()
            for number in range(options.poses):
                camera = CAMERAS_ROUND_TABLE[number % len(CAMERAS_ROUND_TABLE)]
                counts.update(run(name, part, options.seed + number, camera, objects))
            print(_row(f"{name}, {part}", counts), flush=True)
            total += counts
    print(_row("together", total))
    print(f"\nPlanning took {total['ms'] / total['clouds']:.0f} ms of processor time a cloud.")


def run(
    name: str, part: str, seed: int, camera: Camera, objects: Mapping[str, ObjectType]
) -> dict[str, int]:
    """Return how far one episode came, a 1 for each stage, and the time of planning [ms]."""
    scene = scene_with((name,), seed=seed, objects=objects)
    with Body(scene, objects, seed=seed) as body:
        image = camera.capture(body.world.engine)
        shown = image.mask(name)
        seen, labels = image.points(shown), [image.names[n][1] for n in image.labels[shown]]
        if labels.count(part) < 20:
            return {"clouds": 0}
        points = poses.transform(poses.inverse(camera.world_from_camera), seen)
        started = process_time()
        plan = grasps_on_cloud(
            points, labels=labels, part=part, base_from_camera=camera.world_from_camera, table=0.0
        )
        counts = {"clouds": 1, "ms": round(1000 * (process_time() - started))}
        planner = PathPlanner(body.robot, seen, np.zeros((0, 3)))
        path = next(planner.grasp_paths(plan.grasps), None)
        if path is None:
            return counts | {"planned": int(bool(plan.grasps))}
        before = body.world.pose(name)[2, 3]
        HandMotion(body.robot, MaskDetector(body.world)).grasp(path, force=body.robot.gripper.force)
        touched = frozenset().union(*finger_contacts(body.robot))
        body.robot.follow(path.lift, pace=LIFT_PACE)
        body.robot.advance(round(HOLD_TIME / TIME_STEP))
        lifted = body.world.pose(name)[2, 3] - before > MIN_LIFT
        right = touched == {(name, part)}
        return counts | {"planned": 1, "closed": 1, "right": int(right), "lifted": int(lifted)}


def _row(title: str, counts: Counter[str]) -> str:
    numbers = (counts[key] for key in ("clouds", "planned", "closed", "right", "lifted"))
    return f"| {title} | {' | '.join(map(str, numbers))} |"


if __name__ == "__main__":
    main()
