"""A Ray cluster of two nodes on this machine, one of which is killed in the middle of a run.

Run it in a network namespace of its own (`unshare --net`), because Ray binds the address of the
machine if there is one. Its arguments are a folder for notes and how many
cases to run. The last line that it prints is what came of the run, as JSON.
"""

import fcntl
import json
import os
import signal
import socket
import struct
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

from evaluation_faults import Squares, notes
from ray._private.node import Node
from ray.cluster_utils import Cluster as Nodes

from hilt.agent.evaluation.runners.runner import make_runner, run_experiment

GET_FLAGS, SET_FLAGS, UP = 0x8913, 0x8914, 0x1  # linux/sockios.h, linux/if.h


def raise_loopback() -> None:
    """Switch on the only interface that a new namespace has."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        asked = struct.pack("16sH14x", b"lo", 0)
        (flags,) = struct.unpack("16xH14x", fcntl.ioctl(sock, GET_FLAGS, asked))
        fcntl.ioctl(sock, SET_FLAGS, struct.pack("16sH14x", b"lo", flags | UP))


def wait_until_both_work(folder: Path) -> None:
    """Wait until each node, which is one process, has begun a few cases and is at one."""
    begun: Counter[str] = Counter()
    while len(begun) < 2 or min(begun.values()) < 3:
        time.sleep(0.01)
        begun = Counter(process for each in notes(folder) for process in each)


def kill_workers(node: Node) -> None:
    """Kill what a node has started: a machine that fails takes everything with it."""
    (raylet,) = node.all_processes["raylet"]
    for status in Path("/proc").glob("[0-9]*/status"):
        with suppress(FileNotFoundError):
            if f"PPid:\t{raylet.process.pid}\n" in status.read_text():
                os.kill(int(status.parent.name), signal.SIGKILL)


def main(folder: Path, count: int) -> None:
    """Run squares on two nodes, kill one when both are at work, and tell what came."""
    raise_loopback()
    nodes = Nodes(initialize_head=True, head_node_args={"num_cpus": 1})
    second = nodes.add_node(num_cpus=1)
    experiment = Squares(folder=str(folder), count=count, each_s=0.2)

    with ThreadPoolExecutor() as pool:
        coming = pool.submit(run_experiment, experiment, runner=make_runner(ray=nodes.address))
        wait_until_both_work(folder)
        kill_workers(second)
        nodes.remove_node(second, allow_graceful=False)
        done = coming.result()

    nodes.shutdown()
    sys.stdout.write(json.dumps([each.result.found for each in done]))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
