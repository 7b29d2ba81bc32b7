"""Trajectories: the positions of a robot's joints over time, packed into a text, and exported."""

import json
import zlib
from base64 import b64decode, b64encode
from collections.abc import Sequence
from importlib import import_module
from io import BytesIO
from typing import Any

import numpy as np

from ...ontology.errors import DataError, extra_required
from ..poses import Array

UNITS = 10**6  # in a second, a radian and a metre: what is packed are whole numbers
MOST_BYTES = 64 * 2**20  # of what is unpacked: more than a day of motion
STATES_SCHEMA = b"""{"type": "object", "properties": {"timestamp": {"type": "object"}, "joints": {
"type": "array", "items": {"type": "object", "properties": {"name": {"type": "string"},
"position": {"type": "number"}, "velocity": {"type": "number"}}}}}}"""


def pack(robot: str, joints: Sequence[str], table: Array) -> str:
    """Pack a table (t, 1 + k) of times [s] and positions of k joints [rad], [m] into a text."""
    changes = np.diff(np.rint(table * UNITS), axis=0, prepend=0).T.astype("<i4")
    data = b64encode(zlib.compress(changes.tobytes(), 9)).decode()
    return json.dumps({"robot": robot, "joints": joints, "data": data})


def unpack(text: str) -> dict[str, Any]:
    """Return the robot, joints, time_s and positions that were packed; DataError if none were."""
    try:
        kept = json.loads(text)
        data = zlib.decompressobj().decompress(b64decode(kept.pop("data")), MOST_BYTES)
        changes = np.frombuffer(data, "<i4").reshape(len(kept["joints"]) + 1, -1)
    except (AttributeError, KeyError, TypeError, ValueError, zlib.error) as error:
        raise DataError("is no trajectory.", source="hilt:trajectory") from error
    times, *positions = changes.cumsum(axis=1, dtype=np.int64) / UNITS
    return {**kept, "time_s": times.tolist(), "positions": np.transpose(positions).tolist()}


def export(text: str, form: str) -> bytes:
    """Return a packed trajectory as "csv" (time_s, then the joints), "json" or "mcap"."""
    found = unpack(text)
    if form == "mcap":
        return as_mcap(found)
    if form == "json":
        return json.dumps(found).encode() + b"\n"
    rows = ((time, *at) for time, at in zip(found["time_s"], found["positions"], strict=True))
    lines = (",".join(f"{number:.6f}" for number in row) for row in rows)
    return "\n".join([",".join(("time_s", *found["joints"])), *lines, ""]).encode()


def as_mcap(found: dict[str, Any]) -> bytes:
    """Return an unpacked trajectory as an MCAP file; MissingExtraError if that needs a package."""
    with extra_required("mcap", "mcap"):
        writer = import_module("mcap.writer").Writer(stream := BytesIO())
    writer.start()
    schema = writer.register_schema("foxglove.JointStates", "jsonschema", STATES_SCHEMA)
    channel = writer.register_channel("/joint_states", "json", schema)
    speeds = np.gradient(found["positions"], found["time_s"], axis=0).round(6).tolist()
    for time, *states in zip(found["time_s"], found["positions"], speeds, strict=True):
        sec, nsec = divmod(moment := round(time * 1e9), 10**9)
        columns = zip(found["joints"], *states, strict=True)
        joints = [{"name": name, "position": at, "velocity": v} for name, at, v in columns]
        message = json.dumps({"timestamp": {"sec": sec, "nsec": nsec}, "joints": joints})
        writer.add_message(channel, moment, message.encode(), publish_time=moment)
    writer.finish()
    return stream.getvalue()
