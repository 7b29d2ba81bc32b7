"""Measure how deep a nail is driven with a hammer, and with other tools.

    python benchmarks/pounding.py --runs 40 --seed 1000
    python benchmarks/pounding.py --runs 5 --tools shoe/upper

A run puts a tool and a nail in its block on the table, takes the tool by the part, lifts it, brings
a face of it above the nail, and strikes until the nail is in or `MOST_BLOWS` are done. The nail is
held by friction alone and driven by contact alone; its depth is what the blows added.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import process_time

from hilt.ontology.objects import ObjectType, load_objects
from hilt.sim.body import Body
from hilt.sim.scene.scene import parse_scene

MOST_BLOWS = 12  # a nail that is not in by then does not go in
DEEP_ENOUGH = 0.010  # [m]


@dataclass(frozen=True)
class Run:
    """The result of one run.

    Attributes:
        seed: of the scene.
        depth_m: how deep the nail went [m].
        blows: number of blows.
        trouble: the failure that ended it early; empty when there was none.
        cpu_s: processor time [s].
    """

    seed: int
    depth_m: float
    blows: int
    trouble: str
    cpu_s: float


def main() -> None:
    """Run the tools and seeds of the command line, and print the table."""
    parser = argparse.ArgumentParser(description="Measure pounding.")
    parser.add_argument("--runs", type=int, default=40, help="with each tool (default 40)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (default 0)")
    parser.add_argument("--tools", default="hammer/handle,shoe/upper", help="object/part, ...")
    options = parser.parse_args()
    objects = load_objects()
    rows = [
        "| tool | runs | 10 mm or deeper | mean depth | least | blows | CPU s | troubles |",
        "|---" * 8 + "|",
    ]
    for title in options.tools.split(","):
        tool, _, part = title.partition("/")
        seeds = range(options.seed, options.seed + options.runs)
        rows.append(_row(title, [pound(tool, part, seed, objects=objects) for seed in seeds]))
    print("\n".join(rows))


def pound(tool: str, part: str, seed: int, *, objects: Mapping[str, ObjectType]) -> Run:
    """Return the result of one run with a tool that is held by a part."""
    started = process_time()
    scene = parse_scene(f"objects:{tool},nail", seed=seed, objects=objects)
    with Body(scene, objects, seed=seed) as body:
        before = body.world.depth("nail")
        trouble, blows = _strike(body, tool, part)
        depth = body.world.depth("nail") - before
    return Run(seed, depth, blows, trouble, process_time() - started)


def _strike(body: Body, tool: str, part: str) -> tuple[str, int]:
    """Grasp the tool and strike; return the failure, if any, and the number of blows."""
    report = body.grasp(body.search([f"object:{tool}"])[0], part)
    if report.ok:
        report = body.lift()
    if report.ok:
        report = body.move_above(body.search(["object:nail"])[0])
    for blow in range(MOST_BLOWS):
        if not report.ok or report.driven:
            return f"{report.action}: {report.reason}" if not report.ok else "", blow
        report = body.raise_()
        if report.ok:
            report = body.lower()
    return "" if report.driven else "not in after all blows", MOST_BLOWS


def _row(title: str, runs: Sequence[Run]) -> str:
    deep = sum(run.depth_m >= DEEP_ENOUGH for run in runs)
    depths_mm = [run.depth_m * 1e3 for run in runs]
    troubles = Counter(run.trouble for run in runs if run.trouble)
    told = "; ".join(f"{count} x {what}" for what, count in troubles.items())
    return (
        f"| {title} | {len(runs)} | {deep} = {100 * deep / len(runs):.1f} % "
        f"| {sum(depths_mm) / len(runs):.1f} mm | {min(depths_mm):.1f} mm "
        f"| {sum(run.blows for run in runs) / len(runs):.1f} "
        f"| {sum(run.cpu_s for run in runs) / len(runs):.2f} | {told} |"
    )


if __name__ == "__main__":
    main()
