"""Doubt about the part that was told for a grasp, when experience speaks against it.

Hilt doubts the best part by what was told where experience contradicts that by more than the
setting `contradiction`, or puts another part first. It is never replaced without a question.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from ...inference.affordance import Affordances
from ...inference.experience import NO_TRIALS, OutcomeCounts
from ...inference.node_rules import acting_for
from ...inference.types import Inference
from ...kb.interval import VACUOUS

DIGITS = 9  # of ranks that are compared


@dataclass(frozen=True)
class Doubt:
    """A part that was told for a grasp, and that experience speaks against."""

    object: str
    context: str  #: the action that it is grasped for
    part: str
    counts: OutcomeCounts  #: the outcomes of grasps by that part
    teachers: tuple[str, ...]
    #: the part that looks best of the others; None where none looks better
    instead: str | None = None
    counts_instead: OutcomeCounts = NO_TRIALS  #: the outcomes of grasps by that one


def find_doubt(
    inference: Inference, affordances: Affordances, kind: str, parts: Iterable[str]
) -> Doubt | None:
    """Return the doubt about the part to grasp an object by; None where there is none.

    `parts` are the known parts of this kind of object, of which the first are preferred.
    """
    settings, operators = affordances.settings, affordances.settings.operators
    rank, threshold = operators.rank, inference.threshold
    accepted = [each for each in inference.candidates if operators.accepts(each.told, threshold)]
    told = max(accepted, key=lambda each: round(rank(each.told), DIGITS), default=None)
    if told is None or told.part is None or told.experience is None:
        return None
    is_changed = inference.best is None or inference.best.argument != told.argument
    if told.contradiction <= settings.contradiction and not is_changed:
        return None
    context = acting_for(inference.node)
    known = {each.part: each for each in inference.candidates if each.part}

    def merit(part: str) -> tuple[float, float]:
        said = known[part].told if part in known else VACUOUS
        return round(rank(affordances.outcomes(kind, part, context).interval), DIGITS), rank(said)

    denied = {each.part for each in inference.denied}
    others = [part for part in dict.fromkeys((*known, *parts)) if part not in denied]
    best = max(others, key=merit)
    instead = best if merit(best)[0] > merit(told.part)[0] else None
    teachers = tuple(dict.fromkeys(rule.speaker for rule in told.rules if rule.asserts))
    tried = affordances.outcomes(kind, instead, context) if instead else NO_TRIALS
    return Doubt(kind, context, told.part, told.experience, teachers, instead, tried)
