# SPDX-License-Identifier: Apache-2.0
"""The command that checks files and bases."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from hilt.agent.cli import main
from hilt.kb import KnowledgeBase

Run = Callable[..., tuple[int, str, str]]
HEAD = "".join(
    f"@prefix {kind}: <https://w3id.org/hilt/{kind}/> .\n"
    for kind in ("rule", "object", "affordance", "speaker")
)
HEAD += "@prefix hilt: <https://w3id.org/hilt#> .\n@prefix prov: <http://www.w3.org/ns/prov#> .\n"
RULE = """
rule:1 a hilt:FunctionalRule ; hilt:feature object:knife ; hilt:functor hilt:usedFor ;
    hilt:affordance affordance:cutting ; hilt:lower 0.95 ; hilt:upper 1.0 ;
    hilt:status hilt:active ; prov:wasAttributedTo speaker:sam .
"""


@pytest.fixture
def validate(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Run:
    """Writes a file of a name with a text and checks it; no text checks the base."""

    def call(name: str = "", text: str = "", *more: str) -> tuple[int, str, str]:
        file = tmp_path / name
        if name:
            file.write_text(text, encoding="utf-8")
        capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main(["validate", *([str(file)] if name else []), "--kb", str(tmp_path / "kb"), *more])
        return int(ended.value.code or 0), *capfd.readouterr()

    return call


def test_valid_file_passes(validate: Run):
    """Nothing on stdout, code 0."""
    assert validate("rules.ttl", HEAD + RULE) == (0, "", "Valid.\n")


def test_finding_tells_file_line_rule_and_what_was_expected(validate: Run):
    """So that a person can go there and mend it."""
    code, out, error = validate("rules.ttl", HEAD + RULE.replace("0.95", "1.5"))

    assert (code, error) == (1, "2 findings.\n")
    assert "rules.ttl:8: rule:1: hilt:lower is one decimal in [0, hilt:upper]" in out
    assert 'Found "1.5".' in out


def test_findings_as_json_name_the_property(validate: Run):
    """One object each."""
    text = HEAD + RULE.replace("hilt:active", "hilt:maybe")

    code, out, _ = validate("rules.ttl", text, "--json")

    found = json.loads(out)
    assert code == 1
    assert ("rule:1", "hilt:status", 8) in {(f["node"], f["property"], f["line"]) for f in found}


def test_fault_in_a_sheet_is_told_with_line_and_column(validate: Run):
    """A file that cannot be read is code 2."""
    text = "rules:\n  - {object: knife, affordance: cutting, interval: [0.95, 0.5]}\n"

    code, _, error = validate("rules.yaml", text)

    assert code == 2
    assert "rules.yaml:2:52: expected a lower bound and then an upper one" in error


def test_every_mistake_of_a_table_is_told(validate: Run):
    """A line each, and as JSON on stdout; the code is the same."""
    rows = ("a,usedFor,b,2", "knife,usedFor,cutting,1", "knife,usedFor,x", "a,usedFor,b,high")
    text = "\n".join(("features,functor,argument,lower", *rows))

    code, out, error = validate("rules.csv", text, "--json")

    assert (code, [one["line"] for one in json.loads(out)]) == (2, [2, 4, 5])
    assert [line.partition("rules.csv:")[2] for line in error.splitlines()] == [
        "2: [2.0, 1.0] is not an interval: expected 0 <= lower <= upper <= 1.",
        "4: expected 4 cells, one for each column, found 3.",
        '5: expected a number as lower, found "high".',
    ]


def test_base_itself_is_checked(validate: Run, tmp_path: Path):
    """Without a file; where there is none, none is made."""
    code, _, error = validate()

    assert (code, error.splitlines()[-1]) == (0, "Valid.") and "no knowledge base" in error
    assert not (tmp_path / "kb").exists()
    KnowledgeBase.open(tmp_path / "kb").close()
    assert validate() == (0, "", "Valid.\n")
