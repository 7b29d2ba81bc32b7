"""Claims about the base as it was, and about one person's view."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Rule, functional
from hilt.kb.stores.opening import open_store
from hilt.kb.views import parse_moment, view
from hilt.ontology.errors import DataError, UnknownNameError

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
