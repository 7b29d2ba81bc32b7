# SPDX-License-Identifier: Apache-2.0
"""How well the body grasps: each object by each part, from many random poses.

    python benchmarks/grasping.py --poses 10 --seed 1000
    python benchmarks/grasping.py --poses 2 --crowd               # all objects on the table
    python benchmarks/grasping.py --poses 30 --free               # no part asked for
    python benchmarks/grasping.py --poses 3 --depth-noise-mm 2
    python benchmarks/grasping.py --poses 3 --robot kuka
    python benchmarks/grasping.py --only knife/blade --poses 3 --verbose

An episode builds a scene from its seed, sees, grasps the object by the part, lifts it, holds it for
a second and hands it over. It is `right` when both fingers touched only that part as they closed,
and `ok` when it also was lifted 10 cm or more and held for the second; `first` when the hand had to
close only once for that. Physical contact is all that holds.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from hilt.ontology.objects import ObjectType, load_objects
from hilt.sim.body import Body
from hilt.sim.noise import Noise
from hilt.sim.report import MotionReport
from hilt.sim.scene import graspable, scene_of


@dataclass(frozen=True)
class Episode:
    """What came of one episode."""

    object: str
    part: str
    seed: int
    grasp: MotionReport
    lift: MotionReport | None
    given: MotionReport | None
    cpu_s: float

    @property
    def right(self) -> bool:
        """Whether the fingers closed on the part, and on nothing else."""
        return self.grasp.ok

    @property
    def ok(self) -> bool:
        """Whether it also was lifted and held."""
        return self.lift is not None and self.lift.ok

    @property
    def first(self) -> bool:
        """Whether the hand closed only once."""
        return self.lift is not None and self.lift.ok and self.lift.attempts == 1

    @property
    def reason(self) -> str:
        """Why not, when something went wrong."""
        done = [report for report in (self.grasp, self.lift, self.given) if report is not None]
        failed = [f"{report.action}: {report.reason}" for report in done if not report.ok]
        again = f"closed {done[-1].attempts} times" if done[-1].attempts > 1 else ""
        return ", ".join(each for each in [*failed, again] if each)


def main() -> None:
    """Run what the command line asks for, and print the table."""
    options = _options()
    objects = load_objects()
    episodes: list[Episode] = []
    for name, part in _pairs(objects, options.only, free=options.free):
        for seed in range(options.seed, options.seed + options.poses):
            types = graspable(objects) if options.crowd else (name,)
            episode = run(
                name,
                part,
                seed,
                types=types,
                objects=objects,
                robot=options.robot,
                noise=Noise(depth_m=options.depth_noise_mm / 1e3, seed=seed),
            )
            episodes.append(episode)
            if options.verbose or episode.reason:
                print(_line(episode), flush=True)
    print(_table(episodes))


def run(
    name: str,
    part: str,
    seed: int,
    *,
    types: tuple[str, ...],
    objects: Mapping[str, ObjectType],
    robot: str = "panda",
    noise: Noise | None = None,
) -> Episode:
    """One episode: `name` by `part`, among `types`; an empty part leaves the choice to the hand."""
    started = time.process_time()
    lift = given = None
    scene = scene_of(types, seed=seed, objects=objects)
    with Body(scene, objects, seed=seed, robot=robot, noise=noise) as body:
        percepts = body.search([f"object:{name}"])
        if not percepts:
            unseen = MotionReport("search", ok=False, reason="nothing_seen")
            return Episode(name, part, seed, unseen, None, None, time.process_time() - started)
        grasp = body.grasp(percepts[0], part or None)
        if grasp.ok:
            lift = body.lift()
        if lift is not None and lift.ok:
            given = body.hand_over()
    return Episode(name, part, seed, grasp, lift, given, time.process_time() - started)


def _pairs(
    objects: Mapping[str, ObjectType], only: str, *, free: bool
) -> Iterator[tuple[str, str]]:
    chosen = only.split(",") if only else []
    for name in graspable(objects):
        for part in [""] if free else objects[name].parts:
            if not chosen or name in chosen or f"{name}/{part}" in chosen:
                yield name, part


def _line(episode: Episode) -> str:
    last = episode.lift or episode.grasp
    return (
        f"{episode.object}/{episode.part} seed {episode.seed}: "
        f"{episode.reason or 'ok'}; score {last.score:.2f}, slip {last.slip_m * 1e3:.1f} mm, "
        f"touched {'+'.join(last.touched) or 'nothing'}, {episode.cpu_s:.2f} s"
        + (f", bumped {', '.join(last.bumped)}" if last.bumped else "")
    )


def _table(episodes: list[Episode]) -> str:
    rows = [f"{'object/part':22}{'right':>7}{'first':>7}{'ok':>7}{'given':>7}{'CPU s':>7}"]
    pairs = dict.fromkeys((episode.object, episode.part) for episode in episodes)
    groups = [[e for e in episodes if (e.object, e.part) == pair] for pair in pairs]
    for group, title in [*((g, f"{g[0].object}/{g[0].part}") for g in groups), (episodes, "all")]:
        given = sum(e.given is not None and e.given.ok for e in group)
        rows.append(
            f"{title:22}{sum(e.right for e in group):7}{sum(e.first for e in group):7}"
            f"{sum(e.ok for e in group):7}{given:7}{_mean([e.cpu_s for e in group]):7.2f}"
        )
    slips = sorted(e.lift.slip_m for e in episodes if e.lift is not None and e.lift.ok)
    if slips:
        rows.append(f"slip p95 {slips[int(0.95 * (len(slips) - 1))] * 1e3:.1f} mm")
    bumped = sum(bool((e.lift or e.grasp).bumped) for e in episodes)
    rows.append(f"{len(episodes)} episodes; a neighbour moved in {bumped}")
    touched = Counter(
        f"{e.object} by {'+'.join(e.grasp.touched)}" for e in episodes if e.grasp.ok and not e.part
    )
    rows.extend(f"{what}: {count}" for what, count in sorted(touched.items()))
    return "\n".join(rows)


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Measure grasping.")
    parser.add_argument("--poses", type=int, default=3, help="random poses of each (default 3)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (default 0)")
    parser.add_argument("--only", default="", help="objects or object/parts, comma-separated")
    parser.add_argument("--crowd", action="store_true", help="all objects on the table")
    parser.add_argument("--free", action="store_true", help="do not ask for a part")
    parser.add_argument("--robot", default="panda", help="which one (default panda)")
    parser.add_argument("--depth-noise-mm", type=float, default=0.0, help="of each pixel")
    parser.add_argument("--verbose", action="store_true", help="print each episode")
    return parser.parse_args()


if __name__ == "__main__":
    main()
