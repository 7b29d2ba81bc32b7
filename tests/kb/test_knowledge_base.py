"""Claims about what is believed, how that changes, and what the base answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.kb.bulk.exporter import statements
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.terms import BASE_GRAPH, BASE_NODE, Quad
from hilt.kb.rule import Atom, Rule, functional, grasping
from hilt.kb.stores.opening import open_store
from hilt.kb.validation import check_invariants
from hilt.ontology.errors import QueryError, StoreError, UnknownNameError, ValidationError
from hilt.ontology.vocabulary import iri, term

from .conftest import BLADE, CUTTING, HANDLE, HIGH, PAPER, START, teach
from .strategies import rules

ALL = (CUTTING, HANDLE, BLADE)


# --- Being told


def test_told_rule_is_found_at_its_node(paper: KnowledgeBase):
    """What was taught by sentence is what the hot question finds, and nothing else."""
    assert paper.rules_at_nodes(["pass.graspObject", "graspObject"]) == [
        replace(BLADE, utterance=3, time=paper.utterance(3).time)
    ]
    assert [rule.affordance for rule in paper.rules_at_nodes(["findObject.cutting"])] == ["cutting"]
    assert paper.rules_at_nodes(["findObject.pounding", "use.graspObject"]) == []


def test_utterance_keeps_what_was_said(paper: KnowledgeBase):
    """Text, predicate form, speaker, time, and the rules it asserted."""
    text, predicate, rule = PAPER[2]

    said = paper.utterance(3)

    assert (said.text, said.predicate, said.speaker) == (text, predicate, "sam")
    assert (said.asserts, said.kind, said.accepted) == ((rule.id,), "statement", True)
    assert said.time > START


def test_sequence_counts_everything_said(kb: KnowledgeBase):
    """Statements, commands and refused ones are numbered in one row."""
    teach(kb, CUTTING)
    kb.record("pass me a knife", "pass(self,knife)", "sam", "command", accepted=True, answer="Here")
    kb.record("grab it", "", "eve", "statement", accepted=False)

    assert kb.sequence == 3
    assert [said.kind for said in kb.history()] == ["statement", "command", "statement"]
    assert [said.accepted for said in kb.history(since=1)] == [True, False]
    assert kb.utterance(2).answer == "Here"


def test_same_rule_told_twice_is_one_rule(kb: KnowledgeBase):
    """Both utterances are kept, and the rule names the last."""
    teach(kb, CUTTING, CUTTING)

    assert [rule.utterance for rule in kb.rules()] == [2]
    assert [said.asserts for said in kb.history()] == [(CUTTING.id,)] * 2


def test_other_interval_or_speaker_is_other_evidence(kb: KnowledgeBase):
    """Different intervals, and different speakers, are separate rules."""
    often = functional("knife", "cutting", interval=Interval(0.75, 1))
    teach(kb, CUTTING, often)
    teach(kb, CUTTING, speaker="anna")

    assert len(kb.rules(affordance="cutting")) == 3
    assert [rule.speaker for rule in kb.rules(speaker="anna")] == ["anna"]


def test_several_rules_of_one_sentence_are_one_utterance(kb: KnowledgeBase):
    """One sentence may teach several rules; they stand or fall together."""
    kb.believe("Both.", "both", "sam", [HANDLE, BLADE])

    assert kb.sequence == 1
    assert {rule.utterance for rule in kb.rules()} == {1}


@given(st.lists(rules, max_size=6))
def test_beliefs_depend_only_on_the_set_taught(taught: list[Rule]):
    """Order and repetition change neither the rules nor their edges (H1 of the theory)."""
    told, again = (KnowledgeBase(open_store("memory:")) for _ in range(2))

    teach(told, *taught)
    teach(again, *reversed(taught), *taught)

    provenance = {rule_mapping.DERIVED_FROM, rule_mapping.GENERATED_AT}
    beliefs = [
        {q for q in base.store.quads(graph=rule_mapping.BELIEFS) if q.predicate not in provenance}
        for base in (told, again)
    ]
    assert beliefs[0] == beliefs[1]


@given(st.lists(rules, max_size=5), st.lists(st.booleans(), min_size=5, max_size=5))
def test_base_stays_lawful_whatever_is_told_and_taken_back(taught: list[Rule], gone: list[bool]):
    """After any teaching and forgetting the graph is what its rules say, edges included."""
    base = KnowledgeBase(open_store("memory:"))
    teach(base, *taught)
    for rule, is_gone in zip(base.rules(), gone, strict=False):
        if is_gone:
            base.retract(rule.id, "Forget it.", "", "sam")

    assert list(check_invariants(base.store)) == []


def test_refused_text_changes_nothing(kb: KnowledgeBase):
    """A text that cannot be stored leaves no trace."""
    with pytest.raises(ValidationError, match="no Unicode"):
        kb.believe("\ud800", "", "sam", [CUTTING])
    with pytest.raises(ValidationError, match="no speaker's name"):
        kb.believe("x", "", "", [CUTTING])

    assert (kb.sequence, kb.rules()) == (0, [])


def test_hostile_text_is_only_text(kb: KnowledgeBase):
    """No text breaks out of its literal, into the graph or into an update."""
    text = '" } } ; DROP ALL ; INSERT DATA { GRAPH <x:y> { <x:a> <x:b> "'
    teach(kb, CUTTING)
    kb.believe(text, text, "sam", [BLADE])
    kb.retract(BLADE.id, text, text, "sam", answer=text)

    assert kb.utterance(2).text == kb.utterance(3).answer == text
    assert [rule.id for rule in kb.rules()] == [CUTTING.id]


# --- Taking back


def test_retracted_rule_is_not_used_but_remembered(paper: KnowledgeBase):
    """Forgetting changes the status; history tells who wanted it."""
    paper.retract(BLADE.id, "Forget that.", "", "sam")

    assert paper.rules_at_nodes(["pass.graspObject"]) == []
    assert paper.rule(BLADE.id).status == "retracted"
    assert paper.rules(status="retracted") == [paper.rule(BLADE.id)]
    assert paper.utterance(4).retracts == (BLADE.id,)


def test_plain_edge_goes_with_the_last_rule_that_asserts_it(kb: KnowledgeBase):
    """Two rules share the edge; it stays until both are taken back."""
    often = grasping("knife", "blade", "pass", interval=Interval(0.75, 1))
    edge = rule_mapping.plain_edges(BLADE)[0]
    teach(kb, BLADE, often)

    kb.retract(BLADE.id, "Forget one.", "", "sam")
    is_there = edge in set(kb.store.quads())
    kb.retract(often.id, "Forget the other.", "", "sam")

    assert is_there
    assert edge not in set(kb.store.quads())


def test_rule_told_again_holds_again(paper: KnowledgeBase):
    """What was retracted can be taught anew."""
    paper.retract(BLADE.id, "Forget that.", "", "sam")
    teach(paper, BLADE)

    assert [rule.utterance for rule in paper.rules_at_nodes(["pass.graspObject"])] == [5]
    assert list(check_invariants(paper.store)) == []


def test_correction_replaces_a_rule_in_one_step(paper: KnowledgeBase):
    """The new rule holds and the old one is superseded, by the same utterance."""
    handle = grasping("knife", "handle", "pass", interval=HIGH)

    said = paper.believe(
        "No, by the handle.", "", "sam", [handle], supersedes=[BLADE.id], kind="correction"
    )

    assert [rule.part for rule in paper.rules_at_nodes(["pass.graspObject"])] == ["handle"]
    assert paper.rule(BLADE.id).status == "superseded"
    assert (said.asserts, said.supersedes) == ((handle.id,), (BLADE.id,))


def test_correction_that_shares_the_edge_keeps_it(paper: KnowledgeBase):
    """The same part with another interval still is a part it is grasped by."""
    often = grasping("knife", "blade", "pass", interval=Interval(0.75, 1))

    paper.believe("Often.", "", "sam", [often], supersedes=[BLADE.id])

    assert rule_mapping.plain_edges(BLADE)[0] in set(paper.store.quads())


@pytest.mark.parametrize("other", [
    grasping("mug", "blade", "pass", interval=Interval(0.75, 1)),
    grasping("knife", "blade", "pour", interval=Interval(0.75, 1)),
    grasping("knife", "blade", "pass", interval=Interval(0.75, 1), properties=("hot",)),
])  # fmt: skip
def test_what_follows_is_up_to_date_when_rules_end(paper: KnowledgeBase, other: Rule):
    """Edges and relations of the rules that stay are there, and no others."""
    teach(paper, other)

    paper.retract(BLADE.id, "Forget it.", "", "sam")

    kept = set(paper.store.quads(None, None, None, rule_mapping.DERIVED))
    assert list(check_invariants(paper.store, whole=True)) == []
    paper.derive()
    assert set(paper.store.quads(None, None, None, rule_mapping.DERIVED)) == kept


def test_unknown_rule_cannot_be_taken_back(paper: KnowledgeBase):
    """The error lists rules there are, and nothing is written."""
    with pytest.raises(UnknownNameError, match=f"Known: .*{BLADE.id}"):
        paper.retract("rule/0000000000000000", "Forget it.", "", "sam")

    assert paper.sequence == 3


# --- Asking


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ({}, ALL),
        ({"object": "knife"}, ALL),
        ({"object": "spoon"}, ()),
        ({"affordance": "cutting"}, (CUTTING,)),
        ({"context": "pass"}, (BLADE,)),
        ({"part": "handle"}, (HANDLE,)),
        ({"object": "knife", "context": "pickUp", "part": "handle"}, (HANDLE,)),
        ({"context": "pass", "part": "handle"}, ()),
        ({"speaker": "anna"}, ()),
        ({"status": None}, ALL),
        ({"status": "retracted"}, ()),
    ],
)
def test_rules_are_filtered_by_what_is_named(
    paper: KnowledgeBase, wanted: dict[str, str], found: tuple[Rule, ...]
):
    """Each filter narrows, and the order is that of telling."""
    assert [rule.id for rule in paper.rules(**wanted)] == [rule.id for rule in found]


@given(st.lists(rules, max_size=6), st.lists(rules, max_size=3))
def test_pattern_reads_agree_with_the_query(taught: list[Rule], asked: list[Rule]):
    """The fast way to the rules of nodes finds what `rules-of-node.rq` finds."""
    base = KnowledgeBase(open_store("memory:"))
    teach(base, *taught)
    nodes = [rule.node for rule in (*taught, *asked)]

    fast = base.rules_at_nodes(nodes)
    base.store.has_cheap_patterns = False

    assert base.rules_at_nodes(nodes) == fast
    assert {rule.id for rule in fast} == {rule.id for rule in base.rules() if rule.node in nodes}


def test_unknown_utterance_is_told(paper: KnowledgeBase):
    """The error says which there are."""
    with pytest.raises(UnknownNameError, match="1 to 3"):
        paper.utterance(9)


# --- Trust


def test_fresh_base_trusts_sam_alone(kb: KnowledgeBase):
    """An unknown speaker is not trusted."""
    assert kb.speakers() == ("sam",)
    assert kb.trust("sam") == Interval(1, 1)
    assert kb.trust("eve") is None


def test_trust_discounts_what_a_speaker_says(kb: KnowledgeBase):
    """The rule stays as told; its support is discounted by the least trust."""
    teach(kb, CUTTING, speaker="anna")
    unknown = kb.rules()[0].support
    kb.set_trust("anna", 0.5)

    (rule,) = kb.rules_at_nodes(["findObject.cutting"])
    assert unknown.is_vacuous
    assert (rule.interval, rule.support) == (HIGH, Interval(0.475, 1))


def test_trust_of_zero_is_none_at_all(kb: KnowledgeBase):
    """`trust eve 0` means that eve is not trusted, and sam can lose trust too."""
    assert kb.set_trust("sam", 0) == Interval(0, 0)
    assert kb.speakers() == ()


def test_change_of_trust_is_a_change(kb: KnowledgeBase):
    """It moves the number by which inference knows that rules weigh otherwise; history has it."""
    kb.set_trust("anna", 0.5)
    kb.set_trust("anna", 0.75, upper=0.9)

    assert kb.sequence == 2
    assert kb.trust("anna") == Interval(0.75, 0.9)
    assert [said.kind for said in kb.history()] == ["trust", "trust"]


# --- SPARQL


def test_query_answers_every_form(paper: KnowledgeBase):
    """Rows for SELECT and CONSTRUCT, yes or no for ASK; prefixes are declared already."""
    select = paper.query("SELECT ?a WHERE { GRAPH ?g { object:knife hilt:usedFor ?a } }")
    ask = paper.query("ASK { GRAPH ?g { object:knife hilt:usedFor affordance:pounding } }")
    made = paper.query("CONSTRUCT { ?o a hilt:Tool } WHERE { GRAPH ?g { ?o hilt:usedFor ?a } }")

    assert select.as_json()["results"] == {
        "bindings": [{"a": {"type": "uri", "value": str(iri("affordance", "cutting"))}}]
    }
    assert ask.as_json() == {"head": {}, "boolean": False}
    assert made.as_json()["head"] == {"vars": ["subject", "predicate", "object"]}


def test_query_takes_bindings(paper: KnowledgeBase):
    """Values are bound, not pasted."""
    text = "SELECT ?part WHERE { GRAPH ?g { ?object hilt:graspedBy ?part } }"

    found = paper.select(text, {"object": [iri("object", "knife"), iri("object", "mug")]})

    assert {row[0] for row in found} == {iri("part", "blade"), iri("part", "handle")}


@pytest.mark.parametrize("text", ["", "INSERT DATA {}", "DROP ALL", "SELECT", "gibberish {"])
def test_anything_but_a_query_is_refused(paper: KnowledgeBase, text: str):
    """Nothing is changed by asking."""
    with pytest.raises(QueryError):
        paper.query(text)

    assert (term("ActionRule"), 2) in paper.answer("counts")


def test_count_counts_each_thing_once(paper: KnowledgeBase):
    """Things that stand in several graphs are one thing."""
    counted = dict(paper.answer("counts"))

    kinds = map(term, ("FunctionalRule", "ActionRule", "Utterance", "Speaker"))
    assert [counted[kind] for kind in kinds] == [1, 2, 3, 1]


# --- Opening


def test_base_is_the_same_after_opening_again(tmp_path: Path):
    """A folder keeps rules, history, trust and the number of the last utterance."""
    with KnowledgeBase.open(tmp_path / "kb") as base:
        teach(base, *ALL)
        base.set_trust("anna", 0.5)
        before = list(statements(base.store))

    with KnowledgeBase.open(tmp_path / "kb") as again:
        assert list(statements(again.store)) == before
        assert again.sequence == 4


def test_later_format_is_not_misread(tmp_path: Path):
    """A base of a later Hilt is refused, and released."""
    with KnowledgeBase.open(tmp_path / "kb") as base:
        (mark,) = base.store.quads(BASE_NODE, term("formatVersion"))
        base.store.apply(delete=[mark], insert=[mark._replace(object=99)])

    for _ in range(2):
        with pytest.raises(StoreError, match="has format 99"):
            KnowledgeBase.open(tmp_path / "kb")


def test_store_of_other_data_is_refused():
    """A store that holds something else never becomes a base."""
    store = open_store("memory:")
    store.apply(insert=[Quad(BASE_NODE, rule_mapping.LABEL, "mine", BASE_GRAPH)])

    with pytest.raises(StoreError, match="holds other data"):
        KnowledgeBase(store)


def test_general_rule_is_kept_like_any_other(kb: KnowledgeBase):
    """Several features and contexts, another functor, an argument of another kind."""
    rule = Rule(
        frozenset([Atom("object", "mug"), Atom("property", "full")]),
        frozenset([Atom("action", "pass"), Atom("place", "kitchen")]),
        "moveTo",
        Atom("place", "sink"),
        HIGH,
    )
    teach(kb, rule)

    assert [one.id for one in kb.rules_at_nodes(["pass.moveTo"])] == [rule.id]
    assert kb.rules(object="mug")[0].argument == Atom("place", "sink")


def test_some_rules_come_with_the_number_of_all(paper: KnowledgeBase):
    """Only so many active rules are read as wanted; the number counts them all, of a speaker."""
    count, some = paper.count_and_rules(2)

    assert (count, len(some)) == (len(ALL), 2)
    assert {rule.id for rule in some} <= {rule.id for rule in ALL}
    assert paper.count_and_rules(5, speaker="sam") == (len(ALL), paper.rules())
    assert paper.count_and_rules(5, speaker="kim") == (0, [])
    paper.retract(CUTTING.id, "", "", "sam")
    assert paper.count_and_rules(5)[0] == len(ALL) - 1


def test_like_rules_have_the_same_premises_and_speaker(kb: KnowledgeBase):
    """Whatever they conclude; others on the same node are not read."""
    part = grasping("knife", "handle", "pass", interval=HIGH)
    others = (
        replace(part, speaker="anna"),
        grasping("knife", "handle", "use", interval=HIGH),
        grasping("mug", "handle", "pass", interval=HIGH),
    )
    teach(kb, BLADE, part, CUTTING, *others)

    assert {rule.id for rule in kb.rules_with_premises_of(BLADE)} == {BLADE.id, part.id}
    assert [rule.id for rule in kb.rules_with_premises_of(CUTTING)] == [CUTTING.id]
    anything = replace(part, features=frozenset())
    assert kb.rules_with_premises_of(anything) == []
