"""Claims about where the values of options come from."""

from pathlib import Path

import pytest

from hilt.agent.config_files import (
    KEYS,
    Configured,
    configured,
    lasting_values,
    project_file,
    user_file,
    variable,
)
from hilt.ontology.errors import DataError


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty project, in a folder of which the program runs, and a user without a file."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    for key in KEYS:
        monkeypatch.delenv(variable(key), raising=False)
    folder = tmp_path / "project" / "notes"
    folder.mkdir(parents=True)
    monkeypatch.chdir(folder)
    return tmp_path / "project"


def write_user_file(text: str) -> None:
    """Give the user a file."""
    user_file().parent.mkdir(parents=True, exist_ok=True)
    user_file().write_text(text, encoding="utf-8")


def test_without_files_all_are_defaults(project: Path):
    """No file is needed."""
    assert project_file() is None
    assert {each.origin for each in configured().values()} == {"default"}
    assert lasting_values() == {}


def test_environment_goes_before_project_before_user(
    project: Path, monkeypatch: pytest.MonkeyPatch
):
    """Each value says where it comes from."""
    write_user_file('robot = "kuka"\nspeaker = "anna"\nseed = 1\n')
    (project / "hilt.toml").write_text('speaker = "kim"\nseed = 2\n', encoding="utf-8")
    monkeypatch.setenv("HILT_SEED", "3")

    found = configured()

    assert found["robot"] == Configured("kuka", "user", f"{user_file()}:1")
    assert found["speaker"] == Configured("kim", "project", f"{project / 'hilt.toml'}:1")
    assert found["seed"] == Configured(3, "environment", "HILT_SEED")
    assert lasting_values() == {"robot": "kuka", "seed": 3}


def test_nearest_project_counts(project: Path):
    """A project within another has a file of its own."""
    for folder in (project, project / "notes"):
        (folder / "hilt.toml").write_text("seed = 1\n", encoding="utf-8")

    assert project_file() == project / "notes" / "hilt.toml"


def test_files_are_looked_up_beside_the_file_that_names_them(project: Path):
    """Not in the working folder; other names stay as they are."""
    (project / "hilt.toml").write_text(
        'base = "kb"\nlexicon = "words.yaml"\nscene = "table.yaml"\nrobot = "arm.yaml:left"\n',
        encoding="utf-8",
    )
    write_user_file('vision = "mask"\nnoise = "missed=0.1"\n')

    found = {name: each.value for name, each in configured().items()}

    assert found["base"] == str(project / "kb")
    assert found["lexicon"] == project / "words.yaml"
    assert found["scene"] == str(project / "table.yaml")
    assert found["robot"] == str(project / "arm.yaml:left")
    assert (found["vision"], found["noise"]) == ("mask", "missed=0.1")


@pytest.mark.parametrize("base", ["memory:", "http://localhost:3030/ds/query", "/var/kb"])
def test_base_may_be_elsewhere(project: Path, base: str):
    """Memory, an endpoint, or a folder with its whole path."""
    write_user_file(f'base = "{base}"\n')

    assert configured()["base"].value == base


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('robott = "kuka"', r'hilt.toml:1:1: unknown key "robott" \(did you mean "robot"\?\)'),
        ("seed = -1", r"hilt.toml:1:8: expected a number in \[0, "),
        ('seed = "3"', 'hilt.toml:1:8: expected a whole number, found "3"'),
        ("speaker = 3", "hilt.toml:1:11: expected a text, found 3"),
        ("contexts = ['kitchen']", "hilt.toml:1:12: expected KIND:NAME"),
    ],
)
def test_wrong_values_are_told_with_their_place(project: Path, text: str, error: str):
    """Whatever the command wanted to do."""
    write_user_file(text)

    with pytest.raises(DataError, match=error):
        configured()


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("HILT_SIMULATE", "false", False),
        ("HILT_CONTEXTS", "place:kitchen, role:guest", ("place:kitchen", "role:guest")),
        ("HILT_KB", "http://localhost/query", "http://localhost/query"),
        ("HILT_OBJECTS", "mine.yaml", Path("mine.yaml")),
    ],
)
def test_variables_have_values_of_each_type(
    project: Path, monkeypatch: pytest.MonkeyPatch, name: str, text: str, value: object
):
    """They are texts, and are read as the type of the option."""
    monkeypatch.setenv(name, text)

    assert [each.value for each in configured().values() if each.place == name] == [value]


def test_wrong_variable_is_named(project: Path, monkeypatch: pytest.MonkeyPatch):
    """It has no line."""
    monkeypatch.setenv("HILT_GUI", "perhaps")

    with pytest.raises(DataError, match=r'^HILT_GUI: expected true or false, found "perhaps"'):
        configured()
