"""For those who keep the base: trust, whole files in and out, backups, and tokens."""

from __future__ import annotations

import tempfile
from datetime import timedelta
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi import Path as InPath
from pydantic import BaseModel, Field
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.responses import FileResponse

from ....kb.backup import backup as save
from ....kb.formats.import_export import export_file, import_file
from ....kb.formats.registry import FORMATS
from ....ontology.errors import DataError
from ...documents import trust_as_json
from ...execution.outcome import Json
from ..problems import Problem
from ..security import Admin, Gate, Reader
from .conversation import TheService

router = APIRouter(prefix="/api/v1", tags=["administration"])
Format = Annotated[str, Query(description=", ".join(FORMATS))]


class Trust(BaseModel):
    """How far somebody is trusted; 0 for not at all."""

    degree: float = Field(ge=0, le=1)


class Backup(BaseModel):
    """The name of a new folder beside the base."""

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")


class TokenWish(BaseModel):
    """A token that is to be made, for whom, and for how long."""

    name: str = Field(min_length=1, max_length=100)
    speaker: str = Field(min_length=1, max_length=100)
    roles: list[str] = Field(min_length=1, max_length=4)
    days: Annotated[float, Field(gt=0, le=3650)] | None = None


@router.get("/trust")
def trust(service: TheService, _: Reader) -> Json:
    """The trust in each speaker."""
    return trust_as_json(service.base.trust_by_speaker())


@router.put("/trust/{speaker}")
async def set_trust(
    service: TheService, caller: Admin, speaker: Annotated[str, InPath(max_length=200)], told: Trust
) -> Json:
    """Set the trust in a speaker."""

    def told_so() -> Json:
        name = service.base.match_speaker(speaker)
        interval = service.base.set_trust(name, told.degree, by=caller.speaker)
        return trust_as_json({name: interval})

    return await service.run(told_so)


@router.get("/export", response_class=FileResponse)
def export(service: TheService, _: Reader, format: Format = "trig") -> FileResponse:
    """The base as a file."""
    if format not in FORMATS:
        raise DataError(f"expected one of {', '.join(FORMATS)}.", source=format)
    folder = tempfile.TemporaryDirectory(prefix="hilt-")
    file = Path(folder.name) / f"base{FORMATS[format].suffixes[0]}"
    export_file(service.base, file, format=format)
    return FileResponse(file, filename=file.name, background=BackgroundTask(folder.cleanup))


@router.post("/import")
async def import_(
    service: TheService, request: Request, _: Admin, format: Format, dry: bool = False
) -> Json:
    """Read a file, which is the body: checked first, applied whole or not at all."""
    with tempfile.NamedTemporaryFile(prefix="hilt-") as file:
        async for chunk in request.stream():
            await run_in_threadpool(file.write, chunk)
        file.flush()

        def read() -> Json:
            found = import_file(service.base, file.name, format=format, dry_run=dry)
            return {"applied": not dry, **found.as_json()}

        return await service.run(read)


@router.post("/backup", status_code=201)
def backup(service: TheService, _: Admin, wanted: Backup) -> Json:
    """Copy the base into a new folder beside it, while it is in use; the copy is read back."""
    base = service.base
    folder = Path(base.store.location).expanduser()
    target = folder.with_name(f"{folder.name}.backups") / wanted.name
    if not folder.is_dir() or target.exists():
        detail = "Only a base in a folder is backed up, under a name that is new."
        raise Problem(409, "no-backup", "No backup", detail)
    return {"backup": wanted.name, "sequence": save(base, target)}


def _gate(request: Request) -> Gate:
    return request.app.state.gate


@router.get("/tokens")
def tokens(request: Request, _: Admin) -> list[dict[str, Any]]:
    """The tokens, without their secrets."""
    return [each.as_json() for each in _gate(request).tokens.tokens()]


@router.post("/tokens", status_code=201)
def add_token(request: Request, _: Admin, wish: TokenWish) -> Json:
    """Make a token; this is the only time that it is shown."""
    lasts = None if wish.days is None else timedelta(days=wish.days)
    made, secret = _gate(request).tokens.add(wish.name, wish.speaker, wish.roles, lasts)
    return {**made.as_json(), "token": secret}


@router.delete("/tokens/{name}", status_code=204)
def remove_token(request: Request, _: Admin, name: str) -> None:
    """Remove a token, by its id or name; who uses it is out at once."""
    _gate(request).tokens.remove(name)
