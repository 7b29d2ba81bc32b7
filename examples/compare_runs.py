"""How two runs of an evaluation differ: counts, options and, where both have them, cases.

    python examples/compare_runs.py A.json B.json

Each file is what `hilt evaluate --json` printed, or `--report FILE.json` kept. Times are not
compared. The exit code is 1 if anything else differs.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

NOT_COMPARED = ("results", "wrong", "cpu_s")  # results are compared by case; times always differ


def leaves(document: dict, prefix: str = "") -> Iterator[tuple[str, object]]:
    """Yield each value of nested objects with its name, and each point of a noise curve."""
    for name, value in document.items():
        if name in NOT_COMPARED:
            continue
        if name == "curves":
            for curve in value:
                for line, points in curve["lines"].items():
                    for point in points:
                        yield f"{curve['curve']}.{line} at {point['x']}", point["accuracy"]
        elif isinstance(value, dict):
            yield from leaves(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def cases(document: dict) -> dict[str, object]:
    """Return what each case came to, by its key."""
    results = document.get("results", [])
    return {r["key"]: f"{'right' if r['right'] else 'wrong'}: {r['found']}" for r in results}


def differences(one: dict, other: dict) -> Iterator[str]:
    """Yield a line for each value that differs."""
    pairs = [(dict(leaves(one)), dict(leaves(other)))]
    if "results" in one and "results" in other:
        pairs.append((cases(one), cases(other)))
    for a, b in pairs:
        for name in dict.fromkeys((*a, *b)):
            if a.get(name) != b.get(name):
                yield f"{name}: {a.get(name)} | {b.get(name)}"


if __name__ == "__main__":
    first, second = (json.loads(Path(name).read_text(encoding="utf-8")) for name in sys.argv[1:3])
    found = list(differences(first, second))
    print("\n".join(found) or "No difference.")
    sys.exit(bool(found))
