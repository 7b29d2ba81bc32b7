# SPDX-License-Identifier: Apache-2.0
"""The commands backup and restore."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.kb import KnowledgeBase

from .test_commands import LESSONS, Hilt
from .test_query import RULES


@pytest.fixture
def taught(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Hilt:
    """The command line over a base that was taught the running example."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        for sentence, rule in zip(LESSONS, RULES, strict=True):
            kb.believe(sentence, "implies(x,y,high)", "sam", [rule])
    return Hilt(tmp_path / "kb", capfd)


def test_backup_is_restored(taught: Hilt, tmp_path: Path):
    """What was taught after the backup is gone afterwards; it must be said that it may be."""
    saved = taught("backup", str(tmp_path / "saved"), "--json").document
    taught("tell", "A spoon is used for stirring")
    refused = taught("restore", str(tmp_path / "saved")).code
    restored = taught("restore", str(tmp_path / "saved"), "--replace", "--json").document

    assert (saved["sequence"], refused, restored["sequence"]) == (3, 1, 3)
    assert len(taught("rules", "--json").document) == 3


def test_backup_can_be_asked_like_any_base(taught: Hilt, tmp_path: Path):
    """It is a folder like the base itself."""
    assert taught("backup", str(tmp_path / "saved")).code == 0
    assert "Saved up to utterance 3" in taught.err
    taught.kb = tmp_path / "saved"

    assert len(taught("rules", "--json").document) == 3


def test_what_is_no_backup_is_refused(taught: Hilt, tmp_path: Path):
    """One line, and the base is as it was."""
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "file").write_text("mine")

    for source in ("other", "nowhere"):
        taught("restore", str(tmp_path / source), "--replace")
        assert taught.code == 1 and len(taught.err.splitlines()) == 1
    assert taught("backup", str(tmp_path / "other")).code == 1
    assert len(taught("rules", "--json").document) == 3
