"""A visitor of the page, who types, clicks and looks."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

from ..running_service import RunningService

SECONDS = 1000.0  # in the milliseconds of Playwright
PATIENCE = 60 * SECONDS
LESSONS = (
    "A knife is used for cutting.",
    "To pass a knife grab the knife by the blade.",
    "To pass a mug grab the mug by the handle.",
)
COMMAND = "pass me something used for cutting"


@dataclass
class Visitor:
    """Somebody with an open page of a service."""

    page: Any
    service: RunningService

    def wait_for(self, selector: str) -> Any:
        """Wait until something is there, and return it."""
        found = self.page.locator(selector).first
        found.wait_for(timeout=PATIENCE)
        return found

    def wait_until(self, condition: str, argument: object = None) -> None:
        """Wait until a condition in JavaScript holds."""
        self.page.wait_for_function(condition, arg=argument, timeout=PATIENCE)

    def wait_for_connection(self) -> None:
        """Wait until the page is connected to its service."""
        self.wait_for('html[data-connection="open"]')

    def say(self, text: str, *, outcome: str = "done") -> str:
        """Type something, wait for the answer, and return it."""
        number = self.page.locator(".turn").count() + 1
        self.page.get_by_label("Say something to Hilt").fill(text)
        self.page.keyboard.press("Enter")
        turn = f'.turn:nth-of-type({number})[data-outcome="{outcome}"][data-sequence]'
        return self.wait_for(f"{turn} .bubble.hilt > p").inner_text()

    def begin(self, text: str) -> None:
        """Type something, and do not wait."""
        self.page.get_by_label("Say something to Hilt").fill(text)
        self.page.keyboard.press("Enter")

    def show(self, tab: str) -> None:
        """Open one of the tabs, by its name."""
        self.page.locator(f'[data-tab="{tab}"]').click()

    def rules(self) -> list[list[str]]:
        """The rules in the table of the page, row by row."""
        self.show("rules")
        self.page.get_by_role("button", name="Table", exact=True).click()
        self.wait_for(".rule-table tbody tr")
        rows = self.page.locator(".rule-table tbody tr").all()
        return [row.locator("td").all_inner_texts() for row in rows]

    def ask_api(self, path: str) -> Any:
        """What the service tells this visitor, as JSON."""
        return self.page.request.get(f"{self.service.url}/api/v1/{path}").json()

    def stage(self) -> np.ndarray:
        """The picture of the scene as it is shown now (height, width, 3)."""
        shot = self.page.locator(".stage").screenshot()
        return np.asarray(Image.open(BytesIO(shot)).convert("RGB")).astype(int)
