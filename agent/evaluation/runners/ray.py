# SPDX-License-Identifier: Apache-2.0
"""A Ray cluster: the workers of several machines, any of which may go.

Hilt must be installed on every node. Ray runs the cases of a lost node again on another; what it
gives up is tried again here, case by case, a few times at most. Short cases travel together, so
that the way does not cost more than they do.
"""

from __future__ import annotations

import os
import socket
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from time import monotonic
from types import ModuleType
from typing import Any

from ....ontology.errors import MissingExtraError, WorkersError
from ..case import Case, Done, line_of
from ..experiment import Experiment
from .base import ATTEMPTS, TIMEOUT_S
from .worker import lost, read_done, run_cases

LOCAL = "local"
CHUNK_S = 0.5  # how long the cases that travel together should take [s]
MAX_CHUNK = 64
CONNECT_S = 10.0  # how long the head may take to answer [s]
LOOK_S = 1.0  # how often nodes and times are looked at [s]


@dataclass
class _Chunk:
    """Cases that travel together; `attempts` counts how often they were given up."""

    cases: Sequence[Case]
    attempts: int = 0
    since: float = field(default_factory=monotonic)


class Cluster:
    """Runs cases on a Ray cluster.

    Args:
        address: of its head, "auto", or "local" for a cluster of our own.
        workers: how many cases run at once at most; None is as many as it has processors.
        timeout_s: how long a case may take before it is stopped [s].
        attempts: how often a case is begun that Ray gives up.

    Raises:
        MissingExtraError: Ray is not installed.
    """

    def __init__(
        self,
        address: str,
        workers: int | None = None,
        *,
        timeout_s: float = TIMEOUT_S,
        attempts: int = ATTEMPTS,
    ) -> None:
        self.address = address
        self.workers = workers
        self.timeout_s = timeout_s
        self.attempts = attempts
        self._ray = _import_ray()

    def run(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[Done]:
        """Run the cases on the cluster.

        Raises:
            WorkersError: the cluster cannot be reached.
        """
        with self._joined():
            yield from _Run(self, self._ray, experiment, cases).results()

    @contextmanager
    def _joined(self) -> Generator[None]:
        own = self.address == LOCAL
        try:
            _knock(self.address)
            self._ray.init(
                address=None if own else self.address,
                num_cpus=self.workers if own else None,
                include_dashboard=False if own else None,
                log_to_driver=False,
                logging_level="ERROR",
            )
        except (OSError, RuntimeError, ValueError) as error:
            raise WorkersError(f'No Ray cluster at "{self.address}": {error}') from error
        try:
            yield
        finally:
            self._ray.shutdown()


class _Run:
    """What waits and what is under way in one run."""

    def __init__(
        self, cluster: Cluster, ray: ModuleType, experiment: Experiment, cases: Sequence[Case]
    ) -> None:
        self._cluster, self._ray = cluster, ray
        self._name, self._options = experiment.name, line_of(experiment.options)
        self._remote = ray.remote(run_cases).options(max_retries=cluster.attempts - 1)
        self._waiting = deque(cases)
        self._again: deque[_Chunk] = deque()
        self._under_way: dict[Any, _Chunk] = {}
        self._spent_s, self._count = 0.0, 0
        self._places, self._looked = 1, float("-inf")

    def results(self) -> Iterator[Done]:
        """Every case once, as they become ready."""
        while self._waiting or self._again or self._under_way:
            self._send()
            ready, _ = self._ray.wait([*self._under_way], num_returns=1, timeout=LOOK_S)
            for reference in ready:
                yield from self._received(reference, self._under_way.pop(reference))
            self._stop_late()

    def _send(self) -> None:
        if monotonic() - self._looked > LOOK_S:
            self._places, self._looked = self._room(), monotonic()
        while len(self._under_way) < self._places and (self._waiting or self._again):
            chunk = self._again.popleft() if self._again else _Chunk(self._next_cases())
            chunk.since = monotonic()
            lines = [line_of(case.as_json()) for case in chunk.cases]
            self._under_way[self._remote.remote(self._name, self._options, lines)] = chunk

    def _room(self) -> int:
        """How many cases may be under way: nodes come and go."""
        places = int(self._ray.cluster_resources().get("CPU", 1)) or 1
        return min(places, self._cluster.workers or places)

    def _next_cases(self) -> list[Case]:
        """As many as take `CHUNK_S`, so far as is known; few at the end, so that none waits."""
        each_s = self._spent_s / self._count if self._count else CHUNK_S
        fair = len(self._waiting) // (2 * self._places)
        size = max(1, min(int(CHUNK_S / max(each_s, 1e-6)), fair, MAX_CHUNK))
        return [self._waiting.popleft() for _ in range(min(size, len(self._waiting)))]

    def _received(self, reference: object, chunk: _Chunk) -> Iterator[Done]:
        try:
            lines: list[str] = self._ray.get(reference)
        except self._ray.exceptions.RayError as error:
            yield from self._given_up(chunk, type(error).__name__)
            return
        self._spent_s += monotonic() - chunk.since
        self._count += len(lines)
        yield from (read_done(line, chunk.attempts + 1) for line in lines)

    def _given_up(self, chunk: _Chunk, why: str) -> Iterator[Done]:
        """Try again alone what was lost together: one case may be the reason for all."""
        if len(chunk.cases) > 1:
            self._again.extend(_Chunk([case]) for case in chunk.cases)
        elif chunk.attempts + 1 < self._cluster.attempts:
            self._again.append(_Chunk(chunk.cases, chunk.attempts + 1))
        else:
            yield lost(chunk.cases[0], f"{why}, {chunk.attempts + 1} times", chunk.attempts + 1)

    def _stop_late(self) -> None:
        for reference, chunk in self._under_way.items():
            if monotonic() - chunk.since > self._cluster.timeout_s * len(chunk.cases):
                self._ray.cancel(reference, force=True)  # and `wait` then gives it as an error
                chunk.since = float("inf")


def _knock(address: str) -> None:
    """See that somebody answers at an address; Ray would go on asking for minutes.

    Raises:
        OSError, ValueError: nobody does, or it is no address.
    """
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    if colon:
        socket.create_connection((host, int(port)), CONNECT_S).close()


def _import_ray() -> ModuleType:
    # Ray tells its makers who uses it, unless told not to; and reads that when it is imported.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        return import_module("ray")
    except ImportError as error:
        raise MissingExtraError("cluster", "ray") from error
