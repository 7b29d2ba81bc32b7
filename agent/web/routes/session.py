"""Who one is: the session of the page, and tokens."""

from __future__ import annotations

from datetime import timedelta
from typing import Annotated, Any

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field

from ...execution.outcome import Json
from ..security import Admin, Gate, Reader

router = APIRouter(tags=["access"])


class Key(BaseModel):
    """A one-time key, or a token."""

    key: str = Field(min_length=1, max_length=200)


class TokenWish(BaseModel):
    """A token that is to be made, for whom, and for how long."""

    name: str = Field(min_length=1, max_length=100)
    speaker: str = Field(min_length=1, max_length=100)
    roles: list[str] = Field(min_length=1, max_length=4)
    days: Annotated[float, Field(gt=0, le=3650)] | None = None


def _gate(request: Request) -> Gate:
    return request.app.state.gate


@router.get("/session")
async def whoami(caller: Reader) -> Json:
    """For whom the token or the session speaks, and what that one may do."""
    return {"id": caller.id, "speaker": caller.speaker, "roles": sorted(caller.roles)}


@router.post("/session", status_code=204)
async def begin(request: Request, key: Key) -> None:
    """Take a cookie for a key or a token."""
    _gate(request).begin_session(request, key.key)


@router.delete("/session", status_code=204)
async def end(request: Request, _: Reader) -> None:
    """Give the cookie back."""
    request.session.clear()


@router.get("/tokens")
def tokens(request: Request, _: Admin) -> list[dict[str, Any]]:
    """The tokens, without their secrets."""
    return [each.as_json() for each in _gate(request).tokens.tokens()]


@router.post("/tokens", status_code=201)
def add_token(request: Request, _: Admin, wish: TokenWish) -> Json:
    """Make a token; this is the only time that it is shown."""
    lasts = None if wish.days is None else timedelta(days=wish.days)
    made, secret = _gate(request).tokens.add(wish.name, wish.speaker, wish.roles, lasts)
    return made.as_json() | {"token": secret}


@router.delete("/tokens/{id}", status_code=204)
def remove_token(request: Request, _: Admin, id: str) -> None:  # noqa: A002
    """Remove a token; who uses it is out at once."""
    _gate(request).tokens.remove(id)
