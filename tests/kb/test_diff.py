"""Claims about what utterances did, and about how two bases differ."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.diff import compare_bases, find_rule, last_taught_rules, rule_changes
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.learned import LearnedWord
from hilt.kb.rule import Atom, Rule, functional
from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import UnknownNameError, ValidationError
from hilt.ontology.vocabulary import split

from .conftest import BLADE, CUTTING, HANDLE, import_text, teach, ticking
from .strategies import rules

OFTEN = functional("knife", "cutting", interval=Interval(0.75, 1))


@pytest.fixture
def other() -> Iterator[KnowledgeBase]:
    """A second base."""
    with KnowledgeBase(open_store("memory:"), clock=ticking()) as base:
        yield base


@given(st.data())
@settings(max_examples=25)
def test_feed_and_the_named_query_agree(data: st.DataObject):
    """Whatever is told, taken back and replaced, and from whatever number on."""
    with KnowledgeBase(open_store("memory:"), clock=ticking()) as kb:
        for number in range(data.draw(st.integers(1, 5))):
            known = st.lists(st.sampled_from([rule.id for rule in kb.rules()] or [""]), max_size=2)
            gone, old = (list(filter(None, data.draw(known))) for _ in range(2))
            new = data.draw(st.lists(rules, max_size=2))
            kb.believe(f"{number}.", "x", "sam", new, retracts=gone, supersedes=old)
        since = data.draw(st.integers(0, 5))

        found = kb.answer("changed-since", since=str(since))
        fed = {
            (change.utterance.sequence, kind, rule.id)
            for change in rule_changes(kb, since=since)
            for kind in ("asserts", "retracts", "supersedes")
            for rule in map(kb.rule, getattr(change.utterance, kind))
        }
    listed = {(row[0], row[1].rpartition("#")[2], f"rule/{split(row[2])[1]}") for row in found}
    assert listed == fed


def test_change_tells_what_an_utterance_did(paper: KnowledgeBase):
    """Each with the rules that it told, took back or replaced."""
    paper.believe("No.", "x", "sam", [OFTEN], retracts=[BLADE.id], supersedes=[CUTTING.id])

    (change,) = rule_changes(paper, since=3)

    found = [[r.id for r in some] for some in (change.told, change.retracted, change.superseded)]
    assert found == [[OFTEN.id], [BLADE.id], [CUTTING.id]]
    assert change.as_json()["sequence"] == 4


@settings(max_examples=20, deadline=None)
@given(st.lists(rules, max_size=5), st.lists(rules, max_size=5))
def test_bases_differ_exactly_when_they_believe_other_rules(one: list[Rule], two: list[Rule]):
    """The order, and how often something was said, do not count."""
    left, right = (KnowledgeBase(open_store("memory:"), clock=ticking()) for _ in range(2))
    teach(left, *one)
    teach(right, *reversed(two), *two)

    same = {rule.id for rule in left.rules()} == {rule.id for rule in right.rules()}

    assert compare_bases(left, right).is_empty == same
    assert compare_bases(left, left).is_empty


def test_difference_tells_what_only_one_believes(paper: KnowledgeBase, other: KnowledgeBase):
    """What is gone and what is new."""
    spoon = functional("spoon", "eating", interval=Interval(0.9, 1))
    teach(other, HANDLE, BLADE, spoon)

    found = compare_bases(paper, other)

    assert [rule.id for rule in found.removed] == [CUTTING.id]
    assert [rule.id for rule in found.added] == [spoon.id]


def test_other_interval_and_status_are_alterations(paper: KnowledgeBase, other: KnowledgeBase):
    """The same matter in other words, and what was taken back."""
    teach(other, OFTEN, HANDLE, BLADE)
    other.retract(BLADE.id, "Forget that.", "", "sam")

    found = compare_bases(paper, other)

    assert (found.removed, found.added) == ((), ())
    assert [(a.before.id, a.after.id) for a in found.altered] == [
        (BLADE.id, BLADE.id),
        (CUTTING.id, OFTEN.id),
    ]
    assert found.altered[0].after.status == "retracted"
    back = compare_bases(other, paper).altered
    assert {a.before.status for a in back} == {"active", "retracted"}


def test_trust_and_words_are_part_of_the_difference(kb: KnowledgeBase, other: KnowledgeBase):
    """Whom each trusts, and which words each learned."""
    kb.set_trust("anna", 0.5)
    ladle = LearnedWord(Atom("object", "ladle"), "ladle", "sam")
    other.believe("A ladle.", "x", "sam", [], words=[ladle])

    found = compare_bases(kb, other)

    assert found.trust == (("anna", Interval(0.5, 1), None),)
    assert [word.atom.name for word in found.words_added] == ["ladle"]
    assert found.as_json()["trust"] == [{"speaker": "anna", "before": [0.5, 1.0], "after": None}]


@pytest.mark.parametrize("form", ["rule/{}", "rule:{}", "{}", "{:.6}"])
def test_rule_is_found_by_its_id_or_a_start_of_it(paper: KnowledgeBase, form: str):
    """As it is printed, or as much of it as tells it from others."""
    digits = BLADE.id.removeprefix("rule/")

    assert find_rule(paper, form.format(digits)).id == BLADE.id


def test_unknown_or_doubtful_name_of_a_rule_is_an_error(paper: KnowledgeBase):
    """The message lists what there is."""
    same = [functional("mug", f"use{n}", interval=Interval(0.9, 1)) for n in range(600)]
    paper.believe("Many.", "x", "sam", same)
    starts = [rule.id[5:9] for rule in paper.rules()]
    double = next(start for start in starts if starts.count(start) > 1)

    for unknown in ("ffff0000ffff0000", "blade", "beef0"):
        with pytest.raises(UnknownNameError, match="no rule"):
            find_rule(paper, unknown)
    for short in ("", "4d5", "rule/4"):
        with pytest.raises(ValidationError, match="expected 4 digits"):
            find_rule(paper, short)
    with pytest.raises(ValidationError, match="several rules"):
        find_rule(paper, double)


def test_last_told_is_the_whole_last_sentence(kb: KnowledgeBase):
    """What one sentence taught stands or falls together."""
    kb.believe("Both.", "x", "sam", [HANDLE, BLADE])
    teach(kb, CUTTING, speaker="anna")

    assert {rule.id for rule in last_taught_rules(kb, "sam")} == {HANDLE.id, BLADE.id}
    with pytest.raises(UnknownNameError, match=r'holds by "eve"'):
        last_taught_rules(kb, "eve")


def test_what_a_file_said_is_not_the_last_sentence(kb: KnowledgeBase):
    """To forget the last thing told never takes back a whole import."""
    teach(kb, HANDLE)
    import_text(kb, b"features,functor,argument,lower\nmug,usedFor,sipping,0.5\n", format="csv")

    assert [rule.id for rule in last_taught_rules(kb, "sam")] == [HANDLE.id]
