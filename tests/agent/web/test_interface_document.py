"""The interface as its OpenAPI document describes it: whatever is sent, the service answers."""

from collections.abc import Iterator

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, settings
from schemathesis.checks import CHECKS, load_all_checks
from schemathesis.core.failures import Failure

from .running_service import RunningService, end, start

load_all_checks()
NOT_FUZZED = "/events|/evaluations$|/robot/stop"  # endless, costly, or stops what others do


@pytest.fixture(scope="module")
def interface(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    """A service in which everybody is the owner."""
    service = start(tmp_path_factory.mktemp("interface") / "kb", "--no-sim", "--no-auth")
    yield service
    end(service)
