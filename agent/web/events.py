"""Events: one hub, from which every reader has a queue of its own.

Durable events carry the number of their utterance as `id`, and are replayed from the history, so
nothing is lost with a connection. Frames of the live scene are not kept: of those the newest count.
"""

import asyncio
from collections import Counter, deque
from collections.abc import AsyncGenerator, Generator, Iterator
from contextlib import contextmanager
from typing import Any

from starlette.concurrency import run_in_threadpool

from ...kb.reader import RuleReader
from ...ontology.logs import timed
from .problems import Problem
from .tokens import Caller

Event = dict[str, Any]
MOST_WAITING, MOST_FRAMES = 1_000, 8  # of one reader
MOST_STREAMS, MOST_STREAMS_EACH = 64, 4
MOST_RULES = 100  # of one event; a file may tell a million
GOING_AWAY, TRY_AGAIN = 1001, 1013  # codes of a WebSocket's end


class EventStream:
    """The events that wait for one reader."""

    def __init__(self) -> None:
        self._events = deque[Event]()
        self._frames = deque[bytes](maxlen=MOST_FRAMES)
        self._news = asyncio.Event()
        self.end: int | None = None  # the code of its end

    def put(self, event: Event | bytes) -> None:
        """Add an event or a frame; who is too far behind is closed, and comes back."""
        if isinstance(event, bytes):
            self._frames.append(event)
        elif len(self._events) >= MOST_WAITING:
            self.close(TRY_AGAIN)
        else:
            self._events.append(event)
        self._news.set()

    def close(self, code: int) -> None:
        """End it, after what waits unless its reader is too slow."""
        self.end = self.end or code
        self._news.set()

    async def read(self, since: int | None, base: RuleReader) -> AsyncGenerator[Event | bytes]:
        """Yield what was said after an utterance, then what happens, until the end."""
        last = 0
        for event in [] if since is None else await run_in_threadpool(list, news(base, since)):
            last = event.get("id", last)
            yield event
        while self.end != TRY_AGAIN:
            while self._events and self.end != TRY_AGAIN:
                event = self._events.popleft()
                if event.get("id", last + 1) > last:
                    yield event
            while self._frames:
                yield self._frames.popleft()
            if self.end is not None:
                return
            self._news.clear()
            await self._news.wait()


class Hub:
    """Where everything that happens is made known; `publish` may be called by any thread."""

    def __init__(self) -> None:
        self._streams: dict[EventStream, str] = {}
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def readers(self) -> int:
        """How many listen."""
        return len(self._streams)

    def publish(self, event: Event | bytes) -> None:
        """Give an event or a frame to every reader."""

        def spread() -> None:
            for stream in self._streams:
                stream.put(event)

        if self._loop is not None and self._streams:
            self._loop.call_soon_threadsafe(spread)

    @contextmanager
    def subscribed(self, caller: Caller) -> Generator[EventStream]:
        """A new reader for the block; a problem if there are too many."""
        own = Counter(self._streams.values())[caller.id]
        if own >= MOST_STREAMS_EACH or self.readers >= MOST_STREAMS:
            detail = f"At most {MOST_STREAMS_EACH} streams a token, {MOST_STREAMS} in all."
            raise Problem(429, "too-many", "Too many streams", detail, headers={"Retry-After": "5"})
        self._loop = asyncio.get_running_loop()
        self._streams[stream := EventStream()] = caller.id
        try:
            yield stream
        finally:
            del self._streams[stream]

    def close(self) -> None:
        """Say goodbye to all readers."""
        for stream in self._streams:
            stream.put({"type": "closing"})
            stream.close(GOING_AWAY)


def news(base: RuleReader, since: int) -> Iterator[Event]:
    """What was said after an utterance, each after the rules that it changed."""
    with timed(__name__, "read what was said after %s", since):
        for said in base.history(since=since):
            changed = {"told": said.asserts, "retracted": said.retracts}
            changed["superseded"] = said.supersedes
            if any(changed.values()):
                shown = {name: ids[:MOST_RULES] for name, ids in changed.items()}
                rules = {n: [base.rule(one).as_json() for one in i] for n, i in shown.items()}
                known = {"type": "rules", "utterance": said.sequence, "more": shown != changed}
                yield known | rules
            yield {"type": "said", "id": said.sequence, **said.as_json()}
