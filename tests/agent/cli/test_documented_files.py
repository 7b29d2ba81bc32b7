"""The YAML files that the documents show are used by commands, whatever kind of file they are."""

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from hilt.agent.cli import main

DOCS = Path(__file__).parents[3] / "docs"
BLOCKS = {
    f"{page.stem} {number}": block
    for page in sorted(DOCS.rglob("*.md"))
    for number, block in enumerate(
        re.findall(r"^```yaml\n(.*?)^```", page.read_text("utf-8"), re.DOTALL | re.M), start=1
    )
}
KINDS = {  # key of a file -> the option that takes it
    "trees": "--actions",
    "clutter": "--scene",
    "words": "--lexicon",
    "nouns": "--lexicon",
    "constructions": "--lexicon",
}


def run(*arguments: str) -> int:
    """The exit code of a command; any other error is raised."""
    with pytest.raises(SystemExit) as ended:
        main([*arguments, "--kb", "kb"])
    return int(ended.value.code or 0)


def options_for(file: Path, content: dict[str, Any]) -> list[str]:
    """How a command is given a file; rules are read into the base."""
    if "rules" in content:
        assert run("import", str(file)) == 0
        return []
    option = next((KINDS[key] for key in content if key in KINDS), None)
    if option or "objects" in content:
        return [option or "--objects", str(file)]
    (name, robot), *_ = content.items()
    assert "urdf" in robot, "say here which option takes such a file"
    return ["--robot", f"{file}:{name}"]


@pytest.mark.parametrize("block", BLOCKS.values(), ids=BLOCKS)
def test_file_is_used(block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """To do something and to explain it: with what the file names, and with a known object."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "shown.yaml"
    file.write_text(block, encoding="utf-8")
    content = yaml.safe_load(block)
    options = options_for(file, content)
    acts = ["pass me", "pick up", *content.get("trees", ())]

    assert run("tell", "A spoon is used for seasoning") == 0
    for text in [f"{act} the {name}" for act in acts for name in ("mug", "knife")]:
        assert run("do", "--no-sim", text, *options) in {0, 1}
        if "--robot" not in options:
            assert run("explain", text, *options) in {0, 1}
