# SPDX-License-Identifier: Apache-2.0
"""Conflicts, abduction, and induction by likeness."""

import pytest

from hilt.inference.abduction import find_hypotheses
from hilt.inference.conflicts import find_conflicts
from hilt.inference.induction import CAUTION, InducedRule, induce
from hilt.inference.types import Conclusion
from hilt.kb.interval import Interval
from hilt.kb.rule import Atom, Rule, functional, grasping
from hilt.ontology.objects import load_household

CUTTING = Conclusion("usedFor", Atom("affordance", "cutting"))
G, S, NEVER = Interval(0.95, 1.0), Interval(0.5, 1.0), Interval(0.0, 0.05)
CUTS = functional("knife", "cutting", interval=G)
BLADE = grasping("knife", "blade", "pass", interval=G)
HANDLE = grasping("knife", "handle", "pickUp", interval=G)


# --- Conflicts -----------------------------------------------------------------------------


def test_assertion_and_denial_conflict_by_their_mass():
    """K is what Dempster's rule would give to the empty set."""
    denial = functional("knife", "cutting", interval=NEVER, speaker="kim")

    (found,) = find_conflicts([CUTS, denial, HANDLE])

    assert {found.first, found.second} == {CUTS, denial}
    assert found.weight == pytest.approx(0.95 * 0.95)


def test_more_of_the_same_is_no_conflict():
    """Often and generally agree; two parts for two contexts have nothing to do with each other."""
    assert find_conflicts([CUTS, functional("knife", "cutting", interval=S), BLADE, HANDLE]) == []


# --- Abduction -----------------------------------------------------------------------------


def test_what_would_have_to_be_true_to_be_used_for_cutting():
    """Every antecedent that would do, the likeliest first."""
    sharp = Rule(
        frozenset({Atom("property", "sharp")}), frozenset(), "usedFor",
        Atom("affordance", "cutting"), S,
    )  # fmt: skip

    found = find_hypotheses([sharp, CUTS, BLADE], CUTTING)

    assert [each.features for each in found] == [
        frozenset({Atom("object", "knife")}),
        frozenset({Atom("property", "sharp")}),
    ]


def test_context_that_explains_a_grasp():
    """Passing explains that the knife was taken by the blade."""
    given = frozenset({Atom("object", "knife")})

    (found,) = find_hypotheses(
        [BLADE, HANDLE], Conclusion("graspObject", Atom("part", "blade")), given=given
    )

    assert (found.features, found.contexts) == (frozenset(), {Atom("action", "pass")})


def test_denied_conclusion_explains_nothing():
    """A rule that speaks against the conclusion is no way to it."""
    denial = functional("spoon", "cutting", interval=NEVER)

    assert find_hypotheses([denial], CUTTING) == []


# --- Induction -----------------------------------------------------------------------------


def induced(*rules: Rule) -> dict[tuple[str | None, str | None], InducedRule]:
    """What is induced over the household, by object and context."""
    household = load_household()
    found = induce(rules, household.objects, classes=household.classes)
    return {(each.rule.object, each.rule.context): each for each in found}


def test_screwdriver_is_passed_as_the_knife_is():
    """The paper's own example: by the end that is like the blade."""
    found = induced(BLADE)["screwdriver", "pass"]

    assert found.rule.part == "shaft"
    assert {"property:pointed", "tool"} <= set(found.shared)
    assert (found.rule.status, found.source) == ("induced", BLADE)


def test_grip_answers_to_grip():
    """Parts are paired together, so that a handle never stands for a blade."""
    found = induced(BLADE)

    assert {each.rule.part for each in found.values()} & {"handle"} == set()
    assert found["spoon", "pass"].rule.part == "bowl"


def test_induced_rule_is_never_surer_than_what_was_taught():
    """Likeness and caution discount it."""
    for each in induced(BLADE, HANDLE, CUTS).values():
        bound = each.source.interval.lower * CAUTION * each.similarity
        assert each.rule.interval.lower == pytest.approx(bound, abs=1e-6)
        assert each.rule.interval.lower < each.source.interval.lower


def test_nothing_is_induced_where_something_was_taught():
    """A taught rule about the screwdriver leaves nothing to guess."""
    taught = grasping("screwdriver", "handle", "pass", interval=S)

    assert ("screwdriver", "pass") not in induced(BLADE, taught)


def test_contradiction_takes_back_what_was_induced():
    """Being told never to do so is being taught too."""
    taught = grasping("screwdriver", "shaft", "pass", interval=NEVER)

    assert ("screwdriver", "pass") not in induced(BLADE, taught)


def test_unlike_things_get_nothing():
    """A shoe is not like a knife."""
    assert ("shoe", "pass") not in induced(BLADE)
