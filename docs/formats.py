"""The page of the YAML formats, made from their schemas.

    python docs/formats.py > docs/formats.md

A test sees to it that the page is fresh.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

SCHEMAS = Path(__file__).with_name("schemas")
DEEPEST = 5  # levels of keys in a table; what is below is in the schema
HEAD = """# YAML formats

Made by `make docs` from the [schemas](https://json-schema.org), with which editors check a file and
complete its keys while you write. Hilt itself checks more when it reads a file, such as whether an
object has the part that is named, and says file, line and column.

With the YAML extension of VS Code, or any editor that has `yaml-language-server`, name the schema
in the first line of a file:

```text
# yaml-language-server: $schema=path/to/hilt/docs/schemas/objects.schema.json
```

or in `.vscode/settings.json` for all files of a folder:

```json
{"yaml.schemas": {"path/to/hilt/docs/schemas/objects.schema.json": "objects/*.yaml"}}
```

A key with an asterisk must be there. `NAME` is any name, `[]` an item of a list.
"""


def reference() -> str:
    """The page as Markdown."""
    sections = [line for path in sorted(SCHEMAS.iterdir()) for line in _section(path)]
    return "\n".join([HEAD, *sections]).rstrip() + "\n"


def _section(path: Path) -> Iterator[str]:
    schema = json.loads(path.read_text(encoding="utf-8"))
    yield f"## {schema['title']}\n\n{schema['description']} [{path.name}](schemas/{path.name})\n"
    yield "| key | |\n|---|---|"
    for key, text in _rows(schema, schema, "", 0):
        yield f"| `{key}` | {text} |"
    yield ""


def _rows(root: Any, schema: Any, prefix: str, depth: int) -> Iterator[tuple[str, str]]:
    """Yield the keys below a schema, with what each means."""
    schema = _resolved(root, schema)
    if depth == DEEPEST:
        return
    for key, each in schema.get("properties", {}).items():
        star = "*" if key in schema.get("required", ()) else ""
        yield f"{prefix}{key}{star}", _meaning(_resolved(root, each))
        yield from _rows(root, each, f"{prefix}{key}.", depth + 1)
    more, items = schema.get("additionalProperties"), schema.get("items")
    if isinstance(more, dict) and (prefix or not schema.get("properties")):
        yield from _rows(root, more, f"{prefix}NAME.", depth)
    if isinstance(items, dict):
        yield from _rows(root, items, f"{prefix.removesuffix('.')}[].", depth)


def _resolved(root: Any, schema: Any) -> Any:
    reference = schema.get("$ref", "")
    return root["$defs"][reference.rpartition("/")[2]] if reference.startswith("#") else schema


def _meaning(schema: Any) -> str:
    words = [schema.get("description", "")]
    low, high = schema.get("minimum"), schema.get("maximum")
    if low is not None and high is not None:
        words.append(f"In [{low:g}, {high:g}].")
    known = schema.get("enum")
    among = known or schema.get("anyOf", [{}])[0].get("enum", [])
    if among:
        listed = ", ".join(f"`{value}`" for value in among)
        words.append(f"{'One of' if known else 'Known are'} {listed}.")
    return " ".join(filter(None, words)).replace("|", r"\|")


if __name__ == "__main__":
    sys.stdout.write(reference())
