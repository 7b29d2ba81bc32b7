"""Tests of the hypotheses of the verification, which docs/verification.md states.

Each check returns its results as plain JSON, and a line for each deviation from the definition.
"""

import hashlib
from collections.abc import Iterator, Sequence
from random import Random

from ....inference.types import Inference, Target
from ....kb.rule import DEFAULT_SPEAKER, Rule
from ....sim.scene.scene import scene_with
from ...agent import Agent
from ...config import AgentConfig
from ..learning_scenarios import ACTIONS, CONTEXTS, LEVELS, command
from . import finite_cases, taught_agent
from .finite_cases import CheckResult
from .scenario_space import CONFIDENCES, Codes, ScenarioSpace, belief, bit_mask, code_of, sentence
from .taught_agent import RuleKey, TaughtAgent
from .weak_orders import tally

COMMANDS = 5  # given in each random learning scenario
Choice = list[int]  # scene, action, affordance, acceptable objects, acceptable parts of the first


def check_teaching(space: ScenarioSpace, seed: int, number: int) -> CheckResult:
    """Check H1: teach a random learning scenario by sentence, read it back, and give commands.

    All is told twice, and shuffled; the graph of beliefs must be the union of the graphs after each
    sentence alone. The number of rules is log-uniform: few and many are equally likely. Number 0 is
    all rules.
    """
    rng = _random(seed, number)
    share = (len(space.cells) * len(LEVELS)) ** (rng.random() - 1)
    codes = space.drawn(rng, share if number else 1.0)
    sizes = (2 ** len(space.objects), len(ACTIONS), len(space.affordances))
    asked = [[int(size * rng.random()) for size in sizes] for _ in range(COMMANDS)]
    once = [sentence(*key) for key in space.taught(codes)]
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        for text in rng.sample(once * 2, len(once) * 2):
            agent.hear(text, only="tell")
        held = _read_back(space, agent.base.rules())
        statements = taught_agent.belief_statements(agent.base)
        choices = [_commanded(space, agent, *each) for each in asked]
    apart = (space.statements[each] for each in ("", *once))
    wrong = [] if held == list(codes) else [f"{codes} is read back as {held}"]
    if statements != frozenset[taught_agent.GraphStatement]().union(*apart):
        wrong.append("the beliefs are not the union of the beliefs from each sentence")
    truth = [[*each, *_definition(space, codes, *each)[:2]] for each in asked]
    wrong += finite_cases.differences(choices, truth)
    return {"codes": codes, "held": held, "told": 2 * len(once), "choices": choices}, wrong


def _random(seed: int, number: int) -> Random:
    return Random(f"{seed}/{number}")  # noqa: S311 - scenarios, not secrets


def _read_back(space: ScenarioSpace, rules: Sequence[Rule]) -> list[int]:
    names = {(number, 1.0): level for level, number in CONFIDENCES.items()}
    levels: dict[RuleKey, list[str]] = {cell: [] for cell in space.cells}
    for rule in rules:
        levels[RuleKey.from_rule(rule)].append(names[rule.interval.lower, rule.interval.upper])
    return [code_of(levels[cell]) for cell in space.cells]


def _commanded(space: ScenarioSpace, agent: Agent, mask: int, action: int, wanted: int) -> Choice:
    text = command([*ACTIONS][action], space.affordances[wanted])
    scene = scene_with(space.scene(mask), seed=0, objects=agent.objects)
    with agent.in_scene(scene) as other:
        decision = other.hear(text, only="do", keep=False).decision
    chosen = (decision.object, decision.part) if decision else (None, None)
    return [mask, action, wanted, *_masks(space, *chosen)]


def _masks(space: ScenarioSpace, found: Inference | None, part: Inference | None) -> Choice:
    names = [each.object for each in taught_agent.acceptable_candidates(found)]
    return [space.mask(names), finite_cases.parts_mask(space, names[0], part) if names else 0]


def check_situations(space: ScenarioSpace, seed: int, number: int, action: int) -> CheckResult:
    """Check H2: one action in all scenes for all affordances, with the cells that were read.

    Only the cells of the objects in the scene and of the parts of the chosen object may be read,
    and only rules of their nodes met. If there is no choice, rules about absent objects are read
    too, to name one that would do. A line of the digest gives the scene, the affordance, the
    acceptable objects, the acceptable parts of the first of them, the cells read, and those whose
    rules were met. Number 0 is the learning scenario of all rules.
    """
    codes = space.drawn(_random(seed, number), 0.5 if number else 1.0)
    lines: list[list[int]] = []
    with space.taught_agent(codes) as taught:
        for mask in range(2 ** len(space.objects)):
            for wanted, affordance in enumerate(space.affordances):
                target = Target(used_for=affordance)
                decided = taught.decide([*ACTIONS][action], target, space.scene(mask))
                sets = map(space.cell_mask, (decided.read, decided.listed))
                lines.append([mask, wanted, *_masks(space, decided.object, decided.part), *sets])
    truth = [[*each[:2], *_definition(space, codes, each[0], action, each[1])] for each in lines]
    facts = {"codes": codes, **tally(line[2] for line in lines), "digest": _digest(lines)}
    return facts, finite_cases.differences(lines, truth)


def _definition(
    space: ScenarioSpace, codes: Codes, mask: int, action: int, affordance: int
) -> list[int]:
    scene = [i for i in range(len(space.objects)) if mask >> i & 1]
    node = space.node(RuleKey("", space.affordances[affordance]))
    tops = finite_cases.highest_codes([codes[node[i]] for i in scene])
    objects = [name for i, name in enumerate(scene) if tops >> i & 1]
    context = [*ACTIONS][action]
    held = [space.objects[i] for i in objects[:1] if context in CONTEXTS]
    grasped = [space.index[RuleKey(o, part, context)] for o in held for part in space.parts[o]]
    read = {*([node[i] for i in scene] if objects else node), *grasped}
    listed = {*node, *(space.node(RuleKey("", "", context)) if held else ())}
    parts = finite_cases.highest_codes([codes[cell] for cell in grasped])
    sets = (bit_mask(cell for cell in each if codes[cell]) for each in (read, listed))
    return [bit_mask(objects), parts, *sets]


def check_growth(space: ScenarioSpace, seed: int, number: int) -> CheckResult:
    """Check H2: teach all rules one by one; after each, the scores of the cells of its node.

    A line of the digest gives lower, upper, lambda and accepted for each of these cells.
    """
    rng = _random(seed, number)
    rules = list(space.rules.items())
    order = sorted(range(len(rules)), key=lambda _: rng.random())
    codes = [0] * len(space.cells)
    lines: list[list[float]] = []
    wrong: list[str] = []
    with TaughtAgent([]) as taught:
        for index in order:
            (cell, level), rule = rules[index]
            taught.base.believe("", "", DEFAULT_SPEAKER, [rule])
            codes[space.index[cell]] |= code_of([level])
            node = space.node(cell)
            scores = [*_node_scores(taught, [space.cells[each] for each in node])]
            right = [[belief(code), 1.0, int(code > 0)] for code in (codes[each] for each in node)]
            wrong += finite_cases.differences([[*each[:2], each[3]] for each in scores], right)
            lines += scores
    return {"order": order, "digest": _digest(lines)}, wrong


def _node_scores(taught: TaughtAgent, node: Sequence[RuleKey]) -> Iterator[list[float]]:
    scene = list(dict.fromkeys(cell.object for cell in node))
    decided: dict[str, taught_agent.TracedDecision] = {}
    for cell in node:
        asked = cell.object if cell.context else cell.argument
        if asked not in decided:
            decided[asked] = finite_cases.decide_about(taught, cell, scene)
        yield finite_cases.score_of(finite_cases.candidate_of(cell, decided[asked]))


def _digest(lines: Sequence[Sequence[float]]) -> str:
    text = "".join(f"{' '.join(map(str, line))}\n" for line in lines)
    return hashlib.sha256(text.encode()).hexdigest()
