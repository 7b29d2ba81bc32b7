"""Evaluations: one at a time, in a process of its own, with progress and a report."""

import asyncio
import json
import sys
from contextlib import suppress
from pathlib import Path
from secrets import token_hex
from typing import Annotated, Literal, TypeAlias

from fastapi import APIRouter, Depends, Request, Response
from pydantic import BaseModel, Field
from starlette.responses import FileResponse, HTMLResponse

from ...ontology.errors import NotFoundError
from ..evaluation.runners.journal import JOURNAL
from ..execution.outcome import Json
from .events import Hub
from .problems import Problem
from .security import Operator, Reader

router = APIRouter(prefix="/api/v1/evaluations", tags=["evaluations"])
Count = Annotated[int, Field(ge=1, le=1000)] | None
_POLICY = (
    "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'self'"
)
_REPORT, _RESULT, _PAUSE_S = "report.html", "result.json", 0.5


class EvaluationWish(BaseModel):
    """What is to be evaluated; the options are those of `hilt evaluate`."""

    what: Literal["paper", "situations", "grasps", "all-scenarios", "random", "noise"]
    sim: bool = False
    seed: Annotated[int, Field(ge=0, le=2**31 - 1)] = 0
    scenes: Annotated[int, Field(ge=1, le=255)] | None = None
    scenarios: Count = None
    poses: Count = None
    trials: Count = None
    curves: Annotated[str, Field(pattern=r"^[a-z_,-]{1,200}$")] | None = None

    def arguments(self, folder: Path) -> list[str]:
        """The command that does it."""
        given = self.model_dump(exclude={"what", "sim"}, exclude_none=True)
        options = [text for name, value in given.items() for text in (f"--{name}", str(value))]
        files = ["--out", str(folder), "--report", str(folder / _REPORT), "--json"]
        return ["evaluate", self.what, *options, *["--sim"] * self.sim, *files]


class Evaluations:
    """The evaluations in a folder, and the one that runs."""

    def __init__(self, folder: Path, hub: Hub) -> None:
        self.folder, self._hub = folder, hub
        self._running = dict[str, asyncio.subprocess.Process]()  # one at most
        self._following: asyncio.Task[None] | None = None

    async def begin(self, wish: EvaluationWish) -> str:
        """Begin one, and return its id; Problem 409 while another runs."""
        if self._running:
            raise Problem(409, "busy", "Busy", f"Evaluation {next(iter(self._running))} runs.")
        folder = self.folder / (name := token_hex(4))
        folder.mkdir(parents=True)
        with (folder / _RESULT).open("wb") as result:
            command = [sys.executable, "-m", "hilt", *wish.arguments(folder)]
            process = await asyncio.create_subprocess_exec(*command, stdout=result)
        self._running[name] = process
        self._following = asyncio.ensure_future(self._follow(name, process))
        return name

    async def _follow(self, name: str, process: asyncio.subprocess.Process) -> None:
        while process.returncode is None:
            with suppress(asyncio.TimeoutError):
                await asyncio.wait_for(process.wait(), _PAUSE_S)
            if process.returncode is not None:
                del self._running[name]
            self._hub.publish({"type": "progress", **self.as_json(name), "result": None})

    def as_json(self, name: str) -> Json:
        """How far one is, and its result; UnknownNameError if there is none."""
        folder = self.folder / name
        if name not in (names := [each.name for each in self.folder.glob("*")]):
            raise NotFoundError("evaluation", name, names)
        journal = (folder / JOURNAL).read_bytes() if (folder / JOURNAL).exists() else b""
        lines = journal.split(b"\n")[:-1]  # those that are whole
        result, runs = (folder / _RESULT).read_bytes(), name in self._running
        return {
            "evaluation": name,
            "state": "running" if runs else "done" if result else "ended",
            "done": max(0, len(lines) - 1),
            "of": json.loads(lines[0])["cases"] if lines else 0,
            "result": json.loads(result) if result and not runs else None,
        }

    async def stop(self, name: str | None = None) -> None:
        """Stop one, or the one that runs; its journal is kept."""
        for process in [self._running[each] for each in self._running if name in {None, each}]:
            process.terminate()
            await process.wait()


async def _evaluations(request: Request) -> Evaluations:
    return request.app.state.evaluations


Theirs: TypeAlias = Annotated[Evaluations, Depends(_evaluations)]


@router.post("", status_code=202)
async def begin(found: Theirs, response: Response, _: Operator, wish: EvaluationWish) -> Json:
    """Begin an evaluation; events tell its progress."""
    name = await found.begin(wish)
    response.headers["Location"] = f"/api/v1/evaluations/{name}"
    return found.as_json(name)


@router.get("")
def all_evaluations(found: Theirs, _: Reader) -> list[Json]:
    """All evaluations, oldest first."""
    folders = sorted(found.folder.glob("*"), key=lambda each: each.stat().st_mtime)
    return [found.as_json(each.name) for each in folders]


@router.get("/{name}")
def evaluation(found: Theirs, _: Reader, name: str) -> Json:
    """How far it is, and its result as of `hilt evaluate --json`."""
    return found.as_json(name)


@router.get("/{name}/report", response_class=HTMLResponse)
def report(found: Theirs, _: Reader, name: str) -> FileResponse:
    """Its report for people, as HTML."""
    found.as_json(name)
    if not (file := found.folder / name / _REPORT).exists():
        raise NotFoundError("report", name, [])
    return FileResponse(file, headers={"Content-Security-Policy": _POLICY})


@router.delete("/{name}", status_code=204)
async def stop(found: Theirs, _: Operator, name: str) -> None:
    """Stop it; what is done is kept."""
    found.as_json(name)
    await found.stop(name)
