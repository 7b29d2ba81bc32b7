"""The commands on files: export, import, validate, backup and restore."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

from hilt.agent.cli import main
from hilt.kb import KnowledgeBase

from .test_commands import LESSONS, Hilt
from .test_rules import RULES

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
    assert run("rules")[0] == 1  # there is none yet


READING = (
    *("rules", "history", "words", "actions", "episodes", "experience", "trust", "trust --suggest"),
    *("induce", "conflicts", "abduce affordance:cutting", "export -", "validate", "replay last"),
    *("query counts", "watch --for 0", "graph -", "backup saved"),
    "explain 'pass me the knife'",
)


@pytest.mark.parametrize("command", READING)
def test_base_that_is_not_there_is_said(run: Run, tmp_path: Path, command: str):
    """By every command that only reads: a line with the place and what to do; none is made."""
    code, out, error = run(*shlex.split(command))

    assert (code, out, error.count("\n")) == (1, "", 1)
    assert f'There is no knowledge base "{tmp_path / "base"}". Teach it' in error
    assert not (tmp_path / "base").exists()


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
    run("trust", "anna", "1")

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

    assert (code, error) == (1, "1 finding.\n")
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
    """With --json the findings are JSON on stdout, and the errors JSON on stderr."""
    rows = ("a,usedFor,b,2", "knife,usedFor,cutting,1", "knife,usedFor,x", "a,usedFor,b,high")
    text = "\n".join(("features,functor,argument,lower", *rows))

    code, out, error = validate("rules.csv", text, "--json")

    assert (code, [one["line"] for one in json.loads(out)]) == (2, [2, 4, 5])
    messages = [one["message"] for one in json.loads(error)["errors"]]
    assert [message.partition("rules.csv:")[2] for message in messages] == [
        "2: [2.0, 1.0] is not an interval: expected 0 <= lower <= upper <= 1.",
        "4: expected 4 cells, one for each column, found 3.",
        '5: expected a number as lower, found "high".',
    ]


def test_base_itself_is_checked(validate: Run, tmp_path: Path):
    """Without a file."""
    KnowledgeBase.open(tmp_path / "kb").close()
    assert validate() == (0, "", "Valid.\n")


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
