"""Settings of the inference: accepted names, and mistakes reported with their position."""

from pathlib import Path

import pytest

from hilt.inference.interval_operators import (
    ACCEPTANCES,
    CONJUNCTIONS,
    FUSIONS,
    MODUS_PONENS,
    RANKINGS,
)
from hilt.inference.settings import DETECTIONS, STAGES, Settings
from hilt.ontology.errors import DataError

CHOICES = {
    "conjunction": tuple(CONJUNCTIONS),
    "modus_ponens": tuple(MODUS_PONENS),
    "fusion": tuple(FUSIONS),
    "ranking": tuple(RANKINGS),
    "acceptance": tuple(ACCEPTANCES),
    "stage": STAGES,
    "detection": DETECTIONS,
}
NAMED = [(choice, name) for choice, names in CHOICES.items() for name in names]


def chosen(settings: Settings, choice: str) -> str:
    """Return the chosen operators."""
    return getattr(settings if choice in {"stage", "detection"} else settings.operators, choice)


def written(tmp_path: Path, text: str) -> Path:
    """Return a file with this text."""
    path = tmp_path / "settings.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_settings_file_of_hilt_has_the_defaults():
    """The file has the values that are used without settings."""
    assert Settings.load() == Settings()


@pytest.mark.parametrize(("choice", "name"), NAMED)
def test_every_choice_can_be_made_in_a_file(tmp_path: Path, choice: str, name: str):
    """Each name of each operator is accepted."""
    assert chosen(Settings.load(written(tmp_path, f"{choice}: {name}\n")), choice) == name


@pytest.mark.parametrize(("choice", "name"), NAMED)
def test_every_choice_can_be_made_on_the_command_line(choice: str, name: str):
    """Each name of each operator is accepted as NAME=VALUE."""
    assert chosen(Settings().with_choices([f"{choice}={name}"]), choice) == name


def test_thresholds_are_read_from_a_file(tmp_path: Path):
    """There is a default threshold and one for each listed context."""
    text = "threshold: {default: 0.01, contexts: {pass: 0.2, 'place:hospital': 0.5}}\n"

    settings = Settings.load(written(tmp_path, text)).with_choices(["threshold.pass=0.3"])

    assert settings.threshold == 0.01
    assert settings.thresholds == {"pass": 0.3, "place:hospital": 0.5}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fusion: dempsta\n", r':1:9: There is no fusion "dempsta"\. Did you mean "dempster"\?'),
        ("fusoin: yager\n", r':1:1: unknown key "fusoin" \(did you mean "fusion"\?\)'),
        ("threshold: {default: 2}\n", r":1:22: expected a number in \[0, 1\], found 2"),
        ("threshold: {contexts: {}}\n", r':1:12: the key "default" is missing'),
        ("threshold: {default: 0, contexts: {'spot:x': 0}}\n", r':1:46: "spot" is no kind'),
        ("detection: sharp\n", r':1:12: There is no detection "sharp"'),
    ],
)
def test_mistake_in_a_file_is_reported_with_its_position(tmp_path: Path, text: str, message: str):
    """The message has line, column and what was expected, and the line with a caret."""
    with pytest.raises(DataError, match=r"settings\.yaml" + message) as told:
        Settings.load(written(tmp_path, text))

    assert told.value.excerpt().splitlines()[1].strip() == "^"


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ("fusion", "expected NAME=VALUE"),
        ("fusion=nonsense", 'There is no fusion "nonsense"'),
        ("fision=yager", 'Did you mean "fusion"'),
        ("threshold=much", "expected a number"),
        ("threshold.pass=-1", r"expected a number in \[0, 1\]"),
    ],
)
def test_mistake_on_the_command_line_is_reported(choice: str, message: str):
    """The message has the possible values."""
    with pytest.raises(DataError, match=message):
        Settings().with_choices([choice])


def test_shipped_settings_are_the_defaults():
    """Settings without a file, and those of the file that is shipped."""
    assert Settings.load() == Settings()


def test_threshold_of_a_file_needs_no_contexts(tmp_path: Path):
    """The general one stands alone."""
    assert Settings.load(written(tmp_path, "threshold: {default: 0.02}\n")).threshold == 0.02


def test_mistake_on_the_command_line_has_no_line():
    """The message begins with the choice."""
    with pytest.raises(DataError) as told:
        Settings().with_choices(["fusion=nonsense"])

    assert str(told.value).startswith('fusion=nonsense: There is no fusion "nonsense"')
    assert (told.value.line, told.value.column) == (0, 0)
