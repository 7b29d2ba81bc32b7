"""The robot: its table, its lease, and how it is stopped."""

from __future__ import annotations

import gzip
from typing import Annotated

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from ...documents import things_as_json
from ...execution.outcome import Json
from ..problems import Problem
from ..security import Operator, Reader
from .conversation import TheService

router = APIRouter(prefix="/api/v1", tags=["robot"])


class Table(BaseModel):
    """What is laid on the table."""

    scene: str = Field(max_length=500, examples=["all", "objects:knife,mug", "random:7"])
    seed: int = Field(default=0, ge=0, le=2**31 - 1)


class LeaseWish(BaseModel):
    """For how long somebody wants to command the robot alone."""

    seconds: Annotated[float, Field(ge=0, le=600)] = 60


@router.get("/scene")
async def scene(service: TheService, _: Reader) -> Json:
    """What stands on the table, and where, as soon as there is a body."""
    agent = service.agent
    known = service.scene_as_json()
    if not agent.has_body:
        return known
    return known | {"things": await service.run(lambda: things_as_json(agent.body))}


@router.get("/scene.glb", response_class=Response)
def picture(service: TheService, _: Reader) -> Response:
    """The shapes of all that can be seen, as glTF; another scene has another address."""
    live_scene = service.live_scene
    if live_scene is None:
        raise Problem(404, "no-body", "No body", "There is no simulated robot to be seen.")
    headers = {"Cache-Control": "private, max-age=31536000, immutable", "Content-Encoding": "gzip"}
    packed = gzip.compress(live_scene.model.file.read_bytes(), 6)
    return Response(packed, media_type="model/gltf-binary", headers=headers)


@router.post("/scene")
async def set_scene(service: TheService, caller: Operator, wanted: Table) -> Json:
    """Lay the table anew."""
    service.check_lease(caller)
    await service.set_scene(wanted.scene, wanted.seed)
    return service.scene_as_json()


@router.post("/robot/stop")
async def stop(service: TheService, _: Operator) -> Json:
    """Stop what moves, and drop the commands that wait, whoever holds the lease."""
    service.stop_robot()
    return {"stopped": True}


@router.post("/robot/lease")
async def lease(service: TheService, caller: Operator, wish: LeaseWish) -> Json:
    """Command the robot alone for some time; 0 seconds give it back."""
    return service.lease(caller, wish.seconds)
