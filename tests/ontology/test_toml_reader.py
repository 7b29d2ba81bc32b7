"""Claims about flat TOML files."""

from pathlib import Path

import pytest

from hilt.ontology.errors import DataError
from hilt.ontology.yaml_reader import read_toml

FILE = """# who I am
speaker = "anna"   # as Hilt calls me
  seed = 3
contexts = [
  "place:kitchen",
  "role:guest",
]
help = '''
seed = 4
'''
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A file with each kind of value."""
    path = tmp_path / "hilt.toml"
    path.write_text(FILE, encoding="utf-8")
    return path


def test_values_have_their_places(file: Path):
    """Line and column of the value; what stands in a text of several lines is no key."""
    found = read_toml(file)

    assert found.value["contexts"].texts() == ("place:kitchen", "role:guest")
    assert found.value["help"].text() == "seed = 4\n"
    assert [(each.value, each.line, each.column) for each in found.keys] == [
        ("speaker", 2, 1),
        ("seed", 3, 3),
        ("contexts", 4, 1),
        ("help", 8, 1),
    ]
    assert (found.value["seed"].line, found.value["seed"].column) == (3, 10)


@pytest.mark.parametrize(
    ("text", "error", "caret"),
    [
        ('a = 1\nb = "x', r":2:7: is not TOML: ", 'b = "x\n      ^'),
        ("a = 1\na = 2", r":2:6: is not TOML: Cannot overwrite a value", "a = 2\n     ^"),
        ("a = 1\n[b]\nc = 2", r":2:1: expected KEY = VALUE; tables", "[b]\n^"),
        ("a.b = 2", r":1:1: expected KEY = VALUE; tables and keys with dots", "a.b = 2\n^"),
    ],
)
def test_mistakes_are_told_with_their_place(tmp_path: Path, text: str, error: str, caret: str):
    """File, line and column, and the line with a caret."""
    path = tmp_path / "hilt.toml"
    path.write_text(text, encoding="utf-8")

    with pytest.raises(DataError, match=error) as raised:
        read_toml(path)

    assert raised.value.excerpt() == caret
