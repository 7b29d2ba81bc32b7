# SPDX-License-Identifier: Apache-2.0
"""Tests of the hypotheses of the verification.

teaching    H1: a learning scenario taught by sentence in order, shuffled, and with every sentence
            twice gives the same rules, which are the rules taught; and the graph of beliefs is the
            union of the graphs after each sentence alone
situations  H2: for every scene and command under one learning scenario, only the cells of the
            objects in the scene and of the parts of the chosen object are read. If there is no
            choice, rules about absent objects are read afterwards, to name one that would do.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from random import Random

from ....inference.types import Target
from ....kb.rule import Rule
from ...agent import Agent
from ...config import AgentConfig
from ..learning_scenarios import ACTIONS, CONTEXTS
from .finite_cases import CheckResult, VerbalizedSpace, differences, highest_codes, parts_mask
from .scenario_space import CONFIDENCES, Codes, RuleKey, ScenarioSpace, code_of
from .taught_agent import GraphStatement, TaughtAgent, acceptable_candidates, belief_statements


def scenario_codes(space: ScenarioSpace, seed: int) -> Codes:
    """Return the learning scenario of a seed; with seed 0 everything is taught."""
    return space.drawn(seed) if seed else (space.full,) * len(space.cells)


def check_teaching(taught_space: VerbalizedSpace, seed: int) -> CheckResult:
    """Check H1: teach a learning scenario by sentence in three ways, and read the beliefs back."""
    space = taught_space.space
    codes = scenario_codes(space, seed)
    rng = Random(seed)  # noqa: S311 - orders, not secrets
    once = space.sentences(codes)
    shuffled = rng.sample(once, len(once))
    doubled = rng.sample(once * 2, len(once) * 2)
    bases = [_teach(sentences) for sentences in (once, shuffled, doubled)]
    held = [_read_back(space, rules) for rules, _ in bases]
    wrong = [f"{codes} is read back as {each}" for each in held if each != list(codes)]
    if not bases[0] == bases[1] == bases[2]:
        wrong.append("the beliefs depend on the order of teaching")
    apart = (taught_space.statements_of(each) for each in once)
    if bases[0][1] != frozenset[GraphStatement]().union(*apart):
        wrong.append("the beliefs are not the union of the beliefs from each sentence")
    return {"codes": codes, "held": held, "told": [len(once), len(shuffled), len(doubled)]}, wrong


def _teach(sentences: Sequence[str]) -> tuple[frozenset[Rule], frozenset[GraphStatement]]:
    """Return the rules and the graph of beliefs after telling sentences."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        for sentence in sentences:
            agent.hear(sentence, only="tell")
        rules = frozenset(replace(r, utterance=None, time=None) for r in agent.base.rules())
        return rules, belief_statements(agent.base)


def _read_back(space: ScenarioSpace, rules: frozenset[Rule]) -> list[int]:
    names = {(number, 1.0): level for level, number in CONFIDENCES.items()}
    levels: dict[RuleKey, list[str]] = {cell: [] for cell in space.cells}
    for rule in rules:
        levels[RuleKey.from_rule(rule)].append(names[rule.interval.lower, rule.interval.upper])
    return [code_of(levels[cell]) for cell in space.cells]


def check_situations(taught_space: VerbalizedSpace, seed: int, action: int) -> CheckResult:
    """Check H2: one action in all scenes for all affordances, with the cells that were read.

    A line of the digest gives the scene, the affordance, the acceptable objects, the acceptable
    parts of the first of them, and the cells read.
    """
    space = taught_space.space
    codes = scenario_codes(space, seed)
    with taught_space.taught_agent(codes) as taught:
        lines = list(_lines(taught_space, taught, list(ACTIONS)[action]))
    truth = [_expected_line(space, codes, list(ACTIONS)[action], *line[:2]) for line in lines]
    wrong = differences(lines, truth)
    text = "".join(f"{' '.join(map(str, line))}\n" for line in lines)
    counts = [sum(min(line[2].bit_count(), 2) == n for line in lines) for n in range(3)]
    facts = {"codes": codes, "none": counts[0], "unique": counts[1], "ties": counts[2]}
    return {**facts, "digest": hashlib.sha256(text.encode()).hexdigest()}, wrong


Line = tuple[int, int, int, int, int]  # scene, affordance, objects, parts, cells read


def _lines(taught_space: VerbalizedSpace, taught: TaughtAgent, action: str) -> Iterator[Line]:
    space = taught_space.space
    for mask in range(2 ** len(space.objects)):
        for number, affordance in enumerate(space.affordances):
            decided = taught.decide(action, Target(used_for=affordance), space.scene(mask))
            names = [each.object for each in acceptable_candidates(decided.object)]
            parts = parts_mask(space, names[0], decided) if names else 0
            yield mask, number, space.mask(names), parts, taught_space.cell_mask(decided.read)


def _expected_line(
    space: ScenarioSpace, codes: Codes, action: str, mask: int, affordance: int
) -> Line:
    """Return the line according to the definition, from the codes alone."""
    scene = [i for i in range(len(space.objects)) if mask >> i & 1]
    cells = [i * len(space.affordances) + affordance for i in scene]
    tops = highest_codes([codes[cell] for cell in cells])
    objects = [name for i, name in enumerate(scene) if tops >> i & 1]
    grasped = _part_cells(space, action, objects[0]) if objects else []
    parts = highest_codes([codes[cell] for cell in grasped])
    step = len(space.affordances)
    everywhere = range(affordance, len(space.objects) * step, step)
    read = sum(1 << cell for cell in (*(cells if objects else everywhere), *grasped) if codes[cell])
    return mask, affordance, sum(1 << i for i in objects), parts, read


def _part_cells(space: ScenarioSpace, action: str, number: int) -> list[int]:
    """Return the cells of the parts of an object for an action; none if it does not grasp."""
    name = space.objects[number]
    contexts = [context for context in CONTEXTS if context == action]
    return [space.index[RuleKey(name, part, c)] for c in contexts for part in space.parts[name]]
