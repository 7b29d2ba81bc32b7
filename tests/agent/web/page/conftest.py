"""The page in a real browser: Debian's Chromium, driven by Playwright.

Every test fails on an error in the console, an error of the page, or a request that leaves the
host. What waits waits for a flag of the page, never for time.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from hilt.agent.web.server import STATIC

from ..running_service import RunningService, end, start
from .driving import LESSONS, Visitor

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
OPTIONS = [
    *("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--ignore-gpu-blocklist", *(["--no-sandbox"] if os.geteuid() == 0 else [])),
]
WIDE = {"width": 1440, "height": 900}
Visit = Callable[..., Visitor]


@pytest.fixture(scope="module")
def options() -> Sequence[str]:
    """Further options of Chromium."""
    return ()


@pytest.fixture(scope="module")
def browser(options: Sequence[str]) -> Iterator[Any]:
    """Chromium without a window; skips where it, Playwright or the page is not there."""
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed: apt-get install chromium")
    if not (STATIC / "index.html").exists():
        pytest.skip("the page is not built: make page")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=CHROMIUM, args=[*OPTIONS, *options])
        yield opened
        opened.close()


@pytest.fixture
def mind(tmp_path: Path) -> Iterator[RunningService]:
    """A service over an empty base of its own, without a robot."""
    started = start(tmp_path / "kb", "--no-sim")
    yield started
    end(started)


@pytest.fixture(scope="module")
def school(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    """A service that was taught the three sentences, which no test changes; without a robot."""
    started = start(tmp_path_factory.mktemp("school") / "kb", "--no-sim")
    with started.client("teacher") as teacher:
        for lesson in LESSONS:
            teacher.post("/api/v1/tell", json={"text": lesson})
    yield started
    end(started)


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    """A service over an empty base, with a robot at a table with a knife and a mug."""
    started = start(tmp_path_factory.mktemp("robot") / "kb", "--scene", "objects:knife,mug,glass")
    yield started
    end(started)


@pytest.fixture
def visit(browser: Any) -> Iterator[Visit]:
    """Opens the page of a service for a new visitor, and checks at the end that all went well."""
    found: list[str] = []
    contexts: list[Any] = []

    def open_page(
        service: RunningService,
        *,
        roles: tuple[str, ...] = ("admin",),
        forgives: Sequence[str] = (),
        **options: Any,
    ) -> Visitor:
        context = browser.new_context(**{"viewport": WIDE, **options})
        contexts.append(context)
        if roles and service.key:
            token = service.tokens.add("visitor", "sam", roles)[1]
            context.request.post(f"{service.url}/api/v1/session", data={"key": token})
        page = context.new_page()
        _watch(page, urlsplit(service.url).netloc, found, forgives)
        page.goto(service.url)
        return Visitor(page, service)

    yield open_page
    for context in contexts:
        context.close()
    assert found == []


def _watch(page: Any, host: str, found: list[str], forgives: Sequence[str]) -> None:
    def note(text: str) -> None:
        if not any(each in text for each in forgives):
            found.append(text)

    def on_request(request: Any) -> None:
        address = urlsplit(request.url)
        if address.scheme not in {"data", "blob"} and address.netloc != host:
            found.append(f"left the host: {request.url}")

    page.on("console", lambda said: note(said.text) if said.type in {"error", "warning"} else None)
    page.on("pageerror", lambda error: found.append(str(error)))
    page.on("request", on_request)
