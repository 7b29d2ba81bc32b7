"""Claims about the base as it was, one person's view, changes, and how two bases differ."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime, timedelta, timezone

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.learned import LearnedWord
from hilt.kb.rule import Atom, Rule, functional
from hilt.kb.stores.opening import open_store
from hilt.kb.views import (
    compare_bases,
    find_rule,
    last_taught_rules,
    parse_moment,
    rule_changes,
    view,
)
from hilt.ontology.errors import DataError, UnknownNameError, ValidationError
from hilt.ontology.vocabulary import split

from .conftest import BLADE, CUTTING, HANDLE, START, import_text, teach, ticking
from .strategies import rules

OFTEN = functional("knife", "cutting", interval=Interval(0.75, 1))


def ids(found: list[Rule] | tuple[Rule, ...]) -> list[str]:
    """What is compared: which rules, in order."""
    return [rule.id for rule in found]


@settings(max_examples=30, deadline=None)
@given(st.lists(rules, max_size=6), st.lists(st.integers(0, 5), max_size=4))
def test_view_of_now_is_what_the_base_believes(taught: list[Rule], gone: list[int]):
    """Going through the history again gives the rules, their sources and their weights."""
    base = KnowledgeBase(open_store("memory:"), clock=ticking())
    teach(base, *taught)
    for number in gone:
        if number < len(held := base.rules()):
            base.retract(held[number].id, "Forget it.", "", "sam")
    base.set_trust("sam", 0.5)

    now = view(base).all

    assert list(now) == base.rules()
    assert [rule.trust for rule in now] == [rule.trust for rule in base.rules()]


@settings(max_examples=20, deadline=None)
@given(st.lists(rules, min_size=1, max_size=6), st.integers(0, 6))
def test_later_sentences_do_not_change_what_was(taught: list[Rule], until: int):
    """The base as it was after N sentences is the base that was told only those."""
    until = min(until, len(taught))
    whole, part = (KnowledgeBase(open_store("memory:"), clock=ticking()) for _ in range(2))
    teach(whole, *taught)
    teach(part, *taught[:until])

    assert list(view(whole, at=until).all) == part.rules()


def test_retracted_rule_held_until_it_was_taken_back(paper: KnowledgeBase):
    """Before it is there, after it is not; by time as by number."""
    paper.retract(BLADE.id, "Forget that.", "", "sam")
    taken_back = paper.utterance(4).time

    assert BLADE.id in ids(view(paper, at=3).all)
    assert BLADE.id in ids(view(paper, at=taken_back - timedelta(milliseconds=1)).all)
    assert BLADE.id not in ids(view(paper, at=taken_back).all)


def test_superseded_rule_held_until_it_was_corrected(kb: KnowledgeBase):
    """A correction replaces; the view of before still has what it replaced."""
    teach(kb, CUTTING)
    kb.believe("No, often.", "x", "sam", [OFTEN], supersedes=[CUTTING.id], kind="correction")

    assert ids(view(kb, at=1).all) == [CUTTING.id]
    assert ids(view(kb, at=2).all) == [OFTEN.id]


def test_rules_weigh_as_far_as_speakers_were_trusted_then(kb: KnowledgeBase):
    """Trust is part of how the base was."""
    kb.set_trust("anna", 0.5)
    teach(kb, CUTTING, speaker="anna")
    kb.set_trust("anna", 0.9)

    weights = [view(kb, at=number).all[0].trust for number in (2, 3)]

    assert weights == [0.5, 0.9]


def test_one_person_s_view_has_what_that_person_said(kb: KnowledgeBase):
    """What somebody else takes back, its teller still holds; and trusts himself."""
    kb.set_trust("anna", 0.5)
    teach(kb, CUTTING, speaker="anna")
    teach(kb, BLADE)
    (told,) = kb.rules(speaker="anna")
    kb.retract(told.id, "Anna is wrong.", "", "sam")

    assert kb.rules(speaker="anna") == []
    assert ids(view(kb, according_to="anna").all) == [told.id]
    assert view(kb, according_to="anna").all[0].trust == 1.0
    assert ids(view(kb, according_to="sam").all) == [BLADE.id]


def test_view_is_asked_as_a_base_is(paper: KnowledgeBase):
    """The same filters and the same hot question."""
    past = view(paper, at=3)

    for wanted in ({"object": "knife"}, {"affordance": "cutting"}, {"context": "pass"},
                   {"part": "handle"}, {"speaker": "sam"}, {"object": "mug"}):  # fmt: skip
        assert past.rules(**wanted) == paper.rules(**wanted)
    assert past.rules_at_nodes(["pass.graspObject"]) == paper.rules_at_nodes(["pass.graspObject"])
    assert ids(past.rules_at_nodes(["findObject.cutting"])) == [CUTTING.id]
    assert HANDLE.id in ids(past.all)


def test_unknown_utterance_or_speaker_is_an_error(paper: KnowledgeBase):
    """The message tells what there is."""
    with pytest.raises(UnknownNameError, match=r'no utterance "4".*0 to 3'):
        view(paper, at=4)
    with pytest.raises(UnknownNameError, match=r'no speaker "eve".*sam'):
        view(paper, according_to="eve")


def test_moments_are_read_as_people_write_them():
    """A number, a time with or without zone, and a day until its end."""
    assert parse_moment("7") == 7
    assert parse_moment("2026-11-21T09:00:00Z") == START
    assert parse_moment("2026-11-21T10:00+01:00") == START
    local = parse_moment("2026-11-21")
    assert isinstance(local, datetime)
    assert local.astimezone().strftime("%H:%M") == "23:59"
    assert local.tzinfo is not None
    with pytest.raises(DataError, match="yesterday: expected a date"):
        parse_moment("yesterday")


def test_trust_that_came_with_a_base_is_as_it_is_now(kb: KnowledgeBase):
    """Where the history says nothing about a speaker, the trust of now counts."""
    teach(kb, CUTTING, speaker="bob")

    assert view(kb).all[0].trust == 0.0
    assert START.tzinfo == timezone.utc


FILED = """
@prefix hilt: <https://w3id.org/hilt#> .
@prefix object: <https://w3id.org/hilt/object/> .
@prefix part: <https://w3id.org/hilt/part/> .
@prefix action: <https://w3id.org/hilt/action/> .
@prefix rule: <https://w3id.org/hilt/rule/> .
@prefix speaker: <https://w3id.org/hilt/speaker/> .
@prefix prov: <http://www.w3.org/ns/prov#> .
rule:mug a hilt:ActionRule ; hilt:feature object:mug ; hilt:context action:pass ;
    hilt:functor hilt:graspObject ; hilt:part part:handle ; hilt:lower 0.75 ; hilt:upper 1.0 ;
    hilt:status hilt:active ; prov:wasAttributedTo speaker:eve .
"""


def test_view_of_somebody_whose_rules_came_in_a_file(kb: KnowledgeBase):
    """Who never said anything here can still be asked for."""
    import_text(kb, FILED.encode(), format="turtle")

    assert [rule.speaker for rule in view(kb, according_to="eve").all] == ["eve"]


def test_rule_that_came_taken_back_never_holds(kb: KnowledgeBase):
    """A view of now is the base, also for rules that nothing said here ended."""
    import_text(kb, FILED.replace("hilt:active", "hilt:retracted").encode(), format="turtle")

    assert (kb.rules(), view(kb).all) == ([], ())


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
