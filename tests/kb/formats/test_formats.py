"""Claims about the formats of files: what comes back, and what is refused."""

from __future__ import annotations

import codecs
import gzip
import io
from collections import deque
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rdflib import Graph

from hilt.kb.bulk import exporter, importer
from hilt.kb.formats import import_export
from hilt.kb.formats.file_streams import CheckedStream
from hilt.kb.formats.graphml import read_graphml, write_graphml
from hilt.kb.formats.import_export import (
    export_file,
    import_file,
    read_file,
    read_rules,
    read_statements,
)
from hilt.kb.formats.registry import FORMATS, RULE_FORMATS
from hilt.kb.formats.rule_yaml import read_sheet, write_sheet
from hilt.kb.formats.value_notation import read_table, write_table
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Rule, functional, grasping
from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import DataError, HiltError, ValidationError

from ..conftest import BLADE, CUTTING, import_text, teach, ticking
from ..strategies import rules

SHEET = """
speaker: sam
rules:
  - {object: knife, affordance: cutting, interval: [0.95, 1]}
  - {object: knife, context: pass, part: blade, interval: 0.95}
  - features: [mug, property:hot]
    contexts: [pass, place:kitchen]
    functor: moveTo
    argument: place:table
    interval: [0.6, 0.9]
    speaker: anna
"""


def fresh() -> KnowledgeBase:
    """An empty base."""
    return KnowledgeBase(open_store("memory:"), clock=ticking())


def contents(base: KnowledgeBase) -> set[object]:
    """All statements of a base."""
    return set(base.store.quads())


@pytest.fixture
def streamed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every file is large."""
    monkeypatch.setattr(exporter, "MAX_SORTED", 0)
    monkeypatch.setattr(import_export, "MAX_STAGED", 0)
    monkeypatch.setattr(importer, "_MAX_APPLIED", 0)


# --- Round trips


@given(st.lists(rules, max_size=5, unique_by=lambda rule: rule.id))
@settings(max_examples=20, deadline=None)
@pytest.mark.parametrize("name", sorted(FORMATS))
def test_rules_come_back_from_every_format(name: str, some: list[Rule]):
    """Everything that a rule says, in all formats."""
    base, again = fresh(), fresh()
    teach(base, *some)
    target = io.BytesIO()
    import_export.write_base(base.store, target, format=name)

    import_text(again, target.getvalue(), format=name, source=f"x.{name}")

    assert {rule.id for rule in again.rules()} == {rule.id for rule in base.rules()}


@pytest.mark.parametrize("suffix", ["trig", "nq", "jsonld", "trig.gz", "nq.gz"])
def test_whole_base_comes_back(paper: KnowledgeBase, tmp_path: Path, suffix: str):
    """Formats with named graphs carry every statement."""
    paper.record("pass me the knife", "", "sam", "command", accepted=True)
    export_file(paper, tmp_path / f"base.{suffix}")
    again = fresh()

    import_file(again, tmp_path / f"base.{suffix}")

    assert contents(again) == contents(paper)


@pytest.mark.parametrize("suffix", ["nq", "trig", "csv", "nt", "rdf"])
@pytest.mark.usefixtures("streamed")
def test_large_files_bring_the_same(paper: KnowledgeBase, tmp_path: Path, suffix: str):
    """What streams by is read as what is held in memory."""
    paper.retract(CUTTING.id, "Forget it.", "", "sam")
    export_file(paper, tmp_path / f"base.{suffix}")
    again = fresh()

    found = import_file(again, tmp_path / f"base.{suffix}")

    assert found.new == 3
    told = {rule.id: rule.status for rule in paper.rules(status=None)}
    assert {rule.id: rule.status for rule in again.rules(status=None)} == told
    assert import_file(again, tmp_path / f"base.{suffix}").known == 3


@pytest.mark.parametrize("suffix", ["nq", "trig.gz", "ttl", "nt", "csv", "yaml"])
@pytest.mark.usefixtures("streamed")
def test_large_folders_are_written_as_small_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
):
    """The engine writes them itself: the same statements, and as many of them."""
    with KnowledgeBase.open(tmp_path / "base") as base:
        teach(base, CUTTING, BLADE)
        base.retract(CUTTING.id, "Forget it.", "", "sam")
        count = export_file(base, tmp_path / f"large.{suffix}")
        monkeypatch.undo()

        assert export_file(base, tmp_path / f"small.{suffix}") == count

    large, small = (read_file(tmp_path / f"{size}.{suffix}") for size in ("large", "small"))
    assert set(large.quads()) == set(small.quads())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_full_disk_is_blamed_on_the_file(tmp_path: Path):
    """Where the engine writes it, too."""
    with (
        KnowledgeBase.open(tmp_path / "base") as base,
        Path("/dev/full").open("wb", buffering=0) as full,
        pytest.raises(OSError, match="space"),
    ):
        import_export.write_base(base.store, full, format="nquads")


@given(st.lists(rules, max_size=4, unique_by=lambda rule: rule.id))
@settings(deadline=None)
def test_sheet_and_table_and_graph_hold_whole_rules(some: list[Rule]):
    """As values, without a base between."""
    table, text = io.StringIO(), io.StringIO()
    write_table(table, some)
    write_sheet(text, some)

    assert list(read_sheet(text.getvalue(), source="x")) == some
    found = read_table(table.getvalue().splitlines(True), source="x")
    assert list(found) == some
    drawn = read_graphml(write_graphml(some), source="x")
    assert {rule.id for rule in drawn} == {rule.id for rule in some}


def test_sheet_is_written_by_hand():
    """A person leaves out what is plain, and can say the general form."""
    first, second, third = read_sheet(SHEET, source="x")

    assert (first.id, second.id) == (CUTTING.id, BLADE.id)
    assert repr(third) == (
        "<Rule pass, place:kitchen, object:mug, property:hot => moveTo(table) [0.60, 0.90]>"
    )
    assert third.speaker == "anna"


def test_annotated_edge_is_a_rule(kb: KnowledgeBase):
    """RDF 1.2: the edge says what the annotation leaves out."""
    text = """PREFIX hilt: <https://w3id.org/hilt#>
    PREFIX object: <https://w3id.org/hilt/object/>
    PREFIX affordance: <https://w3id.org/hilt/affordance/>
    object:knife hilt:usedFor affordance:cutting {| hilt:lower 0.95 ; hilt:upper 1.0 |} ."""

    import_text(kb, text.encode(), format="turtle12", source="x.ttl")

    assert [rule.id for rule in kb.rules()] == [CUTTING.id]


def test_another_library_reads_rdf_xml(paper: KnowledgeBase, tmp_path: Path):
    """The same triples as in Turtle."""
    export_file(paper, tmp_path / "x.rdf")
    export_file(paper, tmp_path / "x.ttl")

    xml, turtle = (Graph().parse(tmp_path / f"x.{suffix}") for suffix in ("rdf", "ttl"))

    assert len(xml) == len(turtle) > 50


def test_character_that_xml_cannot_hold_is_refused(kb: KnowledgeBase, tmp_path: Path):
    """The file would be read by nobody; the other formats have it."""
    kb.believe("A knife\x01 cuts.", "", "sam", [CUTTING])

    with pytest.raises(DataError, match=r"U\+0001 of utterance:1.*another format"):
        export_file(kb, tmp_path / "x.rdf")

    assert not (tmp_path / "x.rdf").exists()
    export_file(kb, tmp_path / "x.ttl")
    again = fresh()
    import_file(again, tmp_path / "x.ttl")
    assert again.utterance(1).text == "A knife\x01 cuts."


# --- Summaries


@pytest.mark.parametrize("large", [False, True])
def test_summary_tells_what_is_new_known_and_conflicting(
    kb: KnowledgeBase, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, large: bool
):
    """A dry run says the same and changes nothing."""
    if large:
        monkeypatch.setattr(importer, "_MAX_APPLIED", 0)
    against = grasping("knife", "blade", "pass", interval=Interval(0, 0.1))
    teach(kb, CUTTING, against)
    before = contents(kb)
    (tmp_path / "x.yaml").write_text(SHEET)

    dry = import_file(kb, tmp_path / "x.yaml", dry_run=True)

    assert (dry.new, dry.known, dry.conflicting, dry.untrusted) == (2, 1, 1, ("anna",))
    assert (dry.conflicts[0].new.id, dry.conflicts[0].believed.id) == (BLADE.id, against.id)
    assert dry.conflicts[0].weight == BLADE.interval.conflict(against.interval) > 0.5
    assert contents(kb) == before
    wet = import_file(kb, tmp_path / "x.yaml")
    assert (wet.new, wet.known, wet.conflicting, wet.untrusted) == (2, 1, 1, ("anna",))


def test_large_table_is_told_in_parts(
    kb: KnowledgeBase, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """No utterance of the history stands for more rules than can be read at once."""
    monkeypatch.setattr(importer, "PER_UTTERANCE", 2)
    (tmp_path / "x.csv").write_text(
        "features,functor,argument,lower\n"
        + "".join(f"knife,usedFor,cutting,0.{digit}\n" for digit in range(1, 6))
    )

    import_file(kb, tmp_path / "x.csv")

    assert [len(one.asserts) for one in kb.history()] == [2, 2, 1]
    assert kb.utterance(2).text == f"import of {tmp_path / 'x.csv'}, rules 3 to 4"
    assert all(rule.time and rule.utterance for rule in kb.rules())


@pytest.mark.parametrize("suffix", ["nq", "nt", "ttl"])
@pytest.mark.usefixtures("streamed")
def test_what_told_the_rules_is_not_held(
    kb: KnowledgeBase, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
):
    """As many rules as a sentence asserts, nothing of it but numbers is in memory."""
    some = [functional("knife", "cutting", interval=Interval(n / 100, 1)) for n in range(60)]
    kb.believe("Many.", "x", "sam", some)
    export_file(kb, tmp_path / f"x.{suffix}", rules_only=True)
    monkeypatch.setattr(importer, "MAX_REST", 50)
    again = fresh()

    assert import_file(again, tmp_path / f"x.{suffix}").new == 60
    assert len(again.utterance(1).asserts) == 60


# --- What is refused


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("x.yaml", "rules: [{object: knife, part: blade, interval: [0.9, 0.1]}]", ":1:.*upper"),
        (
            "x.yaml",
            "rules:\n- {object: knife, parts: blade, interval: 1}",
            ':2:.*did you mean "part',
        ),
        ("x.yaml", "rules:\n- {object: knife, interval: 1}", ":2:.*found none"),
        ("x.yaml", "a: &x [1]\nrules: *x", "aliases are not allowed"),
        ("x.yaml", "rules: !!python/object:os.system [x]", "not allowed"),
        ("x.csv", "features,functor,lower\nknife,usedFor,1.5", "x.csv:2: .*not an interval"),
        ("x.csv", "features,functor,lower\nknife,usedFor", "x.csv:2: expected 3 cells"),
        ("x.csv", "features,functor,lower\n\nknife,usedFor,", "x.csv:3: expected a number"),
        ("x.csv", "features,functor,lower\n" + "knife,usedFor,2\n" * 50, r"and 19 more"),
        ("x.yaml", "rules:\n- {object: knife}\n- 3\n- {object: ''}", r"x.yaml:2.*and 2 more"),
        ("x.csv.gz", "features,functor,lower\n", "is not packed by gzip"),
        ("x.csv", "a,b\n", "x.csv:1: .*names the columns"),
        ("x.csv", "features,functor,lower\n" + "k" * 20_000 + ",a,1", "x.csv:2: .*no name"),
        ("x.csv", "features,functor,lower\n" + "k" * 200_000 + ",a,1", "x.csv:2: is no CSV"),
        ("x.graphml", "<graphml", "is no GraphML"),
        ("x.rdf", "<!DOCTYPE x [<!ENTITY a 'b'>]><rdf:RDF/>", "document type"),
        ("x.graphml", "<!DOCTYPE x [<!ENTITY a 'b'>]><graphml/>", "document type"),
        ("x.jsonld", '{"@context": "http://127.0.0.1:9/x", "@id": "a:b"}', "from elsewhere is"),
        ("x.ttl", "[] <urn:p> 1 .", "no blank nodes"),
        ("x.ttl", "<urn:s> <urn:p> <<( <urn:a> <urn:b> 1 )>> .", r"RDF 1\.2"),
    ],
)
def test_bad_file_is_refused_with_its_place(
    kb: KnowledgeBase, tmp_path: Path, name: str, text: str, said: str
):
    """One line that says where and why, and nothing is changed."""
    (tmp_path / name).write_text(text)
    before = contents(kb)

    with pytest.raises(HiltError, match=said):
        import_file(kb, tmp_path / name)

    assert contents(kb) == before


@pytest.mark.parametrize("name", ["x.csv", "x.yaml", "x.ttl", "x.nq", "x.rdf", "x.jsonld"])
@pytest.mark.parametrize("data", ["rules: []".encode("utf-16"), b"\xff\xfe\x00\xd8", b"\x1f\x8bxx"])
def test_wrong_encoding_is_refused(kb: KnowledgeBase, tmp_path: Path, name: str, data: bytes):
    """UTF-8 it is, or what gzip packed."""
    (tmp_path / name).write_bytes(data)

    with pytest.raises(DataError, match=name):
        import_file(kb, tmp_path / name)


@pytest.mark.parametrize("suffix", ["csv", "yaml", "ttl", "nq", "rdf"])
def test_mark_of_utf_8_at_the_start_is_no_fault(paper: KnowledgeBase, tmp_path: Path, suffix: str):
    """Some editors write one."""
    export_file(paper, tmp_path / f"x.{suffix}")
    data = (tmp_path / f"x.{suffix}").read_bytes()
    (tmp_path / f"x.{suffix}").write_bytes(codecs.BOM_UTF8 + data)

    assert import_file(fresh(), tmp_path / f"x.{suffix}").new == 3


def test_wrong_encoding_is_told_with_its_line(kb: KnowledgeBase, tmp_path: Path):
    """Where a person has to look."""
    (tmp_path / "x.csv").write_bytes(b"features,functor,lower\n\nmess\xe9r,usedFor,1\n")

    with pytest.raises(DataError, match=r"x\.csv:3: expected UTF-8"):
        import_file(kb, tmp_path / "x.csv")


class Endless(io.RawIOBase):
    """A text that begins well and never ends."""

    def __init__(self, head: bytes) -> None:
        super().__init__()
        self._head = head
        self.given = 0

    def read(self, size: int = -1) -> bytes:
        """More of it."""
        found, self._head = self._head or b"a" * size, b""
        self.given += len(found)
        return found


@pytest.mark.parametrize(
    ("name", "head"),
    [
        ("turtle", b'<urn:s> <urn:p> "'),
        ("nquads", b'<urn:s> <urn:p> "'),
        ("jsonld", b'{"@id": "urn:s", "urn:p": "'),
        ("rdfxml", b'<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><a>'),
        ("csv", b'features,functor,lower\n"'),
        ("sheet", b"rules: ["),
        ("graphml", b"<graphml>"),
    ],
)
def test_endless_literal_is_refused_early(name: str, head: bytes):
    """Before the memory is full, whatever the format."""
    endless, chosen = Endless(head), FORMATS[name]
    source = CheckedStream(endless, "x", chosen)  # pyright: ignore[reportArgumentType]
    read = read_rules if name in RULE_FORMATS else read_statements

    with pytest.raises(DataError, match="x"):
        deque(read(source, chosen), maxlen=0)

    assert endless.given < 70 * 2**20


def test_bomb_of_zeros_is_refused(kb: KnowledgeBase, tmp_path: Path):
    """What was packed is counted as it unfolds."""
    with gzip.open(tmp_path / "x.yaml.gz", "wb") as packed:
        packed.write(b"#\n" * (5 * 2**20))

    with pytest.raises(DataError, match="larger than 8 MB"):
        import_file(kb, tmp_path / "x.yaml.gz")


@pytest.mark.usefixtures("streamed")
def test_large_invalid_file_changes_nothing(paper: KnowledgeBase, tmp_path: Path):
    """One bad rule among many refuses all of them."""
    export_file(paper, tmp_path / "x.nq")
    text = (tmp_path / "x.nq").read_text()
    (tmp_path / "x.nq").write_text(text.replace('"0.95"', '"1.95"', 1))
    base = fresh()
    before = contents(base)

    with pytest.raises(ValidationError, match="not an interval"):
        import_file(base, tmp_path / "x.nq")

    assert contents(base) == before


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be", "utf-32"])
@pytest.mark.parametrize("name", ["x.graphml", "x.rdf"])
def test_document_type_cannot_hide_in_another_encoding(
    kb: KnowledgeBase, tmp_path: Path, name: str, encoding: str
):
    """Entities are refused before they unfold, however they are written."""
    text = '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "bbbb">]><graphml>&a;</graphml>'
    (tmp_path / name).write_bytes(text.encode(encoding))

    with pytest.raises(DataError, match="expected UTF-8 text"):
        import_file(kb, tmp_path / name)
