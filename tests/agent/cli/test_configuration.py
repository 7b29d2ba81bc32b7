"""Claims about `hilt config`, and about commands that use what is configured."""

import json
from pathlib import Path

import pytest

from hilt.agent.cli import main


class Hilt:
    """Runs commands in a project, as the shell would."""

    def __init__(self, capfd: pytest.CaptureFixture[str]) -> None:
        self._capfd = capfd
        self.code, self.out, self.err = 0, "", ""

    def __call__(self, *arguments: str) -> "Hilt":
        """Run one command and keep its exit code and what it printed."""
        self._capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main(arguments)
        self.code = int(ended.value.code or 0)
        self.out, self.err = self._capfd.readouterr()
        return self


@pytest.fixture
def hilt(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Hilt:
    """The command line in an empty folder, for a user without a file."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    monkeypatch.delenv("HILT_KB", raising=False)
    (tmp_path / "project").mkdir()
    monkeypatch.chdir(tmp_path / "project")
    return Hilt(capfd)


def write_user_file(tmp_path: Path, text: str) -> None:
    """Write the user's own file."""
    (tmp_path / "home" / "hilt").mkdir(parents=True)
    (tmp_path / "home" / "hilt" / "hilt.toml").write_text(text, encoding="utf-8")


def test_values_are_shown_with_their_places(hilt: Hilt, tmp_path: Path):
    """For the user, or for the project, which goes before."""
    write_user_file(tmp_path, 'speaker = "anna"\n')
    Path("hilt.toml").write_text('speaker = "kim"\n', encoding="utf-8")

    shown = json.loads(hilt("config", "--json").out)
    assert shown["speaker"] == {
        "value": "kim",
        "from": "project",
        "place": f"{tmp_path / 'project' / 'hilt.toml'}:1",
    }
    assert shown["robot"] == {"value": "panda", "from": "default", "place": ""}

    Path("hilt.toml").unlink()
    lines = dict(line.split(maxsplit=1) for line in hilt("config", "show").out.splitlines())
    assert lines["speaker"].split() == ["anna", f"{tmp_path / 'home' / 'hilt' / 'hilt.toml'}:1"]


def test_path_of_the_file_is_told(hilt: Hilt, tmp_path: Path):
    """Also before it exists."""
    assert hilt("config", "path").out.strip() == str(tmp_path / "home" / "hilt" / "hilt.toml")


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ('speeker = "anna"', ':1:1: unknown key "speeker" (did you mean "speaker"?)'),
        ('seed = "high"', ':1:8: expected a whole number, found "high"'),
    ],
)
def test_mistake_in_the_file_ends_a_command(hilt: Hilt, line: str, error: str):
    """With its place."""
    Path("hilt.toml").write_text(line, encoding="utf-8")

    assert hilt("config").code == 2
    assert error in hilt.err


def test_commands_use_what_is_configured(hilt: Hilt, tmp_path: Path):
    """The base and the speaker of the project; options of the command go before."""
    Path("hilt.toml").write_text('base = "kb"\n', encoding="utf-8")
    write_user_file(tmp_path, 'speaker = "anna"\n')
    hilt("trust", "anna", "0.9")

    assert hilt("tell", "A mug is used for drinking").code == 0
    hilt("tell", "A knife is used for cutting", "--speaker", "sam")

    rules = json.loads(hilt("rules", "--json").out)
    assert {(rule["object"], rule["speaker"]) for rule in rules} == {
        ("mug", "anna"),
        ("knife", "sam"),
    }
    assert (tmp_path / "project" / "kb").is_dir()


def test_agent_is_made_as_configured(hilt: Hilt):
    """The scene of the project; --config and options go before it."""
    Path("hilt.toml").write_text('scene = "objects:mug"\n', encoding="utf-8")
    Path("other.toml").write_text('scene = "objects:nail"\n', encoding="utf-8")

    def seen(*options: str) -> str:
        asked = hilt("ask", "what do you see?", "--kb", "memory:", "--json", *options)
        return json.loads(asked.out)["said"]

    assert "mug" in seen()
    assert "nail" in seen("--config", "other.toml")
    assert "knife" in seen("--config", "other.toml", "--scene", "objects:knife")


def test_password_of_the_base_is_not_shown(hilt: Hilt):
    """Neither as text nor as JSON."""
    text = 'base = "http://anna:s3cret@host/query"\n'
    Path("hilt.toml").write_text(text, encoding="utf-8")

    for options in ((), ("--json",)):
        assert "http://***@host/query" in hilt("config", *options).out
        assert "s3cret" not in hilt.out + hilt.err
