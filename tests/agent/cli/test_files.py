# SPDX-License-Identifier: Apache-2.0
"""Claims about `hilt export` and `hilt import`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from hilt.agent.cli import main

DOCUMENT = (Path(__file__).parents[3] / "docs" / "files.md").read_text(encoding="utf-8")
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """Runs one command on a base of its own: exit code, stdout, stderr."""
    monkeypatch.setenv("HILT_KB", str(tmp_path / "base"))

    def command(*arguments: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as ended:
            main(arguments)
        printed = capfd.readouterr()
        return int(ended.value.code or 0), printed.out, printed.err

    return command


@pytest.mark.parametrize("language", ["yaml", "csv", "turtle"])
def test_examples_of_the_document_are_read(run: Run, tmp_path: Path, language: str):
    """What `docs/files.md` shows is a file that can be imported."""
    text = DOCUMENT.partition(f"```{language}\n")[2].partition("```")[0]
    suffix = {"yaml": "yaml", "csv": "csv", "turtle": "ttl12"}[language]
    (tmp_path / f"rules.{suffix}").write_text(text)

    code, out, _ = run("import", str(tmp_path / f"rules.{suffix}"), "--json")

    expected = 1 if language == "turtle" else 3
    assert (code, json.loads(out)["new"]) == (0, expected)


def test_dry_run_says_what_would_come_and_changes_nothing(run: Run, tmp_path: Path):
    """In numbers, for a person and as JSON."""
    sheet = tmp_path / "rules.yaml"
    sheet.write_text("rules: [{object: knife, affordance: cutting, interval: 1}]")

    code, out, said = run("import", str(sheet), "--dry-run")

    assert (code, out) == (0, "")
    told = f"Would read 1 rule from {sheet}: 1 new, 0 already known, 0 conflicting.\n"
    assert said.splitlines(keepends=True)[1:] == [told]
    assert json.loads(run("rules", "--json")[1]) == []


def test_conflicts_and_untrusted_speakers_are_named(run: Run, tmp_path: Path):
    """What a person must know about an import."""
    rule = "{object: knife, affordance: cutting, interval: %s, speaker: %s}"
    (tmp_path / "a.yaml").write_text(f"rules: [{rule % ('[0.9, 1]', 'sam')}]")
    (tmp_path / "b.yaml").write_text(f"rules: [{rule % ('[0, 0.1]', 'eve')}]")
    run("import", str(tmp_path / "a.yaml"))

    _, _, said = run("import", str(tmp_path / "b.yaml"))

    assert "1 conflicting" in said
    assert "usedFor(cutting) [0.00, 0.10]> contradicts <Rule object:knife" in said
    assert "Nobody trusts eve" in said


def test_what_a_format_leaves_out_is_said(run: Run):
    """On stderr, so that stdout is the file."""
    code, out, said = run("export", "-", "--format", "csv")

    assert (code, out.count("\n")) == (0, 1)
    assert "leaves out all but the rules" in said


def test_rules_alone_are_exported_on_request(run: Run, tmp_path: Path):
    """Without the domain and the history of other things."""
    run("tell", "A knife is used for cutting")

    run("export", str(tmp_path / "base.nq.gz"))
    run("export", str(tmp_path / "rules.nq"), "--rules")

    assert "/object/hammer>" not in (tmp_path / "rules.nq").read_text()
    assert run("import", str(tmp_path / "base.nq.gz"))[0] == 0
