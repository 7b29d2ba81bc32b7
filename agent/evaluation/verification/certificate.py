"""The certificate: the results of all finite cases in one document that others can check.

`examples/check_certificate.py` computes it again from the definition, without Hilt, and compares
number by number.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb
from typing import cast

from ...execution.outcome import Json
from ..learning_scenarios import ACTIONS, CONTEXTS, LEVELS
from .scenario_space import ScenarioSpace

FORMAT = 2
OUTCOMES = ("none", "unique", "ties")
Facts = Mapping[str, Sequence[Json]]


def make_certificate(space: ScenarioSpace, facts: Facts, pinned: Json) -> Json:
    """Return the certificate of a run over a space, with the settings that were used (`pinned`).

    `facts` maps each kind of cases to their facts, in the order of the cases.
    """
    return {
        "format": FORMAT,
        "objects": list(space.objects),
        "affordances": list(space.affordances),
        "parts": {name: list(space.parts[name]) for name in space.objects},
        "contexts": list(CONTEXTS),
        "actions": list(ACTIONS),
        "levels": list(LEVELS),
        **pinned,
        **(facts["words"][0] if "words" in facts else {}),
        "scores": [each["rows"] for each in facts.get("scores", ())],
        "choices": list(facts.get("choices", ())),
        "grasps": [each["rows"] for each in facts.get("grasps", ())],
        **{name: list(facts.get(name, ())) for name in ("teaching", "situations", "growth")},
    }


def count_totals(space: ScenarioSpace, facts: Facts) -> Json:
    """Return the numbers of cases, and of rule states over the whole space by outcome.

    A rule state is a way to teach the cells of one affordance, with a scene; its outcome is that
    there is no right choice, a unique one, or ties.
    """
    choices = cast("Sequence[dict[str, int]]", facts.get("choices", ()))
    counted = {
        "words": len(space.cells) * len(LEVELS) + len(space.commands()) + 2 ** len(space.objects),
        "scores": len(space.cells) * (space.full + 1),
        "choices": sum(block[outcome] for block in choices for outcome in OUTCOMES),
        "grasps": len(space.objects) * len(CONTEXTS) * (space.full + 1) ** 2,
    }
    return {
        "cases": counted | {"all": sum(counted.values())},
        "situations": 2 ** len(space.objects) * len(space.commands()),
        "rules": len(space.cells) * len(LEVELS),
        "rule_states": {  # m levels can be any m non-zero codes
            outcome: sum(block[outcome] * comb(space.full, block["levels"]) for block in choices)
            for outcome in OUTCOMES
        },
    }
