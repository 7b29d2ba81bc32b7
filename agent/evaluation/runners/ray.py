"""Runner on a Ray cluster, whose nodes may fail.

Hilt must be installed on every node. The cases of a failed node are started again on another one.
"""

import faulthandler
import os
import socket
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from ....ontology.errors import WorkersUnavailableError, extra_required
from ..experiment import Case, Experiment, TimedResult, to_json_line
from .base import ATTEMPTS, TIMEOUT_S, run_in_pool, run_in_worker

LOCAL = "local"
CONNECT_S = 10.0  # how long the head node may take to answer [s]


def _import_ray() -> Any:
    # Ray reads this when it is imported: no usage statistics are sent.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    with extra_required("cluster", "ray"):
        import ray  # pyright: ignore[reportMissingImports] - an extra

    return ray


@dataclass(frozen=True)
class RayRunner:
    """Runs cases on a Ray cluster.

    Attributes:
        address: the address of its head node, "auto", or "local" to start a cluster.
        workers: maximum number of cases at the same time; None is the number of processors.
        timeout_s: how long a case may take before it is stopped [s].
        attempts: how often a case is started whose worker dies.

    Raises:
        MissingExtraError: Ray is not installed.
    """

    address: str
    workers: int | None = None
    timeout_s: float = TIMEOUT_S
    attempts: int = ATTEMPTS
    _ray: Any = field(default_factory=_import_ray, repr=False, compare=False)

    def __call__(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[TimedResult]:
        """Run the cases on the cluster; WorkersError if it cannot be reached."""
        work = (self.timeout_s, experiment.name, to_json_line(experiment.options))
        with self._connected():
            task = self._ray.remote(_run_within).options(max_retries=0)
            yield from run_in_pool(
                cases,
                lambda case: task.remote(*work, case).future(),
                (self._ray.exceptions.RayError,),
                attempts=self.attempts,
                at_once=self.workers,
            )

    @contextmanager
    def _connected(self) -> Generator[None]:
        own = self.address == LOCAL
        host, colon, port = self.address.removeprefix("ray://").rpartition(":")
        try:
            if colon:  # Ray itself would retry for minutes
                socket.create_connection((host, int(port)), CONNECT_S).close()
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


def _run_within(timeout_s: float, *work: str) -> str:
    faulthandler.dump_traceback_later(timeout_s, exit=True)
    try:
        return run_in_worker(*work)
    finally:
        faulthandler.cancel_dump_traceback_later()
