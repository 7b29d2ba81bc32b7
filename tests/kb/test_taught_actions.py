"""Taught actions in the base: kept, replaced, exported, merged, validated and forgotten."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from hilt.kb import KnowledgeBase
from hilt.kb.formats.import_export import export_file, import_file
from hilt.kb.learned import ACTIONS, TAUGHT_ACTIONS, TaughtAction
from hilt.kb.rule import Atom
from hilt.kb.validation import check_invariants, check_shapes
from hilt.ontology.errors import NotFoundError

SERVE = TaughtAction(
    Atom("action", "serve"),
    '{"action":"serve","parameters":["mug"],"steps":[]}',
    "To serve a mug, pick it up.",
    "sam",
    nodes=("serve", "serve/pickUp"),
)


def teach(base: KnowledgeBase, action: TaughtAction = SERVE) -> None:
    """Tell an action."""
    base.believe(action.said, "", action.speaker, (), actions=[action])


def test_an_action_is_kept_in_its_own_graph(tmp_path: Path) -> None:
    """With who taught it and when, after the base was closed, too; the base stays valid."""
    with KnowledgeBase.open(tmp_path / "kb") as base:
        teach(base)
    with KnowledgeBase.open(tmp_path / "kb") as base:
        (kept,) = base.actions()

        assert kept == replace(SERVE, utterance=1)
        assert base.utterance(1).text == SERVE.said
        assert list(base.store.quads(None, None, None, ACTIONS))
        assert [*check_invariants(base.store), *check_shapes(base.store)] == []


def test_of_two_with_one_name_the_last_holds() -> None:
    """The first stays in the graph, retracted."""
    again = replace(SERVE, meaning='{"action":"serve","parameters":["knife"],"steps":[]}')
    with KnowledgeBase.open("memory:") as base:
        teach(base)
        teach(base, again)

        assert [each.meaning for each in base.actions()] == [again.meaning]


def test_an_action_is_forgotten_by_its_name() -> None:
    """The history says so, and a second time it is not there."""
    with KnowledgeBase.open("memory:") as base:
        teach(base)
        base.forget(TAUGHT_ACTIONS, "serve", "forget how to serve", "sam")

        assert base.actions() == []
        assert [each.text for each in base.history()][-1] == "forget how to serve"
        with pytest.raises(NotFoundError, match="taught action"):
            base.forget(TAUGHT_ACTIONS, "serve", "forget how to serve", "sam")


def test_an_action_goes_with_an_export(tmp_path: Path) -> None:
    """N-Quads of one base are imported into another, which numbers the utterance anew."""
    file = tmp_path / "base.nq"
    with KnowledgeBase.open("memory:") as base, KnowledgeBase.open("memory:") as other:
        teach(base)
        export_file(base, file, rules_only=False)
        other.record("hello", "", "sam", "acknowledgement", accepted=True)
        import_file(other, file)

        (found,) = other.actions()
        assert found == replace(SERVE, utterance=found.utterance)
        assert found.utterance and other.utterance(found.utterance).text == SERVE.said
