# SPDX-License-Identifier: Apache-2.0
"""The certificate: what the program did in the finite cases, in one file that others can check.

It claims nothing that cannot be worked out again from the definition: `examples/check_certificate`
does so without Hilt, number by number.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb
from typing import cast

from ...execution.outcome import Json
from ..scenarios import ACTIONS, LEVELS
from .space import CONTEXTS, Space

FORMAT = 1
OUTCOMES = ("none", "unique", "ties")
Facts = Mapping[str, Sequence[Json]]


def certificate(space: Space, facts: Facts, pinned: Json) -> Json:
    """The certificate of a run.

    Args:
        space: what was verified.
        facts: what was found out, by what it is about, in the order of the cases.
        pinned: numbers that the program works with.
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


def totals(space: Space, facts: Facts) -> Json:
    """How many cases there were, and what they come to over the whole space.

    `choices` counts rule states: of all ways to teach the cells of one affordance, in all scenes,
    how many leave nothing, one thing or several to choose.
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


def _states(space: Space, facts: Facts, outcome: str) -> int:
    """The rule states with an outcome: m levels can be any m of the codes that teach something."""
    return sum(
        _count(block, outcome) * comb(space.full, cast("int", block["levels"]))
        for block in _choices(facts)
    )
