"""The JSON Schema of the options of an agent, made from the options themselves.

    python docs/options.py > docs/schemas/options.schema.json

A test sees to it that the schema is fresh.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from hilt.agent.config import OPTIONS

TYPES: dict[type, str | list[str]] = {
    bool: "boolean",
    int: "integer",
    tuple: ["string", "array"],
}  # a text or a path otherwise


def reference() -> str:
    """The schema as JSON."""
    properties = {name: _property(option) for name, option in OPTIONS.items()}
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Options",
        "description": "Options of an agent: `--config FILE`, `AgentConfig.from_yaml`.",
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
    }
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def _property(option: Any) -> dict[str, Any]:
    kind = TYPES.get(option.kind, "string")
    items = {"items": {"type": "string"}} if option.kind is tuple else {}
    return {"description": option.help, "type": kind, **items}


if __name__ == "__main__":
    sys.stdout.write(reference())
