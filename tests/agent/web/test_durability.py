"""What is acknowledged over HTTP is on disk, also when the service is killed."""

import threading
from contextlib import suppress
from pathlib import Path

import httpx

from hilt.kb import KnowledgeBase

from .running_service import SECONDS, say, start

KILLS = 30
USES = ("cutting", "drinking", "stirring", "pounding", "eating", "cooking", "writing", "digging")
OBJECTS = ("knife", "mug", "spoon", "hammer", "spatula", "shoe", "screwdriver", "bowl")


def test_nothing_acknowledged_is_lost_when_the_service_is_killed(tmp_path: Path):
    """A service is killed while it is taught, again and again; each answer was kept."""
    lessons = (f"A {thing} is used for {use}" for use in USES * 99 for thing in OBJECTS)
    acknowledged, port = list[int](), "0"
    for number in range(KILLS):
        service = start(tmp_path / "kb", "--no-sim", "--port", port)
        port = service.url.rpartition(":")[2]
        client = service.browser()
        killer = threading.Timer(0.005 * number, service.process.kill)
        with suppress(httpx.TransportError):  # in the end
            while answer := say(client, "tell", next(lessons)).json():
                assert answer["accepted"]
                acknowledged.append(1)
                if killer.ident is None:
                    killer.start()
        client.close()
        service.process.communicate(timeout=SECONDS)

    with KnowledgeBase.open(tmp_path / "kb", read_only=True) as base:
        kept = [said for said in base.history() if said.kind == "statement" and said.accepted]

    assert len(acknowledged) >= KILLS
    assert len(acknowledged) <= len(kept) <= len(acknowledged) + KILLS
