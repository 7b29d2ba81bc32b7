"""Learned words are kept with their teacher, and can be revoked."""

from dataclasses import replace

import pytest

from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.learned import LEXICON, WORDS, LearnedWord
from hilt.kb.rule import Atom, functional
from hilt.ontology.errors import UnknownNameError

SAW = LearnedWord(Atom("object", "saw"), "saw", "sam")
TEXT = "A saw is used for cutting"


@pytest.fixture
def base():
    """A base that learned of saws."""
    with KnowledgeBase.open("memory:") as kb:
        rule = functional("saw", "cutting", interval=Interval(0.95, 1.0))
        kb.believe(TEXT, "implies(saw,cutting,high)", "sam", [rule], words=[SAW], heard=0.8)
        yield kb


def test_word_keeps_its_teacher_and_its_sentence(base: KnowledgeBase):
    """Who taught it, and in which utterance, can be told."""
    (word,) = base.words()

    assert (word.atom, word.speaker) == (Atom("object", "saw"), "sam")
    assert base.utterance(word.utterance or 0).text == TEXT


def test_revoked_word_is_known_no_more_but_stays_in_the_graph(base: KnowledgeBase):
    """Forgetting changes its status."""
    base.forget(WORDS, "saw", "forget the word saw", "sam")

    assert base.words() == []
    assert any(base.store.quads(None, None, None, LEXICON))


def test_word_can_be_learned_again(base: KnowledgeBase):
    """What was revoked may be taught anew."""
    base.forget(WORDS, "saw", "forget the word saw", "sam")
    base.believe(TEXT, "", "sam", [], words=[SAW])

    assert [word.atom.name for word in base.words()] == ["saw"]


def test_unknown_word_cannot_be_forgotten(base: KnowledgeBase):
    """The error lists the words that were learned."""
    with pytest.raises(UnknownNameError, match="Known: saw"):
        base.forget(WORDS, "axe", "forget axe", "sam")


def test_recognition_score_stands_at_the_utterance(base: KnowledgeBase):
    """How surely it was heard is kept beside what was said."""
    assert base.utterance(1).heard == 0.8


def test_look_of_what_was_shown_is_replaced_by_the_last(base: KnowledgeBase):
    """There is one look at a time, and the names of the parts that it has."""
    for names in ('{"long":"handle"}', '{"long":"handle","wide":"blade"}'):
        shown = replace(SAW, look=f'{{"views":[],"masses":{{}},"names":{names}}}')
        base.believe("This is a saw", "", "sam", [], words=[shown])

    (word,) = base.words()

    assert word.parts == ("handle", "blade")
    assert word.as_json()["shown"]
    assert base.utterance(word.utterance or 0).speaker == "sam"


def test_look_is_not_known_again_after_its_word_was_forgotten(base: KnowledgeBase):
    """The word may be learned anew without it."""
    base.believe("This is a saw", "", "sam", [], words=[replace(SAW, look='{"names":{}}')])
    base.forget(WORDS, "saw", "forget the word saw", "sam")
    base.believe(TEXT, "", "sam", [], words=[SAW])

    assert [word.look for word in base.words()] == [""]
