"""The session of a browser: who one is, and the cookie for a key or a token."""

from __future__ import annotations

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field

from ...execution.outcome import Json
from ..security import Reader

router = APIRouter(prefix="/api/v1/session", tags=["session"])


class Key(BaseModel):
    """A one-time key, or a token."""

    key: str = Field(min_length=1, max_length=200)


@router.get("")
async def whoami(caller: Reader) -> Json:
    """For whom the token or the session speaks, and what that one may do."""
    return {"id": caller.id, "speaker": caller.speaker, "roles": sorted(caller.roles)}


@router.post("", status_code=204)
async def begin(request: Request, key: Key) -> None:
    """Take a cookie for a key or a token."""
    request.app.state.gate.begin_session(request, key.key)
