"""What happens, as it happens: Server-Sent Events for programs, a WebSocket for the page."""

import asyncio
from collections.abc import AsyncGenerator
from contextlib import suppress
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query, WebSocket
from fastapi.sse import EventSourceResponse, ServerSentEvent
from starlette.websockets import WebSocketDisconnect

from ..execution.outcome import Json
from .events import EventStream
from .problems import Problem
from .routes import TheGate, TheService
from .security import CALLER, Reader
from .service import Service

router = APIRouter(prefix="/api/v1", tags=["events"])
PROTOCOL = 1
_HELLO_SECONDS = 5.0
_NORMAL, _WHO, _TOO_MANY = 1000, 4401, 4429
Number = Annotated[int | None, Query(ge=0, le=2**53)]


async def _stream(service: TheService, caller: Reader) -> AsyncGenerator[EventStream]:
    with service.hub.subscribed(caller) as stream:
        yield stream


@router.get("/events", response_class=EventSourceResponse)
async def events(
    service: TheService,
    stream: Annotated[EventStream, Depends(_stream)],
    since: Number = None,
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncGenerator[ServerSentEvent]:
    """Everything that happens; `Last-Event-ID` or `since` replays what was said after it."""
    after = int(last_event_id) if last_event_id and last_event_id.isdecimal() else since
    yield ServerSentEvent(data=hello(service), event="hello")
    async for event in stream.read(after, service.base):
        if isinstance(event, dict):
            number = str(event["id"]) if "id" in event else None
            yield ServerSentEvent(data=event, event=event["type"], id=number)


@router.websocket("/live")
async def live(socket: WebSocket, service: TheService, gate: TheGate) -> None:
    """The same events as JSON texts, and frames of the scene as binary messages.

    Who has no cookie sends `{"type": "hello", "token": ..., "since": ...}` first.
    """
    await socket.accept()
    code = _NORMAL
    try:
        # The cookie says who listens, or a token in the first message.
        first: dict[str, Any] = await asyncio.wait_for(socket.receive_json(), _HELLO_SECONDS)
        token = first.get("token")
        caller = gate.caller_with(socket, str(token)) if token else gate.caller_of(socket)
        socket.scope[CALLER] = caller
        with service.hub.subscribed(caller) as stream:
            await socket.send_json(hello(service))
            shown = asyncio.ensure_future(service.run(service.show_frame))
            shown.add_done_callback(lambda done: done.exception())
            code = await _both_ways(socket, stream, service, first.get("since"))
    except Problem as problem:
        code = _TOO_MANY if problem.status_code == 429 else _WHO
    except (WebSocketDisconnect, asyncio.TimeoutError, ValueError, KeyError):
        code = _WHO
    with suppress(RuntimeError, WebSocketDisconnect):  # it has ended already
        await socket.close(code)


def hello(service: Service) -> Json:
    """The first event: the protocol, the last utterance, and the scene."""
    known: Json = {"type": "hello", "version": PROTOCOL, "sequence": service.base.sequence}
    return known | {"scene": service.scene_as_json()}


async def _both_ways(
    socket: WebSocket, stream: EventStream, service: Service, since: int | None
) -> int:
    async def listen() -> None:
        async for _ in socket.iter_text():  # what it says after its hello is not needed
            pass

    listening = asyncio.ensure_future(listen())
    listening.add_done_callback(lambda _: stream.close(_NORMAL))
    try:
        async for event in stream.read(since, service.base):
            if isinstance(event, bytes):
                await socket.send_bytes(event)
            else:
                await socket.send_json(event)
    finally:
        listening.cancel()
    return stream.end or _NORMAL
