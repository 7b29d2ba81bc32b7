"""The commands about language: `hilt parse` and `hilt lexicon`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from hilt.agent.cli import main

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def hilt(capfd: pytest.CaptureFixture[str]) -> Run:
    """Runs a command: its exit code, and what it printed on stdout and stderr."""

    def run(*arguments: str) -> tuple[int, str, str]:
        capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main(arguments)
        out, err = capfd.readouterr()
        return int(ended.value.code or 0), out, err

    return run


def test_parse_prints_one_document(hilt: Run) -> None:
    """The keys are those of the contract."""
    code, out, _ = hilt("parse", "--json", "To pass a knife grab the knife by the blade")

    document = json.loads(out)

    assert code == 0
    assert list(document) == [
        "text", "speaker", "addressee", "semantics", "pragmatics", "kind", "meaning", "new_words",
        "readings",
    ]  # fmt: skip


def test_parse_hears_what_was_said_before(hilt: Run) -> None:
    """In the same throw-away session: words, "it", corrections."""
    _, out, _ = hilt(
        "parse", "--json", "pass it to me",
        "--before", "A saw is used for slicing", "--before", "Saws are passed by the handle",
    )  # fmt: skip

    assert json.loads(out)["meaning"] == {"goal": "pass", "target": {"object": "saw"}}


def test_parse_reads_a_file_of_cases(hilt: Run, tmp_path: Path) -> None:
    """One result line for each line, each in a session of its own."""
    cases = [
        {"text": "pass it to me", "before": ["A knife is used for cutting"]},
        {"text": "pass it to me"},
        {"text": "xyzzy plugh"},
    ]
    path = tmp_path / "cases.jsonl"
    path.write_text("\n".join(map(json.dumps, cases)) + "\n\n", encoding="utf-8")

    code, out, _ = hilt("parse", "--jsonl", str(path))

    kinds = [json.loads(line)["kind"] for line in out.splitlines()]
    assert (code, kinds) == (0, ["command", "ask_back", "error"])


@pytest.mark.parametrize("line", ["{", "[]", '{"before": []}', '{"text": 1}', '"pass me"'])
def test_parse_tells_a_bad_line(hilt: Run, tmp_path: Path, line: str) -> None:
    """With file and line, and exit code 2."""
    path = tmp_path / "cases.jsonl"
    path.write_text(f'{{"text": "hello"}}\n{line}\n', encoding="utf-8")

    code, _, err = hilt("parse", "--jsonl", str(path))

    assert code == 2
    assert "cases.jsonl:2" in err


def test_parse_draws(hilt: Run, tmp_path: Path) -> None:
    """`--svg` writes the derivation."""
    path = tmp_path / "knife.svg"

    hilt("parse", "pass me the knife", "--svg", str(path))

    assert "<svg" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("picture", "said"),
    [("no/knife.svg", "cannot be written"), ("knife.png", "expected a file ending in .svg")],
)
def test_parse_tells_what_cannot_be_drawn(
    hilt: Run, tmp_path: Path, picture: str, said: str
) -> None:
    """One line, and exit code 2."""
    code, _, err = hilt("parse", "pass me the knife", "--svg", str(tmp_path / picture))

    assert (code, len(err.splitlines())) == (2, 1)
    assert said in err


@pytest.mark.parametrize(
    ("said", "code"),
    [("to pass a knife", 1), ("you might pass a knife by the blade", 1), ("put it down", 0)],
)
def test_parse_fails_on_what_it_does_not_understand(hilt: Run, said: str, code: int) -> None:
    """Exit code 1, also for what is asked back; a control word needs no derivation."""
    assert hilt("parse", "--json", said)[0] == code


def test_a_lexicon_of_ones_own_is_used(hilt: Run, tmp_path: Path) -> None:
    """Checked, and added to English."""
    path = tmp_path / "garden.yaml"
    path.write_text("nouns:\n  object: [trowel]\n", encoding="utf-8")

    assert hilt("lexicon", "check", str(path))[0] == 0
    _, out, _ = hilt("parse", "--json", "pass me the trowel", "--lexicon", str(path))
    assert json.loads(out)["meaning"]["target"] == {"object": "trowel"}


def test_a_mistake_in_a_lexicon_is_told(hilt: Run, tmp_path: Path) -> None:
    """File, line, column, and what was expected."""
    path = tmp_path / "garden.yaml"
    path.write_text('words:\n  - {says: [trowel], is: ["N : trowl"]}\n', encoding="utf-8")

    code, _, err = hilt("lexicon", "check", str(path))

    assert code == 2
    assert "garden.yaml:2:" in err
    assert '"trowl" is neither bound nor declared' in err


def test_a_pattern_that_mixes_values_of_a_feature_is_told(hilt: Run, tmp_path: Path) -> None:
    """File, line, column, the pattern, and the two values; exit code 2."""
    path = tmp_path / "garden.yaml"
    path.write_text(
        'words:\n  - {says: "(you|they) can [always]", is: "V/V : λv.v"}\n', encoding="utf-8"
    )

    code, out, err = hilt("lexicon", "check", str(path))

    assert (code, out) == (2, "")
    assert "garden.yaml:2:" in err
    assert all(each in err for each in ('"(you|they) can [always]"', "agent", "addressee", "they"))


def test_the_lexicon_is_listed(hilt: Run) -> None:
    """Words, category and term."""
    _, out, _ = hilt("lexicon", "list", "knife", "--json")

    assert {"words": "knife", "category": "N", "term": "knife"} in json.loads(out)


def test_a_word_without_entry_is_told(hilt: Run) -> None:
    """A line on stderr; nothing is listed."""
    assert hilt("lexicon", "list", "zzz") == (1, "", 'hilt: No entry has the word "zzz".\n')


def test_a_grammar_is_printed(hilt: Run) -> None:
    """In the format of speech recognisers."""
    assert hilt("lexicon", "grammar", "--jsgf")[1].startswith("#JSGF V1.0")
