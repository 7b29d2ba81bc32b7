"""Claims about exporting and importing."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rdflib import Dataset, Graph
from rdflib.compare import isomorphic

from hilt.kb.bulk.exporter import statements
from hilt.kb.formats import import_export
from hilt.kb.formats.import_export import export_file, import_file, write_base
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf.rule_mapping import DERIVED_FROM
from hilt.kb.rule import Rule
from hilt.kb.stores.opening import open_store
from hilt.kb.validation import check_invariants
from hilt.ontology.actions import load_actions
from hilt.ontology.errors import DataError, ValidationError
from hilt.ontology.objects import load_objects
from hilt.ontology.vocabulary import PREFIXES

from ..conftest import BLADE, CUTTING, HANDLE, import_text, teach, ticking
from ..strategies import rules
from ..test_episodes import EPISODE

HEAD = "".join(f"@prefix {prefix}: <{namespace}> .\n" for prefix, namespace in PREFIXES.items())
BY_HAND = f"""{HEAD}
rule:mug a hilt:ActionRule ;
    hilt:feature object:mug ; hilt:context action:pass ;
    hilt:functor hilt:graspObject ; hilt:part part:handle ;
    hilt:lower 0.75 ; hilt:upper 1.0 ; hilt:status hilt:active ;
    prov:wasAttributedTo speaker:eve .
"""


def fresh() -> KnowledgeBase:
    """An empty base with a clock of its own."""
    return KnowledgeBase(open_store("memory:"), clock=ticking())


def written(base: KnowledgeBase, format: str) -> bytes:
    """The export of a base."""
    stream = io.BytesIO()
    write_base(base.store, stream, format=format)
    return stream.getvalue()


def whole(base: KnowledgeBase) -> list[object]:
    """Everything that a base holds."""
    return list(statements(base.store))


# --- Round trips


@pytest.mark.parametrize("format", ["trig", "nquads"])
def test_whole_base_comes_back(paper: KnowledgeBase, format: str):
    """Rules, history, trust, domain and episodes, with their numbers."""
    paper.load_domain(load_objects(), load_actions())
    paper.set_trust("sam", 0.9)
    paper.retract(BLADE.id, "Forget that.", "", "sam")
    paper.record_episode(EPISODE)
    again = fresh()

    import_text(again, written(paper, format), format=format)

    assert whole(again) == whole(paper)
    assert written(again, format) == written(paper, format)


@pytest.mark.parametrize("format", ["turtle", "ntriples", "trig", "nquads"])
@settings(max_examples=10, deadline=None)
@given(taught=st.lists(rules, max_size=4))
def test_rules_come_back_from_every_format(format: str, taught: list[Rule]):
    """A fresh base that reads an export knows the same rules, sources included."""
    base, again = fresh(), fresh()
    teach(base, *taught)

    import_text(again, written(base, format), format=format)

    assert again.rules(status=None) == base.rules(status=None)
    assert written(again, format) == written(base, format)
    assert list(check_invariants(again.store)) == []


@pytest.mark.parametrize(("format", "reader"), [("turtle", "turtle"), ("ntriples", "nt")])
def test_another_library_reads_the_same_graph(paper: KnowledgeBase, format: str, reader: str):
    """Rdflib reads what is written, and its own Turtle of it is read back."""
    graph = Graph().parse(data=written(paper, format), format=reader)
    again = fresh()

    import_text(again, graph.serialize(format="turtle").encode(), format="turtle")

    assert isomorphic(graph, Graph().parse(data=written(again, format), format=reader))
    assert len(graph) == len(list(statements(paper.store, rules_only=True)))


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # rdflib's own, in its TriG reader
def test_another_library_reads_the_whole_base(paper: KnowledgeBase):
    """The named graphs of a TriG export are seen by rdflib."""
    dataset = Dataset().parse(data=written(paper, "trig"), format="trig")

    assert len(list(dataset.quads())) == len(list(statements(paper.store)))


def test_importing_twice_changes_nothing(paper: KnowledgeBase):
    """What is there already is recognised, rules and utterances alike."""
    base = fresh()
    first = import_text(base, written(paper, "turtle"), format="turtle")
    before = whole(base)

    second = import_text(base, written(paper, "turtle"), format="turtle")

    assert (first.new, first.known, first.utterances) == (3, 0, 3)
    assert (second.new, second.known, second.utterances) == (0, 3, 0)
    assert whole(base) == before


def test_export_is_the_same_for_the_same_base(paper: KnowledgeBase):
    """So that exports can be compared line by line."""
    assert written(paper, "trig") == written(paper, "trig")


@pytest.mark.parametrize(
    "format", ["turtle", "turtle12", "ntriples", "rdfxml", "trig", "nquads", "jsonld"]
)
def test_longer_file_comes_back_too(
    paper: KnowledgeBase, format: str, monkeypatch: pytest.MonkeyPatch
):
    """What stands in order streams, and what does not is put in order: the same rules."""
    monkeypatch.setattr(import_export, "MAX_SHACL", 0)
    again = fresh()

    import_text(again, written(paper, format), format=format)

    assert again.rules(status=None) == paper.rules(status=None)
    assert list(check_invariants(again.store, whole=True)) == []


@pytest.mark.parametrize("name", ["rule:mug", BLADE.id.replace("/", ":")])
def test_longer_file_may_scatter_what_it_says_of_a_rule(
    kb: KnowledgeBase, monkeypatch: pytest.MonkeyPatch, name: str
):
    """And name it as it likes, as a shorter one."""
    monkeypatch.setattr(import_export, "MAX_SHACL", 0)
    apart = (
        BY_HAND.replace("hilt:lower 0.75 ;", "") + 'object:mug a hilt:Object ; rdfs:label "mug" .\n'
    )
    text = f"{apart}rule:mug hilt:lower 0.75 .".replace("rule:mug", name)

    assert import_text(kb, text.encode(), format="turtle").new == 1
    assert [rule.interval.lower for rule in kb.rules()] == [0.75]


def test_rule_is_not_taken_from_an_utterance_that_did_not_say_it(paper: KnowledgeBase):
    """A file that says so is refused, and names both."""
    first, second = (f"<{PREFIXES['utterance']}{number}>".encode() for number in (1, 2))
    source = f"<{DERIVED_FROM}> ".encode()
    forged = written(paper, "nquads").replace(source + first, source + second)

    with pytest.raises(ValidationError, match="utterance:2: It does not assert the rule:"):
        import_text(fresh(), forged, format="nquads")


NODE, BASE = PREFIXES["object"], PREFIXES["graph"]
RULES = f"<{PREFIXES['rule']}".encode()
SAME, LABEL = PREFIXES["owl"] + "sameAs", PREFIXES["rdfs"] + "label"


@pytest.mark.parametrize("most", [0, 1000])
@pytest.mark.parametrize(
    ("line", "what"),
    [
        (f"<{NODE}knife> <{SAME}> <http://x.org/Knife> <{BASE}domain> .", "owl:sameAs"),
        (f'<{NODE}knife> <{LABEL}> "couteau" <{BASE}beliefs> .', "rdfs:label"),
    ],
)
def test_what_is_not_taken_is_counted(
    paper: KnowledgeBase, monkeypatch: pytest.MonkeyPatch, line: str, what: str, most: int
):
    """Whether the file streams or is put in order; all that Hilt wrote itself is taken."""
    monkeypatch.setattr(import_export, "MAX_SHACL", most)
    household = load_objects(), load_actions()
    paper.load_domain(*household)
    other = fresh()
    other.load_domain(*household)
    text = written(paper, "nquads")

    assert import_text(other, text, format="nquads", dry_run=True).as_json()["not_taken"] == {}
    found = import_text(other, text + line.encode(), format="nquads")

    graph = line.rsplit("/", 1)[1].removesuffix("> .")
    assert found.as_json()["not_taken"] == {f"{what} in graph:{graph}": 1}


def test_foreign_property_of_a_rule_is_refused_in_a_stream_too(
    paper: KnowledgeBase, monkeypatch: pytest.MonkeyPatch
):
    """As it is in a short file."""
    monkeypatch.setattr(import_export, "MAX_SHACL", 0)
    text = written(paper, "nquads")
    line = next(line for line in text.splitlines() if line.startswith(RULES))
    node, at = line.split()[0], text.index(line)
    foreign = node + f' <{PREFIXES["rdfs"]}comment> "!" <{BASE}beliefs> .\n'.encode()

    with pytest.raises(ValidationError, match="rdfs:comment is no part of a rule"):
        import_text(fresh(), text[:at] + foreign + text[at:], format="nquads")


def test_trust_that_the_base_has_its_own_of_is_not_taken(paper: KnowledgeBase, kb: KnowledgeBase):
    """And is counted."""
    other = fresh()
    teach(other, CUTTING)
    other.set_trust("sam", 0.5)

    found = import_text(other, written(paper, "nquads"), format="nquads")

    assert found.not_taken == {"hilt:trustLower in graph:beliefs": 1}


# --- Joining


def test_utterances_of_a_file_come_after_those_of_the_base(paper: KnowledgeBase):
    """They are renumbered, and what refers to them with them."""
    base = fresh()
    base.record("Hello.", "", "sam", "acknowledgement", accepted=True)
    paper.record_episode(EPISODE)

    import_text(base, written(paper, "trig"), format="trig")

    assert base.sequence == 4
    assert [rule.utterance for rule in base.rules()] == [2, 3, 4]
    assert next(base.episodes()).utterance == 4


def test_what_the_base_took_back_stays_taken_back(paper: KnowledgeBase):
    """A file does not undo what somebody said to this base."""
    base = fresh()
    teach(base, BLADE)
    base.retract(BLADE.id, "Forget that.", "", "sam")

    merged = import_text(base, written(paper, "turtle"), format="turtle")

    assert base.rule(BLADE.id).status == "retracted"
    assert (merged.new, merged.known) == (2, 1)


def test_trust_of_a_file_does_not_override_that_of_the_base(paper: KnowledgeBase):
    """Who is known keeps the trust; who is new brings it."""
    base = fresh()
    base.set_trust("sam", 0.5)
    paper.set_trust("anna", 0.75)

    import_text(base, written(paper, "turtle"), format="turtle")

    assert base.trust("sam").lower == 0.5
    assert base.trust("anna").lower == 0.75


def test_rules_written_by_hand_are_taken(kb: KnowledgeBase):
    """Any name will do for a rule, and the file is its source."""
    merged = import_text(kb, BY_HAND.encode(), format="turtle", source="mine.ttl")

    (rule,) = kb.rules_at_nodes(["pass.graspObject"])
    assert (rule.object, rule.part, rule.speaker) == ("mug", "handle", "eve")
    assert kb.utterance(rule.utterance).text.endswith("mine.ttl")
    assert merged.untrusted == ("eve",)
    assert list(check_invariants(kb.store)) == []


def test_dry_run_writes_nothing(paper: KnowledgeBase):
    """It only says what would come of it."""
    base = fresh()
    before = whole(base)

    merged = import_text(base, written(paper, "turtle"), format="turtle", dry_run=True)

    assert merged.new == 3
    assert whole(base) == before


# --- What is refused


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "hilt:lower 0.75",
            "hilt:lower 1.3",
            r"hilt:lower is one decimal in \[0, hilt:upper\].*1\.3",
        ),
        ("hilt:upper 1.0", "hilt:upper 0.1", r"\[0\.75, 0\.1\]|hilt:upper"),
        ("part:handle", "part:handle , part:rim", "at most one hilt:part"),
        ("speaker:eve", "<http://x/eve>", "leads to one speaker:NAME"),
        ("hilt:ActionRule", "hilt:FunctionalRule", "functional rule"),
        (
            "speaker:eve .",
            "speaker:eve . object:mug hilt:usedFor affordance:x .",
            "belongs to nothing",
        ),
        ("speaker:eve .", "speaker:eve . <http://x/a> <http://x/b> 1 .", "belongs to nothing"),
    ],
)
def test_invalid_file_changes_nothing(kb: KnowledgeBase, old: str, new: str, said: str):
    """It is refused whole, and the first finding says why."""
    before = whole(kb)
    both = f"{BY_HAND}\n{BY_HAND.replace('rule:mug', 'rule:two').replace(old, new)}"

    with pytest.raises(ValidationError, match=said):
        import_text(kb, both.encode(), format="turtle")

    assert whole(kb) == before


@pytest.mark.parametrize(
    ("text", "format", "said"),
    [
        (b"rule:1 a x:y", "turtle", "x.ttl:1:1: .*rule: has not been declared"),
        (HEAD.encode() + b"rule:1 a hilt:Rule", "turtle", r"x\.ttl:\d+:\d+: "),
        (b"\xff\xfe\x00", "turtle", "x.ttl:1:1: "),
        (b"<urn:g> { <urn:s> <urn:p> 1 }", "trig", "graph <urn:g> is none of a base's"),
    ],
)
def test_unreadable_text_is_told_with_its_place(
    kb: KnowledgeBase, text: bytes, format: str, said: str
):
    """Source, line and column."""
    with pytest.raises(DataError, match=said):
        import_text(kb, text, format=format, source="x.ttl")


# --- Files


def test_extension_names_the_format(paper: KnowledgeBase, tmp_path: Path):
    """A file is written and read by its extension."""
    for name in ("rules.ttl", "rules.nt", "base.trig", "base.nq"):
        count = export_file(paper, tmp_path / name)
        again = fresh()
        assert import_file(again, tmp_path / name).new == 3
        assert count > 50
        assert [rule.id for rule in again.rules()] == [CUTTING.id, HANDLE.id, BLADE.id]


def test_streams_are_files_too(paper: KnowledgeBase, monkeypatch: pytest.MonkeyPatch):
    """A hyphen is standard output and standard input; Turtle is read as TriG."""
    out = SimpleNamespace(buffer=io.BytesIO())
    monkeypatch.setattr(sys, "stdout", out)
    export_file(paper, "-")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(out.buffer.getvalue())))
    again = fresh()

    import_file(again, "-")

    assert len(again.rules()) == 3


@pytest.mark.parametrize(
    ("name", "said"),
    [("x.doc", 'extension ".doc" names no format'), ("none.ttl", "cannot be read")],
)
def test_file_that_cannot_be_read_is_told(kb: KnowledgeBase, tmp_path: Path, name: str, said: str):
    """One line, with the file's name."""
    with pytest.raises(DataError, match=said):
        import_file(kb, tmp_path / name)


def test_file_that_cannot_be_written_is_told(kb: KnowledgeBase, tmp_path: Path):
    """Nothing half written is left."""
    (tmp_path / "x.ttl").mkdir()

    with pytest.raises(DataError, match="cannot be written"):
        export_file(kb, tmp_path / "x.ttl")
    with pytest.raises(DataError, match=r"unknown format .*trig, turtle"):
        export_file(kb, tmp_path / "x", format="doc")

    assert [path.name for path in tmp_path.iterdir()] == ["x.ttl"]
