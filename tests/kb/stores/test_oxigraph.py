"""Claims about stores in folders."""

from __future__ import annotations

import errno
import io
import multiprocessing
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from hilt.kb.rdf.terms import Quad, ungrouped
from hilt.kb.sparql.results import BooleanResult
from hilt.kb.stores import directory
from hilt.kb.stores.base import EmbeddedStore
from hilt.kb.stores.opening import open_store
from hilt.kb.stores.rdf_text import read_groups, write_rdf
from hilt.ontology.errors import DataError, StoreError
from hilt.ontology.vocabulary import PREFIXES, Iri

S, P, G = (Iri(f"urn:{name}") for name in "spg")
ONE = Quad(S, P, 1, G)


def test_folder_keeps_what_was_written(tmp_path: Path):
    """What is applied is there after closing and opening again; the folder is made with parents."""
    folder = tmp_path / "a" / "b"
    store = open_store(folder)
    store.apply(insert=[ONE])
    store.close()

    again = open_store(str(folder))

    assert list(again.quads()) == [ONE]
    again.close()


@pytest.mark.parametrize(
    "query",
    [
        "ASK { object:knife ?p ?o }",
        "ASK { ?s ?p ?o FILTER(<http://a/b#c> != ?s && ?s = object:knife) }",
        "ASK { ?s ?p ?o FILTER(1<xsd:integer(?o) && 3>xsd:integer(?o)) }",
        "ASK { GRAPH <urn:g> { ?s ?p '2'^^xsd:integer } }",
    ],
)
def test_prefixes_of_hilt_need_no_declaration(query: str):
    """Wherever they stand, also after an operator that looks like the beginning of an IRI."""
    with closing(open_store("memory:")) as store:
        store.apply(insert=[Quad(Iri(f"{PREFIXES['object']}knife"), P, 2, G)])

        assert store.run(query) == BooleanResult(True)


def test_folder_is_owned_by_one_process(tmp_path: Path):
    """A second process is told so in one line and changes nothing."""
    store = open_store(tmp_path / "store")
    program = (
        "import sys; from hilt.kb.stores.opening import open_store\n"
        "try: open_store(sys.argv[1])\n"
        "except OSError as error: print(error)"
    )

    said = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path / "store")],
        capture_output=True,
        text=True,
        check=True,
    ).stdout

    assert "is in use by another process" in said
    assert len(said.splitlines()) == 1
    store.close()


def test_reading_only_refuses_to_write(tmp_path: Path):
    """A base opened for reading shows what is there."""
    store = open_store(tmp_path / "store")
    store.apply(insert=[ONE])
    store.close()

    reading = open_store(tmp_path / "store", read_only=True)

    assert list(reading.quads()) == [ONE]
    with pytest.raises(StoreError, match="for reading only"):
        reading.apply(insert=[ONE])
    reading.close()


def test_reading_only_needs_a_base(tmp_path: Path):
    """Nothing is made when there is nothing to read."""
    with pytest.raises(StoreError, match="There is no knowledge base"):
        open_store(tmp_path / "none", read_only=True)

    assert not (tmp_path / "none").exists()


def test_file_is_no_folder(tmp_path: Path):
    """A file is not overwritten."""
    (tmp_path / "file").write_text("mine")

    with pytest.raises(StoreError, match="is a file"):
        open_store(tmp_path / "file")


def test_folder_with_other_files_is_left_alone(tmp_path: Path):
    """A folder that holds something else is never made a base."""
    (tmp_path / "letter.txt").write_text("mine")

    with pytest.raises(StoreError, match="holds other files"):
        open_store(tmp_path)

    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]


def test_unwritable_place_is_told():
    """A folder that cannot be made is an error, not a traceback of the engine."""
    with pytest.raises(StoreError, match="cannot be created"):
        open_store("/proc/hilt/kb")


@pytest.mark.parametrize("damage", [b"", b"MANIFEST-999999\n", b"garbage"])
def test_damaged_folder_is_told(tmp_path: Path, damage: bytes):
    """Damage is an error that says what to do."""
    open_store(tmp_path / "store").close()
    (tmp_path / "store" / "CURRENT").write_bytes(damage)

    with pytest.raises(StoreError, match=r"is damaged or cannot be read.*Restore it"):
        open_store(tmp_path / "store")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_store_is_not_used_after_a_fork(tmp_path: Path):
    """A child of a fork is refused, so that two processes never write one folder."""
    store = open_store(tmp_path / "store")
    told = multiprocessing.get_context("fork").Queue()

    def child() -> None:
        try:
            store.apply(insert=[ONE])
        except StoreError as error:
            told.put(str(error))

    process = multiprocessing.get_context("fork").Process(target=child)
    process.start()

    assert "opened by another process" in told.get(timeout=10)
    process.join()
    store.close()


def read(text: bytes) -> list[object]:
    """The statements of a text of Turtle."""
    return list(
        ungrouped(read_groups(io.BytesIO(text), format="turtle", source="x.ttl", default=G))
    )


def test_text_is_loaded_into_the_default_graph():
    """Statements that name no graph get one."""
    assert read(b"<urn:s> <urn:p> 1 .") == [ONE]


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [
        (b"<urn:s> <urn:p> ;", 1, 17),
        (b"<urn:s> <urn:p> 1 .\n<urn:s> x:p 1 .", 2, 9),
        (b'\n<urn:s> <urn:p> "a', 2, 17),
    ],
)
def test_mistake_in_a_text_has_its_place(text: bytes, line: int, column: int):
    """File, line and column, and the line itself."""
    with pytest.raises(DataError) as caught:
        read(text)

    assert (caught.value.source, caught.value.line, caught.value.column) == ("x.ttl", line, column)
    assert caught.value.excerpt().endswith("^")


def test_written_text_is_the_same_every_time():
    """Prefixes stand in a fixed order, and only those that are used."""
    quad = Quad(Iri("https://w3id.org/hilt/object/knife"), P, "part:x", G)

    written = write_rdf([quad], format="turtle").decode()

    assert written == write_rdf([quad], format="turtle").decode()
    assert written.startswith("@prefix object: <https://w3id.org/hilt/object/> .\n")


def test_what_was_not_loaded_to_its_end_leaves_no_files(tmp_path: Path):
    """Neither when loading fails, nor when the process was killed before."""
    store = open_store(tmp_path / "store")
    left = tmp_path / "store" / "bulk-1.sst"
    assert isinstance(store, EmbeddedStore)

    def failing() -> Iterator[bytes]:
        left.write_bytes(b"as the engine would")
        yield b"<urn:s> <urn:p> <urn:o> <urn:g> .\n"
        raise DataError("is wrong.", source="x")

    with pytest.raises(DataError, match="is wrong"):
        store.load(failing())
    assert not left.exists() and not list(store.quads())
    store.close()

    left.write_bytes(b"as a killed process would")
    open_store(tmp_path / "store").close()
    assert not left.exists()


def test_folder_on_a_full_disk_is_read_from_elsewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The snapshot stands among the temporary files then, and goes with its reader."""
    store = open_store(tmp_path / "store")
    store.apply(insert=[ONE])
    taken, places = directory._copy_file, list[Path]()

    def full(source: Path, target: Path) -> None:
        places.append(target.parent)
        if target.is_relative_to(tmp_path):
            raise OSError(errno.ENOSPC, "No space left on device")
        taken(source, target)

    monkeypatch.setattr(directory, "_copy_file", full)
    with closing(open_store(tmp_path / "store", read_only=True)) as reader:
        assert list(reader.quads()) == [ONE]

    assert len({*places}) == 2 and not any(place.exists() for place in places)
    store.close()
