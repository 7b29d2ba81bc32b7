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


def test_value_is_kept_shown_and_removed(hilt: Hilt, tmp_path: Path):
    """For the user, or for the project, which goes before."""
    assert hilt("config", "set", "speaker", "anna").code == 0
    assert hilt("config", "set", "speaker", "kim", "--project").code == 0

    shown = json.loads(hilt("config", "--json").out)
    assert shown["speaker"] == {
        "value": "kim",
        "from": "project",
        "place": f"{tmp_path / 'project' / 'hilt.toml'}:1",
    }
    assert shown["robot"] == {"value": "panda", "from": "default", "place": ""}

    hilt("config", "set", "speaker", "--project")
    lines = dict(line.split(maxsplit=1) for line in hilt("config", "show").out.splitlines())
    assert lines["speaker"].split() == ["anna", f"{tmp_path / 'home' / 'hilt' / 'hilt.toml'}:1"]


def test_paths_of_the_files_are_told(hilt: Hilt, tmp_path: Path):
    """Also before they exist."""
    assert hilt("config", "path").out.strip() == str(tmp_path / "home" / "hilt" / "hilt.toml")
    assert hilt("config", "path", "--project").out.strip() == str(Path("hilt.toml").absolute())


@pytest.mark.parametrize(
    ("key", "value", "error"),
    [
        ("speeker", "anna", 'There is no key "speeker". Did you mean "speaker"?'),
        ("robot", "r2d2", 'There is no robot "r2d2". Known: kuka, panda.'),
        ("seed", "high", 'expected a whole number, found "high"'),
        ("scene", "objects:sabre", 'There is no object "sabre"'),
        ("lexicon", "nowhere.yaml", "nowhere.yaml: cannot be read"),
        ("overrides", "fusion=magic", "magic"),
    ],
)
def test_wrong_value_is_not_kept(hilt: Hilt, key: str, value: str, error: str):
    """It is refused when it is set, not when it is used."""
    refused = hilt("config", "set", key, value)

    assert refused.code != 0
    assert error in refused.err
    assert not Path(hilt("config", "path").out.strip()).exists()


def test_commands_use_what_is_configured(hilt: Hilt, tmp_path: Path):
    """The base and the speaker of the project; options of the command go before."""
    hilt("config", "set", "base", "kb", "--project")
    hilt("config", "set", "speaker", "anna")
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
    hilt("config", "set", "scene", "objects:mug", "--project")
    Path("other.toml").write_text('scene = "objects:nail"\n', encoding="utf-8")

    def seen(*options: str) -> str:
        asked = hilt("ask", "what do you see?", "--kb", "memory:", "--json", *options)
        return json.loads(asked.out)["said"]

    assert "mug" in seen()
    assert "nail" in seen("--config", "other.toml")
    assert "knife" in seen("--config", "other.toml", "--scene", "objects:knife")


def test_password_of_the_base_is_not_shown(hilt: Hilt):
    """Neither where it is set nor where it is shown."""
    done = hilt("config", "set", "base", "http://anna:s3cret@host/query", "--json")
    shown = hilt("config")

    assert "http://***@host/query" in shown.out
    assert "s3cret" not in done.out + done.err + shown.out + shown.err
