"""What goals and results are asked for by others."""

from __future__ import annotations

import pytest

from hilt.inference.proof import Proof
from hilt.inference.types import Candidate, Conclusion, Target
from hilt.kb.interval import CERTAIN
from hilt.kb.rule import Atom


@pytest.mark.parametrize(
    ("argument", "part"),
    [(Atom("part", "blade"), "blade"), (Atom("affordance", "cutting"), None), (None, None)],
)
def test_part_to_act_on_is_the_argument_if_it_is_a_part(argument: Atom | None, part: str | None):
    """A use is no part."""
    proof = Proof("given", CERTAIN)

    candidate = Candidate("knife", "knife", argument, proof, 1.0, "accepted", "")

    assert (candidate.part, candidate.inherited) == (part, 0)


def test_conclusion_is_written_with_its_argument():
    """Without one, the brackets are empty."""
    assert str(Conclusion("cutWith", Atom("object", "bread"))) == "cutWith(object:bread)"
    assert str(Conclusion("cutWith")) == "cutWith()"


def test_what_is_wanted_of_a_target_is_negated_where_it_is_not_to_be():
    """A use, what is no use, and another conclusion."""
    other = Conclusion("cutWith")
    target = Target(used_for="cutting", not_used_for="rolling", affords=other)

    assert [(str(each), negated) for each, negated in target.wanted] == [
        ("usedFor(affordance:cutting)", False),
        ("usedFor(affordance:rolling)", True),
        ("cutWith()", False),
    ]
