"""The checks of the verification: its finite cases, and the tests of its hypotheses.

docs/verification.md states the hypotheses. Each check runs the code under test, and returns its
results as plain JSON, and a line for each deviation from the definition. Cells, objects, parts,
actions and levels are given by their indices; sets of objects and of cells as bit masks.
"""

import hashlib
from collections.abc import Sequence
from random import Random

from ....inference.interval_operators import Operators
from ....inference.types import Candidate, Inference, Target
from ....kb.interval import VACUOUS
from ....kb.rule import DEFAULT_SPEAKER, Rule
from ....nlu.semantics import meaning
from ....sim.scene.scene import Placement, Scene, scene_with
from ...agent import Agent
from ...config import AgentConfig, household
from ...dialogue.translation import request_from_command
from ...execution.perception import PerfectVision
from ..learning_scenarios import ACTIONS, CONTEXTS, LEVELS, command, rule_sentence
from . import taught_agent
from .scenario_space import BITS, CODES, CONFIDENCES, CheckResult, ScenarioSpace, belief, bit_mask
from .taught_agent import RuleKey, TaughtAgent, TracedDecision, acceptable_candidates
from .weak_orders import tally

DIGITS = 9  # precision of written scores; exact for the levels of the paper
FINDING = "pointTo"  # the action that only finds an object
COMMANDS = 5  # given in each random learning scenario
Choice = list[int]  # scene, action, affordance, acceptable objects, acceptable parts of the first


# --- Finite cases --------------------------------------------------------------------------


def check_words(space: ScenarioSpace) -> CheckResult:
    """Check the rules of all sentences, the goals of all commands, and perception of all scenes."""
    taught: list[list[object]] = []
    wanted: list[list[object]] = []
    for (cell, level), rule in space.rules.items():
        text, found = rule_sentence(*cell, level), RuleKey.from_rule(rule)
        taught.append([text, space.index[found], *rule.interval])
        wanted.append([text, space.index[cell], CONFIDENCES[level], 1.0])
    commands = [list(each) for each in space.commands()]
    asked = [_command(space, str(text)) for text, *_ in commands]
    seen: list[int] = []
    for mask in range(2 ** len(space.objects)):
        things = tuple(Placement(name, name) for name in space.scene(mask))
        vision = PerfectVision(Scene(things, seed=0), household().objects)
        percepts = vision.search([f"object:{name}" for name in space.objects])
        seen.append(space.mask(each.object for each in percepts if each.confidence == 1.0))
    pairs = ((taught, wanted), (asked, commands), (seen, range(len(seen))))
    wrong = [line for found, right in pairs for line in _differences(found, right)]
    return {"sentences": taught, "commands": asked, "scenes": seen}, wrong


def _command(space: ScenarioSpace, text: str) -> list[str | int]:
    if not isinstance(said := space.language.understand(text).meaning, meaning.Command):
        return [text, -1, -1]
    request = request_from_command(said, DEFAULT_SPEAKER)
    wanted = getattr(request.arguments["object"], "used_for", None)
    number = space.affordances.index(wanted) if wanted in space.affordances else -1
    return [text, [*ACTIONS].index(request.action), number]


def _differences(found: Sequence[object], wanted: Sequence[object]) -> list[str]:
    return [f"{one}, not {other}" for one, other in zip(found, wanted, strict=True) if one != other]


def check_scores(space: ScenarioSpace, shift: int) -> CheckResult:
    """Check the score of each cell at one code, among cells of other codes.

    A row is lower, upper, lambda, accepted, then the cells of the proof, those that were read, and
    those whose rules were met. Each score must be the same, to the last bit, with all objects in
    the scene and if only its own cell was taught; its proof must evaluate to its interval.
    """
    # The 16 shifts together give each cell each code once, always among other codes.
    codes = [(shift + i) % len(CODES) for i in range(len(space.cells))]
    rows: list[list[float]] = []
    wrong: list[str] = []
    with space.taught_agent(codes) as taught:
        for cell, code in zip(space.cells, codes, strict=True):
            decided = _decide_about(taught, cell, [cell.object])
            found = _candidate_of(cell, decided)
            full = _candidate_of(cell, _decide_about(taught, cell, space.objects))
            with space.taught_agent([code if each == cell else 0 for each in space.cells]) as other:
                alone = _candidate_of(cell, _decide_about(other, cell, [cell.object]))
            proven = map(RuleKey.from_rule, found.rules if found else ())
            sets = (proven, decided.read, decided.listed)
            rows.append([*_score_of(found), *map(space.cell_mask, sets)])
            intervals = {each.interval if each else VACUOUS for each in (found, full, alone)}
            is_proven = not found or found.proof.evaluate(Operators()) == found.interval
            if len(intervals) > 1 or rows[-1][0] != belief(code) or not is_proven:
                wrong.append(f"{cell} at code {code} has {rows[-1]}")
    return {"rows": rows}, wrong


def _score_of(candidate: Candidate | None) -> list[float]:
    if candidate is None:
        return [0.0, 1.0, 0.0, 0]
    numbers = (round(n, DIGITS) for n in (*candidate.interval, candidate.certainty))
    return [*numbers, int(candidate.accepted)]


def _decide_about(taught: TaughtAgent, cell: RuleKey, scene: Sequence[str]) -> TracedDecision:
    if cell.context:
        return taught.decide(cell.context, Target(object=cell.object), scene)
    return taught.decide(FINDING, Target(used_for=cell.argument), scene)


def _candidate_of(cell: RuleKey, decided: TracedDecision) -> Candidate | None:
    inference = decided.part if cell.context else decided.object
    for each in inference.candidates if inference else ():
        if each.object == cell.object and each.argument and each.argument.name == cell.argument:
            return each if each.rules else None
    return None


def check_grasps(space: ScenarioSpace, first: int) -> CheckResult:
    """Check the choice between the parts of each object, one at code `first`, the other at any.

    A row contains the bit mask of the acceptable parts for each object and context.
    """
    firsts = {(name, space.parts[name][0]) for name in space.objects}
    rows: list[list[int]] = []
    for second in CODES:
        codes = [
            (first if (cell.object, cell.argument) in firsts else second) if cell.context else 0
            for cell in space.cells
        ]
        asked = ((name, context) for name in space.objects for context in CONTEXTS)
        with space.taught_agent(codes) as taught:
            chosen = ((o, taught.decide(to, Target(object=o), [o]).part) for o, to in asked)
            rows.append([_parts_mask(space, *each) for each in chosen])
    wrong = [
        f"codes {first} and {second} give {mask}"
        for second, row in enumerate(rows)
        for mask in row
        if mask != _highest_codes([first, second])
    ]
    return {"rows": rows}, wrong


def _parts_mask(space: ScenarioSpace, name: str, found: Inference | None) -> int:
    chosen = (each.argument.name for each in acceptable_candidates(found) if each.argument)
    return bit_mask(map(space.parts[name].index, chosen))


def _highest_codes(codes: Sequence[int]) -> int:
    highest = max(codes, default=0)  # a higher code means a higher belief
    return bit_mask(i for i, code in enumerate(codes) if code == highest and highest)


# --- Hypotheses ----------------------------------------------------------------------------


def check_teaching(space: ScenarioSpace, seed: int, number: int) -> CheckResult:
    """Check H1: teach a random learning scenario by sentence, read it back, and give commands.

    All is told twice, and shuffled; the graph of beliefs must be the union of the graphs after each
    sentence alone. The number of rules is log-uniform; number 0 has all rules.
    """
    rng = _random(seed, number)
    share = (len(space.cells) * len(LEVELS)) ** (rng.random() - 1)
    codes = space.drawn(rng, share if number else 1.0)
    sizes = (2 ** len(space.objects), len(ACTIONS), len(space.affordances))
    asked = [[int(size * rng.random()) for size in sizes] for _ in range(COMMANDS)]
    once = [rule_sentence(*cell, level) for cell, level in space.taught(codes)]
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        for text in rng.sample(once * 2, len(once) * 2):
            agent.hear(text, only="tell")
        held = _read_back(space, agent.base.rules())
        statements = taught_agent.belief_graph(agent.base)
        choices = [_commanded(space, agent, *each) for each in asked]
    alone = (taught_agent.graph_after(space.rules[key]) for key in space.taught(codes))
    apart = taught_agent.graph_after().union(*alone)
    wrong = [] if held == list(codes) else [f"{codes} is read back as {held}"]
    if statements != apart:
        wrong.append("the beliefs are not the union of the beliefs from each sentence")
    truth = [[*each, *_definition(space, codes, *each)[:2]] for each in asked]
    wrong += _differences(choices, truth)
    return {"codes": codes, "held": held, "told": 2 * len(once), "choices": choices}, wrong


def _random(seed: int, number: int) -> Random:
    return Random(f"{seed}/{number}")  # noqa: S311 - scenarios, not secrets


def _read_back(space: ScenarioSpace, rules: Sequence[Rule]) -> list[int]:
    bits = {(CONFIDENCES[level], 1.0): bit for level, bit in BITS.items()}
    codes = dict.fromkeys(space.cells, 0)
    for rule in rules:
        codes[RuleKey.from_rule(rule)] |= bits[rule.interval.lower, rule.interval.upper]
    return [*codes.values()]


def _commanded(space: ScenarioSpace, agent: Agent, mask: int, action: int, wanted: int) -> Choice:
    text = command([*ACTIONS][action], space.affordances[wanted])
    with agent.in_scene(scene_with(space.scene(mask), seed=0, objects=agent.objects)) as other:
        decision = other.hear(text, only="do", keep=False).decision
    chosen = (decision.object, decision.part) if decision else (None, None)
    return [mask, action, wanted, *_masks(space, *chosen)]


def _masks(space: ScenarioSpace, found: Inference | None, part: Inference | None) -> Choice:
    names = [each.object for each in acceptable_candidates(found)]
    return [space.mask(names), _parts_mask(space, names[0], part) if names else 0]


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
    return facts, _differences(lines, truth)


def _definition(
    space: ScenarioSpace, codes: Sequence[int], mask: int, action: int, affordance: int
) -> list[int]:
    scene = [i for i in range(len(space.objects)) if mask >> i & 1]
    node = space.node(RuleKey("", space.affordances[affordance]))
    tops = _highest_codes([codes[node[i]] for i in scene])
    objects = [name for i, name in enumerate(scene) if tops >> i & 1]
    context = [*ACTIONS][action]
    held = [space.objects[i] for i in objects[:1] if context in CONTEXTS]
    grasped = [space.index[RuleKey(o, part, context)] for o in held for part in space.parts[o]]
    read = {*([node[i] for i in scene] if objects else node), *grasped}
    listed = {*node, *(space.node(RuleKey("", "", context)) if held else ())}
    sets = (bit_mask(cell for cell in each if codes[cell]) for each in (read, listed))
    return [bit_mask(objects), _highest_codes([codes[cell] for cell in grasped]), *sets]


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
            codes[space.index[cell]] |= BITS[level]
            node = space.node(cell)
            scene = list(dict.fromkeys(space.cells[each].object for each in node))
            decided: dict[str, TracedDecision] = {}
            scores: list[list[float]] = []
            for each in map(space.cells.__getitem__, node):
                asked = each.object if each.context else each.argument
                if asked not in decided:
                    decided[asked] = _decide_about(taught, each, scene)
                scores.append(_score_of(_candidate_of(each, decided[asked])))
            right = [[belief(code), 1.0, int(code > 0)] for code in (codes[each] for each in node)]
            wrong += _differences([[*each[:2], each[3]] for each in scores], right)
            lines += scores
    return {"order": order, "digest": _digest(lines)}, wrong


def _digest(lines: Sequence[Sequence[float]]) -> str:
    text = "".join(f"{' '.join(map(str, line))}\n" for line in lines)
    return hashlib.sha256(text.encode()).hexdigest()
