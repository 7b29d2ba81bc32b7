"""The tables of a language are kept for the next program."""

import subprocess
import sys
from pathlib import Path

import pytest

from hilt.nlu.language import LanguageTables, language_folder, load_tables
from hilt.ontology.errors import UnknownNameError


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cache of its own for each test."""
    monkeypatch.setenv("HILT_CACHE", str(tmp_path))


def english() -> LanguageTables:
    """The tables of English."""
    return load_tables(language_folder("english"))


def test_a_language_loaded_before_needs_no_parser():
    """The second program does not import it, nor YAML for it, and understands the same."""
    program = (
        "import sys; from hilt.nlu import Language;"
        "said = Language.load().understand('To pass a knife grab it by the blade');"
        "print('lark' in sys.modules, said.semantics)"
    )
    first, second = (
        subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True
        ).stdout.split(maxsplit=1)
        for _ in range(2)
    )

    assert (first[0], second[0]) == ("True", "False")
    assert first[1] == second[1]


def test_kept_tables_are_those_that_were_read():
    """All words come back with their entries, in their order."""
    read, kept = english(), english()

    assert read.grammar.signature == kept.grammar.signature
    for one, other in zip(
        read.builder.lexicon.senses(), kept.builder.lexicon.senses(), strict=True
    ):
        assert one[:3] == other[:3]
        assert one.entry()[:2] + one.entry()[3:] == other.entry()[:2] + other.entry()[3:]


def test_words_added_to_one_are_not_in_the_next():
    """Those of a lexicon file, or of a test, do not get into the cache."""
    one = english()
    one.builder.lexicon.add(one.builder.noun("object", "blorp"))

    assert "blorp" in one.builder.lexicon
    assert "blorp" not in english().builder.lexicon


def test_a_changed_file_is_read_again(tmp_path: Path):
    """The tables count as long as all files of the language are as they were."""
    folder = tmp_path / "german"
    folder.mkdir()
    for each in language_folder("english").iterdir():
        (folder / each.name).write_bytes(each.read_bytes())
    before = load_tables(folder)
    degree, words = next(iter(before.builder.qualifiers.items()))
    path = folder / "lexicon.yaml"
    text = path.read_text(encoding="utf-8").replace(words[0], "bestimmt")
    path.write_text(text, encoding="utf-8")

    assert "bestimmt" in load_tables(folder).builder.qualifiers[degree]


def test_an_unknown_language_is_an_error():
    """It names the known ones."""
    with pytest.raises(UnknownNameError, match="english"):
        language_folder("klingon")
