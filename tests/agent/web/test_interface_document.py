"""The interface as its OpenAPI document describes it: whatever is sent, the service answers."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest
import schemathesis
from hypothesis import Phase, given, settings
from schemathesis.checks import not_a_server_error
from schemathesis.checks import response_schema_conformance as as_described

from .running_service import RunningService, end, start

ENDLESS = "/api/v1/events"
EXAMPLES = 25  # of each route
CHECKS = [not_a_server_error, as_described]


@pytest.fixture(scope="module")
def interface(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    """A service in which everybody is the owner."""
    service = start(tmp_path_factory.mktemp("interface") / "kb", "--no-sim", "--no-auth")
    yield service
    end(service)


def test_nothing_ends_in_an_error_of_the_server(interface: RunningService):
    """Whatever is sent, every answer is of a form that is described, and none is a 500."""
    found = schemathesis.openapi.from_url(f"{interface.url}/openapi.json")
    routes = found.exclude(path=ENDLESS).exclude(path="/api/v1/evaluations", method="POST")
    tried = set[str]()
    for route in routes.get_all_operations():
        tried.add(route.ok().path)

        @settings(max_examples=EXAMPLES, phases=[Phase.explicit, Phase.generate])
        @given(case=route.ok().as_strategy())
        def is_answered(case: Any) -> None:
            case.call_and_validate(checks=CHECKS, headers={"Connection": "close"})

        is_answered()

    assert len(tried) >= 30


def test_document_describes_every_route(interface: RunningService):
    """It says what each is for, and what it takes."""
    document = httpx.get(f"{interface.url}/openapi.json").json()
    found = [each for path in document["paths"].values() for each in path.values()]

    assert len(found) >= 40
    assert all(each.get("summary") and each["tags"] for each in found)
