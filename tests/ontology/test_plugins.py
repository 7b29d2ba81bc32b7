"""Claims about plug-ins: distributions that name them in entry points."""

import sys
from pathlib import Path

import pytest

from hilt.ontology.errors import DataError, PluginError, UnknownNameError
from hilt.ontology.plugins import call_plugin, plugin_names

MODULE = """
from hilt.ontology.errors import DataError

class Camera:
    def __init__(self, lens, zoom=1): self.lens, self.zoom = lens, zoom
    def search(self, features): return []

def broken(lens): raise RuntimeError("no power\\ncheck the plug")
def refusing(lens): raise DataError("no lens.", source="camera.yaml")
"""
ENTRY_POINTS = """
[hilt.vision]
good = strange_camera:Camera
broken = strange_camera:broken
refusing = strange_camera:refusing
absent = strange_camera:Nothing
lost = no_such_module:Camera
"""


@pytest.fixture(autouse=True)
def distribution(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An installed distribution with good and bad plug-ins."""
    files = {
        "strange_camera.py": MODULE,
        "strange_camera-2.1.dist-info/METADATA": "Name: strange-camera\nVersion: 2.1\n",
        "strange_camera-2.1.dist-info/entry_points.txt": ENTRY_POINTS,
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "strange_camera", raising=False)


def test_plugin_is_called_with_what_it_needs():
    """What it makes is returned."""
    made = call_plugin("hilt.vision", "good", "wide", methods=("search",), zoom=3)

    assert (made.lens, made.zoom, made.search([])) == ("wide", 3, [])


def test_unknown_name_lists_what_there_is():
    """Of the same group."""
    with pytest.raises(UnknownNameError, match="Known: absent, broken, good, lost, refusing"):
        call_plugin("hilt.vision", "godo", "wide")

    assert "good" in plugin_names("hilt.vision")
    assert plugin_names("hilt.no_such_group") == ()


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("broken", "RuntimeError: no power"),
        ("absent", "AttributeError: module 'strange_camera' has no attribute 'Nothing'"),
        ("lost", "ModuleNotFoundError: No module named 'no_such_module'"),
    ],
)
def test_broken_plugin_is_one_line_with_its_distribution(name: str, problem: str):
    """Whether it cannot be loaded or fails."""
    with pytest.raises(PluginError) as raised:
        call_plugin("hilt.vision", name, "wide")

    assert str(raised.value) == (
        f'The plug-in "{name}" (hilt.vision) of strange-camera 2.1 failed: {problem}.'
    )


def test_what_lacks_a_method_is_refused():
    """Before it is used."""
    with pytest.raises(PluginError, match="it makes a Camera, which lacks grasp, lift"):
        call_plugin("hilt.vision", "good", "wide", methods=("search", "grasp", "lift"))


def test_errors_of_hilt_are_passed_on():
    """A plug-in may say with them what is wrong with its own files."""
    with pytest.raises(DataError, match=r"camera.yaml: no lens"):
        call_plugin("hilt.vision", "refusing", "wide")
