"""The interval of experience, and how it discounts what was told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from math import comb

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.stats import beta

from hilt.inference.affordance import Affordances
from hilt.inference.experience import (
    CREDIBILITY,
    NO_TRIALS,
    Experience,
    GraspRecord,
    OutcomeCounts,
    contradiction,
    credible_interval,
    read_records,
    teacher_records,
)
from hilt.inference.types import Candidate, Goal, Observation, Target
from hilt.kb.episodes import HELD, Episode, GraspTrial
from hilt.kb.interval import VACUOUS, Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Atom, Rule, grasping

from .rule_sources import Told

TAIL = (1 - CREDIBILITY) / 2
HIGH = Interval(0.95, 1)
PASS = Goal("pass", Target(object="screwdriver"))
SEEN = Observation(
    "screwdriver", "screwdriver", {Atom("object", "screwdriver"): Interval(1.0, 1.0)}
)


@st.composite
def counts(draw: st.DrawFn, most: int = 60) -> tuple[int, int]:
    """How many grasps held, of how many."""
    trials = draw(st.integers(0, most))
    return draw(st.integers(0, trials)), trials


class KnownCounts:
    """Experience with the parts of one object."""

    def __init__(self, **parts: OutcomeCounts) -> None:
        self.parts = parts

    def of(self, name: str, part: str, context: str) -> OutcomeCounts:
        """Return the counts of a part, for passing only."""
        return self.parts.get(part, NO_TRIALS) if context == "pass" else NO_TRIALS


def outcomes(held: int, trials: int) -> OutcomeCounts:
    """Counts of grasps that held, or else slipped."""
    return OutcomeCounts.of({"held": held, "slipped": trials - held})


def decided(*rules: Rule, **parts: OutcomeCounts) -> tuple[Candidate, ...]:
    """The candidates for passing the screwdriver, with this experience."""
    engine = Affordances(Told(*rules), experience=KnownCounts(**parts))
    return engine.infer("pass/graspObject", PASS, [SEEN]).candidates


def test_without_trials_nothing_is_known():
    """No trial is ignorance."""
    assert credible_interval(0, 0) == VACUOUS


@given(counts())
def test_the_share_that_held_is_inside(trial: tuple[int, int]):
    """The interval is one of probabilities around the observed share."""
    held, trials = trial
    assume(trials)

    interval = credible_interval(held, trials)

    assert 0 <= interval.lower <= held / trials <= interval.upper <= 1


@given(counts())
def test_bounds_are_the_quantiles_of_beta_distributions(trial: tuple[int, int]):
    """They agree with another implementation."""
    held, trials = trial

    interval = credible_interval(held, trials)

    lower = beta.ppf(TAIL, held, trials - held + 1) if held else 0.0
    upper = beta.ppf(1 - TAIL, held + 1, trials - held) if held < trials else 1.0
    assert interval.lower == pytest.approx(lower, abs=1e-9)
    assert interval.upper == pytest.approx(upper, abs=1e-9)


@given(counts())
def test_lower_bound_solves_its_equation(trial: tuple[int, int]):
    """At the lower bound, as many successes or more are as rare as the tail."""
    held, trials = trial
    assume(held)
    share = credible_interval(held, trials).lower

    tail = sum(
        comb(trials, k) * share**k * (1 - share) ** (trials - k) for k in range(held, trials + 1)
    )

    assert tail == pytest.approx(TAIL, rel=1e-6)


@given(counts())
def test_success_and_failure_are_symmetric(trial: tuple[int, int]):
    """Exchanging them negates the interval."""
    held, trials = trial

    mirrored = credible_interval(trials - held, trials).negated()

    assert credible_interval(held, trials).lower == pytest.approx(mirrored.lower, abs=1e-12)
    assert credible_interval(held, trials).upper == pytest.approx(mirrored.upper, abs=1e-12)


@given(counts())
def test_success_raises_and_failure_lowers_both_bounds(trial: tuple[int, int]):
    """The interval is monotone in the counts."""
    held, trials = trial
    now = credible_interval(held, trials)

    better, worse = credible_interval(held + 1, trials + 1), credible_interval(held, trials + 1)

    assert better.lower >= now.lower
    assert better.upper >= now.upper
    assert worse.lower <= now.lower
    assert worse.upper <= now.upper


@given(counts(20), st.integers(2, 10))
def test_more_of_the_same_narrows_the_interval(trial: tuple[int, int], times: int):
    """At an equal share, more trials say more."""
    held, trials = trial
    assume(trials)

    assert credible_interval(times * held, times * trials).width < (
        credible_interval(held, trials).width
    )


@pytest.mark.parametrize(("held", "trials"), [(500, 1000), (3, 10_000), (9_999, 10_000)])
def test_large_counts_are_no_problem(held: int, trials: int):
    """There is no overflow."""
    upper = beta.ppf(1 - TAIL, held + 1, trials - held)

    assert credible_interval(held, trials).upper == pytest.approx(upper, rel=1e-9)


# --- What was told, discounted ---------------------------------------------------------------


@given(counts(), st.floats(0.5, 1))
def test_experience_discounts_what_was_told_and_never_denies_it(
    trial: tuple[int, int], told: float
):
    """The belief falls to a·u; nothing is believed to the contrary."""
    rule = grasping("screwdriver", "shaft", "pass", interval=Interval(told, 1))
    upper = credible_interval(*trial).upper

    (candidate,) = decided(rule, shaft=outcomes(*trial))

    assert candidate.interval.lower == pytest.approx(rule.interval.lower * upper)
    assert candidate.interval.upper == 1
    assert candidate.told == rule.interval
    assert candidate.contradiction == pytest.approx(rule.interval.lower * (1 - upper))


def test_failures_do_not_weaken_a_prohibition():
    """A part that is forbidden stays forbidden however it did."""
    never = grasping("screwdriver", "shaft", "pass", interval=Interval(0, 0.05))

    for held, trials in product(range(4), range(4)):
        if held <= trials:
            (candidate,) = decided(never, shaft=outcomes(held, trials))
            assert (candidate.verdict, candidate.interval) == ("denied", candidate.told)


def test_other_parts_and_contexts_are_not_touched():
    """Experience is that of the part and the action at hand."""
    rule = grasping("screwdriver", "shaft", interval=HIGH)
    engine = Affordances(
        Told(rule), experience=KnownCounts(shaft=outcomes(0, 9), handle=outcomes(0, 9))
    )

    lifted = engine.infer("pickUp/graspObject", PASS, [SEEN]).candidates
    passed = engine.infer("pass/graspObject", PASS, [SEEN]).candidates

    assert [each.interval for each in lifted] == [HIGH]
    assert passed[0].interval.lower < HIGH.lower


def test_experience_is_of_grasps_alone():
    """What else is done with something is as certain as it was told, and no trial is no step."""
    rule = Rule(frozenset(SEEN.atoms), frozenset(), "cutWith", Atom("object", "bread"), HIGH)
    grasp = grasping("screwdriver", "shaft", interval=HIGH)
    engine = Affordances(Told(rule, grasp), experience=KnownCounts(bread=outcomes(0, 9)))

    for node in ("pass/cutWith", "pass/graspObject"):
        [found] = engine.infer(node, PASS, [SEEN]).candidates
        assert (found.interval, found.experience, found.proof.step) == (HIGH, None, "modus ponens")


def test_what_was_told_is_kept_apart_from_experience():
    """The contradiction is that of the rules alone with experience."""
    [shaft] = decided(grasping("screwdriver", "shaft", interval=HIGH), shaft=outcomes(0, 9))

    assert shaft.told == HIGH
    assert shaft.contradiction == contradiction(HIGH, outcomes(0, 9).interval)


def test_the_proof_shows_experience_and_gives_the_numbers_again():
    """What was told is discounted in a step of its own, which can be evaluated."""
    rule = grasping("screwdriver", "shaft", "pass", interval=HIGH)
    engine = Affordances(Told(rule), experience=KnownCounts(shaft=outcomes(1, 5)))

    (candidate,) = engine.infer("pass/graspObject", PASS, [SEEN]).candidates

    lines = "\n".join(candidate.proof.lines())
    assert candidate.proof.evaluate(engine.settings.operators) == candidate.interval
    assert "discount" in lines
    assert "[0.01, 0.72]  experienced  held 1, slipped 4 of 5" in lines


def test_contradiction_is_the_mass_of_conflict():
    """Only failure contradicts what supports a grasp."""
    assert contradiction(Interval(0.8, 1), Interval(0, 0.5)) == pytest.approx(0.4)
    assert contradiction(Interval(0.8, 1), VACUOUS) == 0
    assert contradiction(VACUOUS, Interval(0, 0.1)) == 0


def test_counts_since_an_earlier_time():
    """What was forgotten meanwhile counts as nothing."""
    earlier, later = outcomes(2, 5), outcomes(3, 9)

    assert later.since(earlier) == outcomes(1, 4)
    assert earlier.since(later) == NO_TRIALS
    assert earlier + later == outcomes(5, 14)


# --- Teachers --------------------------------------------------------------------------------


def test_record_of_a_teacher_counts_what_the_rules_say():
    """Grasps by a part that a teacher named count for that teacher, others do not."""
    rules = [
        grasping("screwdriver", "shaft", "pass", interval=HIGH, speaker="kim"),
        grasping("*", "handle", "pass", interval=HIGH, speaker="anna"),
        grasping("knife", "blade", "pass", interval=Interval(0, 0.05), speaker="lee"),
    ]
    records = [
        GraspRecord("screwdriver", "shaft", "pass", "panda", outcomes(0, 5)),
        GraspRecord("screwdriver", "handle", "pass", "panda", outcomes(5, 5)),
        GraspRecord("screwdriver", "shaft", "pickUp", "panda", outcomes(5, 5)),
        GraspRecord("knife", "blade", "pass", "panda", outcomes(5, 5)),
    ]
    trust = {"kim": Interval(1, 1), "anna": Interval(0.3, 1)}

    anna, kim = teacher_records(rules, trust, records)

    assert (anna.speaker, anna.counts) == ("anna", outcomes(5, 5))
    assert anna.suggested == pytest.approx(credible_interval(5, 5).lower)
    assert (kim.speaker, kim.counts) == ("kim", outcomes(0, 5))
    assert kim.suggested == pytest.approx(credible_interval(0, 5).upper)


@given(counts(), st.floats(0, 1))
def test_suggested_trust_changes_no_more_than_needed(trial: tuple[int, int], trust: float):
    """It stays where the record agrees with it, and moves to the nearer bound otherwise."""
    rule = grasping("mug", "handle", interval=HIGH, speaker="kim")
    record = GraspRecord("mug", "handle", "pass", "panda", outcomes(*trial))

    (kim,) = teacher_records([rule], {"kim": Interval(trust, 1)}, [record])

    bounds = credible_interval(*trial)
    assert kim.suggested == sorted((bounds.lower, trust, bounds.upper))[1]


# --- Read from a base ------------------------------------------------------------------------

SLIP = GraspTrial("knife", "blade", "pass", "slipped", "panda")
EPISODE = Episode(
    goal="pass(self,knife)", text="pass me the knife", speaker="sam", outcome="done",
    said="Here is the knife.", seed=7, document="{}",
)  # fmt: skip


@pytest.fixture
def base() -> Iterator[KnowledgeBase]:
    """A base with one episode: of two grasps by the blade one held."""
    with KnowledgeBase.open("memory:") as found:
        found.believe("A knife is used for cutting", "", "sam", [])
        found.record_episode(replace(EPISODE, trials=(SLIP, replace(SLIP, outcome=HELD))))
        yield found


def test_records_name_objects_parts_and_actions_plainly(base: KnowledgeBase):
    """Names are those of the rules, and the outcomes are counted."""
    counts = OutcomeCounts.of({HELD: 1, "slipped": 1})

    assert read_records(base) == [GraspRecord("knife", "blade", "pass", "panda", counts)]


def test_experience_is_that_of_the_robot_until_an_utterance(base: KnowledgeBase):
    """Others' grasps do not count, nor those after the utterance that is given."""
    for before, robot, trials in [(None, "panda", 2), (None, "ur5", 0), (1, "panda", 0)]:
        assert Experience(base, robot, before=before).of("knife", "blade", "pass").trials == trials


def test_experience_is_read_once_until_the_base_changes(
    base: KnowledgeBase, monkeypatch: pytest.MonkeyPatch
):
    """What was asked for is kept; another episode counts at once."""
    select, asked = base.select, list[object]()
    monkeypatch.setattr(base, "select", lambda *given: asked.append(given) or select(*given))
    experience = Experience(base, "panda")

    before = [experience.of("knife", part, "pass").trials for part in ("blade", "blade", "handle")]
    base.record_episode(replace(EPISODE, trials=(SLIP,)))
    after = experience.of("knife", "blade", "pass").trials

    assert (before, after, len(asked)) == ([2, 2, 0], 3, 2)


# --- Shown -----------------------------------------------------------------------------------


def test_counts_are_shown_with_their_number():
    """Each outcome with how often it occurred; failures are all but what held."""
    counts = OutcomeCounts.of({HELD: 2, "wrong_part": 1, "slipped": 0})

    assert str(counts) == "held 2, wrong part 1 of 3"
    assert str(NO_TRIALS) == "none"
    assert counts.failures == {"wrong_part": 1}


def test_speaker_without_known_trust_is_not_trusted():
    """The record is there all the same, and figures have six digits."""
    rule = grasping("knife", "blade", "pass", interval=HIGH, speaker="kim")
    record = GraspRecord("knife", "blade", "pass", "panda", outcomes(3, 3))

    [kim] = teacher_records([rule], {}, [record])

    assert kim.trust == 0.0
    assert kim.as_json()["suggested"] == round(TAIL ** (1 / 3), 6)
