"""A service in a process of its own, as a user starts it, and those who ask it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx

from hilt.agent.web.server import tokens_beside
from hilt.agent.web.tokens import TokenFile

SECONDS = 120


@dataclass
class RunningService:
    """A service that runs, its base, and the file of its tokens."""

    process: subprocess.Popen[str]
    url: str
    key: str | None
    base: Path

    @property
    def tokens(self) -> TokenFile:
        """The tokens of its base."""
        return TokenFile(tokens_beside(str(self.base)))

    def client(self, *roles: str, speaker: str = "sam", **more: Any) -> httpx.Client:
        """Somebody who asks with a new token of these roles; without one for no roles."""
        headers = dict[str, str]()
        if roles:
            headers["Authorization"] = f"Bearer {self.tokens.add('test', speaker, roles)[1]}"
        return httpx.Client(base_url=self.url, headers=headers, timeout=SECONDS, **more)

    def browser(self) -> httpx.Client:
        """Somebody who opened the address of a new service, and has its cookie."""
        client = httpx.Client(base_url=self.url, timeout=SECONDS, headers={"Origin": self.url})
        assert client.get("/", params={"key": self.key}).status_code == 303
        return client


def start(
    base: Path | str, *options: str, environment: Mapping[str, str] | None = None
) -> RunningService:
    """Start a service of a base on a free port, and wait until it is ready."""
    command = [sys.executable, "-m", "hilt", "serve", "--kb", str(base), "--port", "0", "--json"]
    process = subprocess.Popen(
        [*command, *options],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, **(environment or {})},
    )
    assert process.stdout
    ready = json.loads(process.stdout.readline())
    url = ready["url"].partition("?")[0].rstrip("/")
    return RunningService(process, url, ready["key"], Path(base))


def end(service: RunningService) -> None:
    """Stop a service as a user does."""
    service.process.terminate()
    service.process.communicate(timeout=SECONDS)


def say(client: httpx.Client, how: str, text: str, **more: Any) -> httpx.Response:
    """Say something to a service."""
    headers = more.pop("headers", {})
    return client.post(f"/api/v1/{how}", json={"text": text, **more}, headers=headers)
