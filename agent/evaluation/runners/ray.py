"""Runner on a Ray cluster, whose nodes may fail.

Hilt must be installed on every node. Ray runs the cases of a failed node again on another one;
cases that Ray gives up are retried one by one. Short cases are sent in chunks to reduce overhead.
"""

from __future__ import annotations

import os
import socket
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from ....ontology.errors import WorkersUnavailableError, extra_required
from ..case import Case, TimedResult, to_json_line
from ..experiment import Experiment
from .base import ATTEMPTS, TIMEOUT_S, lost_case, parse_case_run, run_cases

LOCAL = "local"
CHUNK_S = 0.5  # desired duration of a chunk of cases [s]
MAX_CHUNK = 64
CONNECT_S = 10.0  # how long the head node may take to answer [s]
POLL_S = 1.0  # interval at which nodes and timeouts are checked [s]


@dataclass
class _Chunk:
    """Cases that are sent together; `attempts` counts how often Ray gave them up."""

    cases: Sequence[Case]
    attempts: int = 0
    since: float = field(default_factory=monotonic)


class RayRunner:
    """Runs cases on a Ray cluster.

    Args:
        address: the address of its head node, "auto", or "local" to start a cluster.
        workers: maximum number of cases at the same time; None is the number of processors.
        timeout_s: how long a case may take before it is stopped [s].
        attempts: how often a case is started that Ray gives up.

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
        self.address, self.workers = address, workers
        self.timeout_s, self.attempts = timeout_s, attempts
        self._ray = _import_ray()

    def run(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[TimedResult]:
        """Run the cases on the cluster.

        Raises:
            WorkersError: the cluster cannot be reached.
        """
        with self._connected():
            yield from _Run(self, self._ray, experiment, cases).results()

    @contextmanager
    def _connected(self) -> Generator[None]:
        own = self.address == LOCAL
        try:
            _check_address(self.address)
            self._ray.init(
                address=None if own else self.address,
                num_cpus=self.workers if own else None,
                include_dashboard=False if own else None,
                log_to_driver=False,
                logging_level="ERROR",
            )
        except (OSError, RuntimeError, ValueError) as error:
            raise WorkersUnavailableError(f'No Ray cluster at "{self.address}": {error}') from error
        try:
            yield
        finally:
            self._ray.shutdown()


class _Run:
    """The waiting and the running cases of one run."""

    def __init__(
        self, cluster: RayRunner, ray: Any, experiment: Experiment, cases: Sequence[Case]
    ) -> None:
        self._cluster, self._ray = cluster, ray
        self._name, self._options = experiment.name, to_json_line(experiment.options)
        self._remote = ray.remote(run_cases).options(max_retries=cluster.attempts - 1)
        self._waiting = deque(cases)
        self._retries: deque[_Chunk] = deque()
        self._running: dict[Any, _Chunk] = {}
        self._duration_s, self._count = 0.0, 0
        self._capacity, self._checked = 1, float("-inf")

    def results(self) -> Iterator[TimedResult]:
        """Yield the results of all cases as they become available."""
        while self._waiting or self._retries or self._running:
            self._send()
            ready, _ = self._ray.wait([*self._running], num_returns=1, timeout=POLL_S)
            for reference in ready:
                yield from self._receive(reference, self._running.pop(reference))
            self._stop_overdue()

    def _send(self) -> None:
        if monotonic() - self._checked > POLL_S:
            # Nodes may come and go.
            cpus = int(self._ray.cluster_resources().get("CPU", 1)) or 1
            self._capacity = min(cpus, self._cluster.workers or cpus)
            self._checked = monotonic()
        while len(self._running) < self._capacity and (self._waiting or self._retries):
            chunk = self._retries.popleft() if self._retries else _Chunk(self._next_cases())
            chunk.since = monotonic()
            lines = [to_json_line(case.as_json()) for case in chunk.cases]
            self._running[self._remote.remote(self._name, self._options, lines)] = chunk

    def _next_cases(self) -> list[Case]:
        """Return the next chunk: about `CHUNK_S` long, and shorter towards the end."""
        each_s = self._duration_s / self._count if self._count else CHUNK_S
        fair = len(self._waiting) // (2 * self._capacity)
        size = max(1, min(int(CHUNK_S / max(each_s, 1e-6)), fair, MAX_CHUNK))
        return [self._waiting.popleft() for _ in range(min(size, len(self._waiting)))]

    def _receive(self, reference: object, chunk: _Chunk) -> Iterator[TimedResult]:
        try:
            lines: list[str] = self._ray.get(reference)
        except self._ray.exceptions.RayError as error:
            yield from self._retry(chunk, type(error).__name__)
            return
        self._duration_s += monotonic() - chunk.since
        self._count += len(lines)
        yield from (parse_case_run(line, chunk.attempts + 1) for line in lines)

    def _retry(self, chunk: _Chunk, why: str) -> Iterator[TimedResult]:
        """Retry the cases of a lost chunk one by one: a single case may be the cause."""
        if len(chunk.cases) > 1:
            self._retries.extend(_Chunk([case]) for case in chunk.cases)
            return
        attempts = chunk.attempts + 1
        if attempts < self._cluster.attempts:
            self._retries.append(_Chunk(chunk.cases, attempts))
        else:
            yield lost_case(chunk.cases[0], f"{why}, {attempts} times", attempts)

    def _stop_overdue(self) -> None:
        for reference, chunk in self._running.items():
            if monotonic() - chunk.since > self._cluster.timeout_s * len(chunk.cases):
                self._ray.cancel(reference, force=True)  # `wait` then returns it as an error
                chunk.since = float("inf")


def _check_address(address: str) -> None:
    """Check that an address accepts connections; Ray itself would retry for minutes."""
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    if colon:
        socket.create_connection((host, int(port)), CONNECT_S).close()


def _import_ray() -> Any:
    # Ray reads this when it is imported: no usage statistics are sent.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    with extra_required("cluster", "ray"):
        import ray  # pyright: ignore[reportMissingImports] - an extra

    return ray
