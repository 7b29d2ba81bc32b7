"""Several processes on one endpoint, and processes killed there: nothing is lost, twice or half.

    python benchmarks/fleet.py tell --processes 8 --sentences 1000
    python benchmarks/fleet.py kill --times 30 --rules 200

`tell` compares one process with several that tell one base sentences at the same time, and once
more while one of them is killed. `kill` kills imports, merges, restores and updates at random times
and looks at what is there afterwards. Both use an Oxigraph server and Virtuoso on the loopback.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the servers of the tests

from hilt.kb.stores import write_lease
from tests.kb import fleet


def tell(server: str, processes: int, sentences: int) -> None:
    """Print what one process and several reach."""
    for count, kill in ((1, False), (processes, False), (processes, True)):
        with fleet.served(server) as location:
            told = fleet.tell_together(location, count, sentences, kill=kill)
            fleet.check_told(location, told)
        number = len(told.acknowledged)
        how = f"{count} process{'es' * (count > 1)}{', one of them killed' * kill}"
        rate = number / told.seconds
        print(f"{server}: {how}: {number} sentences, {rate:.1f} a second; sound", flush=True)


def kill(server: str, times: int, rules: int, seed: int) -> None:
    """Print what is found after the kills of each job."""
    chance = random.Random(seed)  # noqa: S311 - no secret
    # Of those who look afterwards: the killed process renews nothing.
    write_lease.LEASE_S = write_lease.DECIDED_LEASE_S = 1.0
    with tempfile.TemporaryDirectory() as kept, fleet.served(server) as location:
        folder = Path(kept)
        for name, job in fleet.prepare_jobs(folder, rules).items():
            fleet.reset(location, folder)
            _, whole = fleet.kill_job(location, name, job)
            found = Counter[str]()
            for _ in range(times):
                fleet.reset(location, folder)
                found[fleet.kill_job(location, name, job, chance.uniform(0, whole))[0]] += 1
            print(f"{server}: {name}: {dict(found)}", flush=True)


def main() -> None:
    """Run what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("tell", "kill"))
    parser.add_argument("--processes", type=int, default=8)
    parser.add_argument("--sentences", type=int, default=1_000)
    parser.add_argument("--times", type=int, default=30)
    parser.add_argument("--rules", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--server", choices=tuple(fleet.SERVERS), action="append")
    given = parser.parse_args()
    for server in given.server or fleet.SERVERS:
        if given.what == "tell":
            tell(server, given.processes, given.sentences)
        else:
            kill(server, given.times, given.rules, given.seed)


if __name__ == "__main__":
    main()
