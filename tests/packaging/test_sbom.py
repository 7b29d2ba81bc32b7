"""The bill of materials: what a user installs, at the versions of the lock."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from .environments import ROOT, TOOLS, copy_checkout, fresh_variables, run

pytestmark = [pytest.mark.install, pytest.mark.timeout(600)]


def test_components_are_those_of_the_lock(tmp_path: Path):
    """Each has the locked version; nothing of the development tools is listed."""
    folder = copy_checkout(tmp_path / "checkout")
    variables = fresh_variables(tmp_path / "home", TOOLS)
    run(["make", "-s", "sbom", "READY=", f"BIN={TOOLS}"], folder, variables)

    bill = json.loads((folder / "out" / "sbom.json").read_text(encoding="utf-8"))

    lock = (ROOT / "requirements.lock").read_text(encoding="utf-8").lower()
    locked = set(re.findall(r"^([a-z0-9._-]+)==(\S+)", lock, re.MULTILINE))
    listed = {
        (part["name"].lower().replace("_", "-"), part["version"]) for part in bill["components"]
    }
    assert {"pyoxigraph", "pybullet", "matplotlib"} <= {name for name, _ in listed}
    assert "pytest" not in {name for name, _ in listed}
    assert listed <= locked
    assert bill["metadata"]["component"]["name"] == "hilt"
