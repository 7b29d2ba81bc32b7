"""The command line: contracts of its JSON and exit codes, and what bad input does."""

import io
import json
import logging
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from contextlib import nullcontext
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest
import typer

from hilt.agent import Agent
from hilt.agent.cli import app, main

LESSONS = (
    "A knife is used for cutting",
    "To pickup a knife grab the knife by the handle",
    "To pass a knife grab the knife by the blade",
)
RULE_KEYS = {
    "id", "kind", "object", "affordance", "context", "part", "lower", "upper", "speaker",
}  # fmt: skip


class Hilt:
    """Runs commands on one knowledge base, as the shell would."""

    def __init__(self, kb: Path, capfd: pytest.CaptureFixture[str]) -> None:
        self.kb, self._capfd = kb, capfd
        self.code, self.out, self.err = 0, "", ""

    def __call__(self, *arguments: str) -> "Hilt":
        """Run one command and keep its exit code and what it printed."""
        self._capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([*arguments, "--kb", str(self.kb)])
        self.code = int(ended.value.code or 0)
        self.out, self.err = self._capfd.readouterr()
        return self

    @property
    def document(self):
        """What was printed, which must be one JSON document and nothing else."""
        return json.loads(self.out)


@pytest.fixture
def hilt(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Hilt:
    """The command line over a base of its own."""
    return Hilt(tmp_path / "kb", capfd)


@pytest.fixture
def taught(hilt: Hilt) -> Hilt:
    """The same after the three sentences of the running example."""
    for sentence in LESSONS:
        assert hilt("tell", sentence).code == 0
    return hilt


# --- The log ----------------------------------------------------------------------------------


def test_log_is_written_to_stderr_only_when_it_is_wanted(taught: Hilt):
    """With --verbose it has what was asked of the store, what was looked for, and times."""
    quiet = taught("do", "pass me something used for cutting", "--no-sim", "--json")
    assert quiet.err == ""

    loud = taught("do", "--verbose", "pass me something used for cutting", "--no-sim", "--json")

    assert loud.document["said"] == "I would pass the knife by the blade."
    assert "hilt.kb.stores.oxigraph: query SELECT" in loud.err
    looked = "hilt.agent.execution.action_tree_executor: look for object:knife"
    assert f"{looked}: [<Percept knife, knife 1.00>] [" in loud.err
    assert re.search(r"hilt\.agent\.config: open the knowledge base .* \[[\d.]+ ms\]", loud.err)
    assert not logging.getLogger("hilt").handlers


# --- Contracts -----------------------------------------------------------------------------


def test_tell_prints_the_contract(hilt: Hilt):
    """The keys of `hilt tell --json` are fixed."""
    document = hilt("tell", "--json", LESSONS[2]).document

    assert set(document) == {"utterance", "accepted", "said", "rules", "new_words"}
    assert document["accepted"] is True
    (rule,) = document["rules"]
    assert set(rule) == RULE_KEYS
    assert (rule["kind"], rule["object"], rule["context"], rule["part"]) == (
        "action", "knife", "pass", "blade",
    )  # fmt: skip
    assert (rule["lower"], rule["upper"], rule["affordance"]) == (0.95, 1.0, None)


def test_do_prints_the_contract(taught: Hilt):
    """The keys of `hilt do --json` are fixed."""
    document = taught("do", "--no-sim", "--json", "pass me something used for cutting").document

    assert set(document) == {
        "utterance", "goal", "outcome", "said", "decision", "steps", "world", "seed",
    }  # fmt: skip
    assert document["goal"] == "pass(self,usedFor(something,cutting))"
    assert document["outcome"] == "done"
    assert document["world"] == {"executed": False}
    decision = document["decision"]
    assert set(decision) == {
        "object", "part", "lower", "upper", "lambda", "threshold", "candidates", "ties", "rules",
    }  # fmt: skip
    assert (decision["object"], decision["part"]) == ("knife", "blade")
    assert decision["candidates"][0]["accepted"] is True
    assert all(rule.startswith("rule/") for rule in decision["rules"])
    assert set(document["steps"][1]) >= {"node", "features", "percepts", "constraint"}


def test_alternatives_are_read_back_with_their_certainty(hilt: Hilt, tmp_path: Path):
    """Of what may have been heard nothing is believed that is not sure; a file may hold it."""
    file = tmp_path / "heard.json"
    file.write_text('[["A knife is used for cutting", 0.6], {"text": "x", "score": 1e-05}]')

    asked = hilt("tell", "--json", LESSONS[0], "--alternatives", f"@{file}")

    assert (asked.code, asked.document["accepted"], asked.document["heard"]) == (1, False, 0.6)
    sure = hilt("tell", "--json", LESSONS[0], "--alternatives", f'[["{LESSONS[0]}", 0.95]]')
    assert (sure.code, sure.document["accepted"], sure.document["heard"]) == (0, True, 0.95)
    done = hilt("do", "--no-sim", "--json", "stop", "--alternatives", '[["stop", 0]]').document
    assert (done["outcome"], done["heard"]) == ("done", 0)


@pytest.mark.parametrize(
    ("given", "place", "problem"),
    [
        ('[["a", 0.5], ["b", 2]]', "--alternatives:1:14", "a score in [0, 1]"),
        ('[["a", 0.5], ["b", true]]', "--alternatives:1:14", "a score in [0, 1]"),
        ('[["a", 0.5], ["b", NaN]]', "--alternatives:1:14", "a score in [0, 1]"),
        ('[{"text": "a"}]', "--alternatives:1:2", "a score in [0, 1]"),
        ('[["a", 0.5]', "--alternatives:1:12", "is not JSON"),
        ('{"a": 1}', "--alternatives:1:1", "expected a list"),
        ("[]", "--alternatives:1:1", "at least one text"),
        ("@missing.json", "missing.json", "cannot be read"),
    ],
)
def test_wrong_alternatives_are_reported_with_their_place(
    hilt: Hilt, given: str, place: str, problem: str
):
    """A line on stderr says where and what was expected, and nothing is heard."""
    failed = hilt("tell", "a", "--alternatives", given)

    assert (failed.code, failed.out) == (2, "")
    assert failed.err.startswith(f"hilt: {place}") and problem in failed.err
    assert failed.err.count("\n") == 1


def test_alternatives_go_with_one_utterance(hilt: Hilt):
    """Lines of stdin have none."""
    failed = hilt("tell", "-", "--alternatives", '[["a", 1]]')

    assert failed.code == 2 and "one utterance" in failed.err


def test_rejected_candidates_are_listed_with_reasons(hilt: Hilt):
    """What was not chosen is told, with why."""
    hilt("tell", "A knife is used for cutting")
    hilt("tell", "A spoon is never used for cutting")

    document = hilt("do", "--no-sim", "--json", "pass me something used for cutting").document

    spoon = document["decision"]["candidates"][1]
    assert (spoon["object"], spoon["accepted"]) == ("spoon", False)
    assert "speaks against it" in spoon["reason"]


def test_rules_are_listed_as_tell_gave_them(taught: Hilt):
    """`hilt rules --json` is a list of the same rules."""
    document = taught("rules", "--json").document

    assert [rule["part"] for rule in document] == [None, "handle", "blade"]
    assert all(set(rule) == RULE_KEYS for rule in document)


def test_parse_prints_the_meaning_schema(hilt: Hilt):
    """`hilt parse --json` shows every stage."""
    document = hilt_parse("parse", "--json", LESSONS[2], hilt)

    assert document["semantics"] == (
        "STATEMENT(sam,self,implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high))"
    )
    assert document["meaning"]["part"] == "blade"


def hilt_parse(*arguments) -> dict:
    """Run `hilt parse`, which has no knowledge base."""
    *words, hilt = arguments
    with pytest.raises(SystemExit):
        main(words)
    return json.loads(hilt._capfd.readouterr().out)


def test_query_prints_sparql_results_json(taught: Hilt):
    """`hilt query --json` is the W3C document."""
    text = "SELECT ?part { GRAPH ?g { ?rule a hilt:ActionRule ; hilt:part ?part } } ORDER BY ?part"

    document = taught("query", "--json", text).document

    values = [row["part"]["value"] for row in document["results"]["bindings"]]
    assert document["head"] == {"vars": ["part"]}
    assert values == ["https://w3id.org/hilt/part/blade", "https://w3id.org/hilt/part/handle"]


def test_options_may_lead_the_command(taught: Hilt, capfd: pytest.CaptureFixture[str]):
    """`hilt --kb X --json rules` is `hilt rules --kb X --json`."""
    with pytest.raises(SystemExit):
        main(["--kb", str(taught.kb), "--json", "rules"])

    assert len(json.loads(capfd.readouterr().out)) == 3


@pytest.mark.parametrize(
    "words", [("--json", "config", "show"), ("config", "--json", "show"), ("--json", "config")]
)
def test_options_may_lead_the_command_of_a_group(
    words: tuple[str, ...], capfd: pytest.CaptureFixture[str]
):
    """Before the group, and between the two words."""
    with pytest.raises(SystemExit):
        main(words)

    assert json.loads(capfd.readouterr().out)["speaker"]


def test_film_of_what_is_done_is_announced(
    hilt: Hilt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Beside the JSON, whether it was done or not."""
    monkeypatch.setattr(Agent, "filmed", lambda *_: nullcontext())
    film = str(tmp_path / "a.gif")

    done = hilt("do", "frobnicate", "--record", film, "--json")

    assert (done.code, done.document["outcome"]) == (1, "not_understood")
    assert f"Film written to {film}.\n" in done.err


def test_dash_reads_one_utterance_a_line(hilt: Hilt, monkeypatch: pytest.MonkeyPatch):
    """A batch prints one JSON line for each utterance."""
    text = "\n".join((LESSONS[0], "", "gibberish blah", LESSONS[1])).encode()
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text)))

    lines = [json.loads(line) for line in hilt("tell", "--json", "-").out.splitlines()]

    assert [line["accepted"] for line in lines] == [True, False, True]
    assert hilt.code == 1


def test_tables_are_printed_for_people(taught: Hilt):
    """Without `--json` the same is shown as text."""
    assert "by the blade" in taught("do", "--no-sim", "pass me something used for cutting").out
    assert "graspObject" in taught("rules").out
    assert "handle" in taught("query", "SELECT ?o { GRAPH ?g { ?s hilt:part ?o } }").out


def test_lines_down_a_pipe_are_as_long_as_they_need(taught: Hilt, monkeypatch: pytest.MonkeyPatch):
    """Nothing is cut or padded; who exports COLUMNS gets lines of that length."""
    monkeypatch.delenv("COLUMNS", raising=False)
    long = "A spoon is used for stirring, " * 5
    shown = taught("tell", long).out + taught("do", "--no-sim", "pass me the knife").out

    assert f"  {long.strip()}" in shown
    assert [line for line in shown.splitlines() if line != line.rstrip()] == []

    monkeypatch.setenv("COLUMNS", "60")
    assert max(map(len, taught("tell", long).out.splitlines())) <= 60


@pytest.mark.parametrize(("no_color", "is_styled"), [("", True), ("1", False)])
def test_no_color_leaves_out_bold_and_dim_too(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    no_color: str,
    is_styled: bool,
):
    """On a terminal."""
    monkeypatch.setenv("NO_COLOR", no_color)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)

    with pytest.raises(SystemExit):
        main(["tell", "hello", "--kb", "memory:"])

    assert ("\x1b[1" in capsys.readouterr().out) == is_styled


def test_export_and_import_carry_the_rules_over(taught: Hilt, tmp_path: Path):
    """What one base exports another one knows."""
    taught("export", str(tmp_path / "rules.ttl"))
    before = taught("rules", "--json").document
    other = Hilt(tmp_path / "other", taught._capfd)

    assert other("import", str(tmp_path / "rules.ttl")).code == 0

    ids = {rule["id"] for rule in other("rules", "--json").document}
    assert ids == {rule["id"] for rule in before}


def test_trust_lets_another_speaker_teach(hilt: Hilt):
    """Nobody but sam is believed until somebody says so."""
    refused = hilt("tell", "--speaker", "kim", LESSONS[0]).code
    hilt("trust", "kim", "0.9")

    assert (refused, hilt("tell", "--speaker", "kim", LESSONS[0]).code) == (1, 0)


def test_chat_talks_down_a_pipe(hilt: Hilt, monkeypatch: pytest.MonkeyPatch):
    """A script of utterances and slash commands is a conversation."""
    script = io.StringIO(f"{LESSONS[0]}\npass me something used for cutting\n/rules\n/quit\nno\n")
    monkeypatch.setattr(sys, "stdin", script)

    out = hilt("chat", "--no-sim").out

    assert "I would pass the knife." in out
    assert "usedFor" in out
    assert "not understood" not in out


def test_options_of_the_command_line_replace_those_of_the_file(taught: Hilt, tmp_path: Path):
    """`--config` reads options from YAML; those that are given explicitly win."""
    file = tmp_path / "agent.yaml"
    file.write_text("scene: objects:mug\nsimulate: false\nseed: 4\n", encoding="utf-8")
    request = ("do", "--json", "pass me something used for cutting", "--config", str(file))

    alone = taught(*request).document
    replaced = taught(*request, "--scene", "objects:knife").document

    assert (alone["outcome"], alone["seed"]) == ("failed", 4)
    assert (replaced["decision"]["object"], replaced["seed"]) == ("knife", 4)


# --- Bad input -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["tell", ""], 1, "I didn't hear anything"),
        (["tell", "x" * 10_000], 1, "That is too long for me"),
        (["tell", "To pass a knife grab"], 1, "I can't do anything with"),
        (["do", "--no-sim", "--scene", "objects:kniife", "hi"], 2, 'Did you mean "knife"'),
        (["do", "--no-sim", "--scene", "none.yaml", "hi"], 2, "none.yaml: cannot be read"),
        (["do", "--no-sim"], 2, "Missing argument 'text'"),
        (["do", "--seed", "x", "hi"], 2, "Invalid value for '--seed'"),
        (["frobnicate"], 2, "No such command 'frobnicate'"),
        (["query", "SELECT ?x WHERE {"], 2, "The query is wrong at line 1"),
        (["query", "none.rq"], 2, "none.rq: cannot be read"),
        (["query", "SELECT * { SERVICE <http://127.0.0.1:1/> { ?s ?p ?o } }"], 2, "SERVICE"),
        (["import", "none.ttl"], 2, "none.ttl: cannot be read"),
        (["export", "rules.xyz"], 2, "names no format"),
        (["trust", "sam", "1.5"], 2, "Invalid value for"),
        (["trust", "", "1"], 1, "is no speaker's name"),
    ],
)
def test_bad_input_is_told_in_one_line_and_changes_nothing(
    taught: Hilt, arguments: list[str], code: int, message: str
):
    """One line on stderr, the right exit code, the same rules as before."""
    before = taught("rules", "--json").out

    result = taught(*arguments)

    assert (result.code, result.out) == (code, "")
    assert result.err.startswith("hilt: ")
    assert message in result.err
    assert result.err.count("\n") == 1
    assert taught("rules", "--json").out == before


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("@prefix a: <b> . c d", "rules.ttl:1"),
        ("<urn:a> <urn:b> <urn:c> .", ""),
        ("\x00\x01", "rules.ttl"),
    ],
)
def test_bad_file_is_refused_whole(taught: Hilt, tmp_path: Path, text: str, message: str):
    """A file with a mistake changes nothing, and its place is told."""
    (tmp_path / "rules.ttl").write_text(text, encoding="utf-8")
    before = taught("export", "-").out

    result = taught("import", str(tmp_path / "rules.ttl"))

    assert result.code in {1, 2}
    assert message in result.err
    assert taught("export", "-").out == before


def test_reversed_interval_is_refused(taught: Hilt, tmp_path: Path):
    """A rule that says [0.9, 0.1] does not come in."""
    taught("export", str(tmp_path / "rules.ttl"))
    text = (tmp_path / "rules.ttl").read_text()
    wrong = re.sub(r"hilt:upper \S+", "hilt:upper 0.1", text)
    (tmp_path / "rules.ttl").write_text(wrong)

    result = taught("import", str(tmp_path / "rules.ttl"))

    assert result.code in {1, 2}
    assert "hilt:lower is one decimal in [0, hilt:upper]" in result.err
    assert all(line.startswith("hilt: ") for line in result.err.splitlines())
    assert all(rule["lower"] == 0.95 for rule in taught("rules", "--json").document)


def test_folder_that_cannot_be_written_is_told(hilt: Hilt, tmp_path: Path):
    """A base where there is no place for one is an error in one line."""
    (tmp_path / "file").write_text("x")
    hilt.kb = tmp_path / "file" / "kb"

    result = hilt("tell", LESSONS[0])

    assert (result.code, result.err.count("\n")) == (1, 1)
    assert "cannot be created" in result.err


def test_debug_shows_the_traceback_and_changes_nothing_else(hilt: Hilt):
    """The place in the code comes on request; the last line and the exit code are as without."""
    wrong = ("do", "--no-sim", "--scene", "objects:x", "hi")
    plain = hilt(*wrong).err

    shown = hilt("--debug", *wrong)

    assert shown.code == 2
    assert shown.err.startswith("Traceback") and shown.err.endswith(plain)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["tel"], "hilt: No such command 'tel'. Did you mean 'tell'? Run: hilt --help"),
        (["tell"], "hilt: Missing argument 'text'. Run: hilt tell --help"),
        (["--kb", "mine"], "hilt: Missing command. Run: hilt --help"),
        (["forget", "word"], 'Which word? "hilt words" lists those that were learned.'),
    ],
)
def test_wrong_usage_names_the_help_that_tells_more(
    capfd: pytest.CaptureFixture[str], arguments: list[str], said: str
):
    """One line, and exit code 2."""
    with pytest.raises(SystemExit) as ended:
        main(arguments)

    told = capfd.readouterr().err
    assert (ended.value.code, len(told.splitlines())) == (2, 1)
    assert said in told


def _commands(group: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    for name, each in group.commands.items():
        if hasattr(each, "commands"):
            yield from _commands(each, (*path, name))
        else:
            yield (*path, name), each


@pytest.mark.parametrize(("path", "command"), [*_commands(typer.main.get_command(app))])
def test_help_shows_an_example_that_can_be_typed(path: tuple[str, ...], command: Any):
    """It begins as the command does, and its options are options of it."""
    words = shlex.split(command.epilog.partition(" > ")[0])

    assert tuple(words[: len(path) + 2]) == ("Example:", "hilt", *path)
    command.make_context(path[-1], words[len(path) + 2 :])


def test_version_is_shown(capfd: pytest.CaptureFixture[str]):
    """Who reports a mistake can say of which Hilt."""
    with pytest.raises(SystemExit) as ended:
        main(["--version"])

    assert not ended.value.code
    assert capfd.readouterr().out == f"hilt {version('hilt')}\n"


@pytest.mark.parametrize("speaker", ["Sam", "SAM"])
def test_capital_letters_make_nobody_a_stranger(hilt: Hilt, speaker: str):
    """Hilt calls them Sam, so a person types that."""
    document = hilt("tell", "--json", "--speaker", speaker, LESSONS[0]).document

    assert document["accepted"]
    assert document["rules"][0]["speaker"] == "sam"


def test_trust_goes_to_whom_it_was_given(hilt: Hilt):
    """However the name is written the second time."""
    hilt("trust", "Kim", "0.5")
    hilt("trust", "kim", "0.8")

    assert hilt("trust", "--json").document["Kim"]["lower"] == 0.8
    assert hilt("ask", "do you trust kim?").code == 0


@pytest.mark.parametrize("command", ["tell", "do", "ask"])
def test_lines_from_stdin_are_answered_in_json(
    hilt: Hilt, command: str, monkeypatch: pytest.MonkeyPatch
):
    """A line each, also where nobody asked for JSON."""
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"hello\n\nthanks\n")))

    lines = [json.loads(line) for line in hilt(command, "-").out.splitlines()]

    assert [line["utterance"] for line in lines] == ["hello", "thanks"]


@pytest.mark.parametrize(
    "arguments",
    [("import", "rules.yaml"), ("merge", "kb", "rules.yaml"), ("update", "INSERT DATA {}")],
)
def test_dry_run_makes_no_base(
    arguments: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """It says what would come of it, also where no base is yet, and leaves nothing behind."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HILT_KB", "kb")
    Path("rules.yaml").write_text("rules: [{object: knife, affordance: cutting, interval: 1}]")

    with pytest.raises(SystemExit) as ended:
        main([*arguments, "--dry-run"])

    assert not ended.value.code
    assert not Path("kb").exists()


def test_words_of_ones_own_are_spoken_with_the_robot(hilt: Hilt, tmp_path: Path):
    """A lexicon file counts wherever somebody talks; a mistake in it is told with its place."""
    mine, wrong = tmp_path / "mine.yaml", tmp_path / "wrong.yaml"
    mine.write_text("words: [{says: [toodeloo], is: ['ACK : thanks']}]")
    wrong.write_text("words: [{says: [toodeloo], is: ['ACK : thankyou']}]")

    assert hilt("tell", "--json", "toodeloo").document["said"].startswith("I don't know")
    assert hilt("tell", "toodeloo", "--lexicon", str(mine)).code == 0
    assert hilt("ask", "toodeloo", "--lexicon", str(mine)).code == 0
    assert hilt("do", "toodeloo", "--no-sim", "--lexicon", str(mine)).code == 0
    assert hilt("tell", "toodeloo", "--lexicon", str(wrong)).code == 2
    assert "wrong.yaml:1:" in hilt.err


def test_who_is_refused_hears_what_can_be_done(hilt: Hilt):
    """As long as nobody has said how far to trust that speaker."""
    assert "Run: hilt trust 'Kim Q' DEGREE" in hilt("tell", LESSONS[0], "--speaker", "Kim Q").err

    hilt("trust", "Kim Q", "0")

    assert hilt("tell", LESSONS[0], "--speaker", "Kim Q").err == ""


def test_mark_at_the_start_of_stdin_does_not_matter(hilt: Hilt, monkeypatch: pytest.MonkeyPatch):
    """Editors of Windows write one."""
    lines = io.TextIOWrapper(io.BytesIO(b"\xef\xbb\xbfhello\r\nhello\r\n"))
    monkeypatch.setattr("sys.stdin", lines)

    assert hilt("tell", "-").code == 0


def test_rules_are_shown_with_the_digits_that_forget_takes(taught: Hilt):
    """What is seen can be typed."""
    rule = taught("rules", "--json", "--object", "knife").document[0]["id"]
    digits = rule.removeprefix("rule/")[:8]

    assert digits in taught("rules").out
    assert taught("forget", digits).code == 0


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_full_disk_under_the_output_is_told():
    """A line and exit code 1, and no traceback."""
    with Path("/dev/full").open("w") as full:
        ended = subprocess.run(
            [
                sys.executable,
                "-c",
                "from hilt.agent.cli import main; main()",
                "words",
                "--kb",
                "memory:",
            ],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )

    assert ended.returncode == 1
    assert ended.stderr == "hilt: The output cannot be written: No space left on device.\n"


# --- As a process --------------------------------------------------------------------------


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run `hilt` in a process of its own."""
    return subprocess.run(
        [sys.executable, "-c", "from hilt.agent.cli import main; main()", *arguments],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | environment,
    )


def test_terminal_without_greek_letters_gets_them_spelt_out():
    """Rather than a traceback; in JSON it is the same text."""
    shown = run("parse", "pass me the knife", PYTHONIOENCODING="latin-1")

    assert shown.returncode == 0
    assert "\\u03bbx.pass(self,x)" in shown.stdout


def test_help_lists_every_command():
    """A newcomer finds all there is."""
    result = run("--help")

    commands = "demo tell do ask chat parse rules query export import trust evaluate"
    assert result.returncode == 0
    assert all(f"\n  {command} " in result.stdout for command in commands.split())


def test_help_imports_nothing_heavy():
    """The help must answer at once, so it pays for no engine."""
    code = (
        "import sys, contextlib, hilt.agent.cli as cli\n"
        "with contextlib.suppress(SystemExit): cli.main(['--help'])\n"
        "heavy = {'numpy', 'pyoxigraph', 'rdflib', 'yaml', 'pybullet', 'rich'}\n"
        "print(sorted(heavy & set(sys.modules)), file=sys.stderr)"
    )

    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )

    assert result.stderr.strip() == "[]"


def test_default_base_is_in_the_data_directory(tmp_path: Path):
    """Without `--kb` everybody has a base of their own."""
    result = run("tell", LESSONS[0], XDG_DATA_HOME=str(tmp_path), HILT_KB="")

    assert result.returncode == 0
    assert (tmp_path / "hilt" / "kb").is_dir()
