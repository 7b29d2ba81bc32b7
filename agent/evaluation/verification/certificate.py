# SPDX-License-Identifier: Apache-2.0
"""The certificate: the results of all finite cases in one document that others can check.

`examples/check_certificate.py` computes it again from the definition, without Hilt, and compares
number by number.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb
from typing import cast

from ...execution.outcome import Json
from ..scenarios import ACTIONS, CONTEXTS, LEVELS
from .space import ScenarioSpace

FORMAT = 1
OUTCOMES = ("none", "unique", "ties")
Facts = Mapping[str, Sequence[Json]]


def make_certificate(space: ScenarioSpace, facts: Facts, pinned: Json) -> Json:
    """Return the certificate of a run.

    Args:
        space: the space that was verified.
        facts: kind of cases -> their facts, in the order of the cases.
        pinned: the settings used.
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
        "teaching": list(facts.get("teaching", ())),
        "situations": list(facts.get("situations", ())),
    }


def count_totals(space: ScenarioSpace, facts: Facts) -> Json:
    """Return the numbers of cases, and of rule states over the whole space by outcome.

    A rule state is a way to teach the cells of one affordance, with a scene; its outcome is that
    there is no right choice, a unique one, or ties.
    """
    counted = {
        "words": len(space.cells) * len(LEVELS) + len(space.commands()) + 2 ** len(space.objects),
        "scores": len(space.cells) * (space.full + 1),
        "choices": sum(_count(block, outcome) for block in _choices(facts) for outcome in OUTCOMES),
        "grasps": len(space.objects) * len(CONTEXTS) * (space.full + 1) ** 2,
    }
    return {
        "cases": counted | {"all": sum(counted.values())},
        "situations": 2 ** len(space.objects) * len(space.commands()),
        "rules": len(space.cells) * len(LEVELS),
        "rule_states": {outcome: _states(space, facts, outcome) for outcome in OUTCOMES},
    }


def _choices(facts: Facts) -> Sequence[Json]:
    return facts.get("choices", ())


def _count(block: Json, outcome: str) -> int:
    return cast("int", block[outcome])


def _states(space: ScenarioSpace, facts: Facts, outcome: str) -> int:
    """Return the number of rule states with an outcome: m levels can be any m non-zero codes."""
    return sum(
        _count(block, outcome) * comb(space.full, cast("int", block["levels"]))
        for block in _choices(facts)
    )
