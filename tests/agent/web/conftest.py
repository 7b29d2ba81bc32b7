"""A service over a base in a folder, without a robot."""

from collections.abc import Iterator

import pytest

from .running_service import RunningService, end, start


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    """One for all tests of a module."""
    started = start(tmp_path_factory.mktemp("service") / "kb", "--no-sim")
    yield started
    end(started)
