# SPDX-License-Identifier: Apache-2.0
"""The hypotheses of the verification, shown by the program instead of assumed.

teaching    a learning scenario told by sentence in order, shuffled, and everything twice and
            shuffled leaves the same rules in the base, and those are the ones that were told; the
            graph of beliefs is the union of what each rule leaves when told alone (H1)
situations  every scene and command under one learning scenario: what is chosen, and of which cells
            anything was read: those of the objects in the scene, and of the chosen one's parts
            (H2). Where nothing can be chosen the program goes on to read what is said about
            absent objects, to name one that would do; that is no choice any more.
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
from ..scenarios import ACTIONS
from .finite_cases import Found, TaughtSpace, best, parts_mask
from .space import CONTEXTS, NUMBERS, Cell, Codes, Space, code_of
from .taught_agent import Decided, Statement, Taught, acceptable, believed


def codes_of(space: Space, seed: int) -> Codes:
    """The learning scenario of a seed; of seed 0 the one in which everything is taught."""
    return space.drawn(seed) if seed else (space.full,) * len(space.cells)


def teaching(lexis: TaughtSpace, seed: int) -> Found:
    """Teach one learning scenario by sentence in three ways, and read back what is believed."""
    space = lexis.space
    codes = codes_of(space, seed)
    rng = Random(seed)  # noqa: S311 - orders, not secrets
    once = space.sentences(codes)
    shuffled = rng.sample(once, len(once))
    doubled = rng.sample(once * 2, len(once) * 2)
    bases = [_told(sentences) for sentences in (once, shuffled, doubled)]
    held = [list(_read_back(space, rules)) for rules, _ in bases]
    wrong = [f"{codes} is held as {each}" for each in held if each != list(codes)]
    if not bases[0] == bases[1] == bases[2]:
        wrong.append("what is believed depends on the order of teaching")
    if bases[0][1] != frozenset[Statement]().union(*(lexis.left_by(each) for each in once)):
        wrong.append("what is believed is not the union of what each rule leaves")
    return {"codes": codes, "held": held, "told": [len(once), len(shuffled), len(doubled)]}, wrong


def _told(sentences: Sequence[str]) -> tuple[frozenset[Rule], frozenset[Statement]]:
    """The rules and the statements that a base holds after hearing sentences."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        for sentence in sentences:
            agent.hear(sentence, only="tell")
        rules = frozenset(replace(r, utterance=None, time=None) for r in agent.base.rules())
        return rules, believed(agent.base)


def _read_back(space: Space, rules: frozenset[Rule]) -> Iterator[int]:
    names = {(number, 1.0): level for level, number in NUMBERS.items()}
    levels: dict[Cell, list[str]] = {cell: [] for cell in space.cells}
    for rule in rules:
        levels[Cell.of(rule)].append(names[rule.interval.lower, rule.interval.upper])
    yield from (code_of(levels[cell]) for cell in space.cells)


def situations(lexis: TaughtSpace, seed: int, action: int) -> Found:
    """One action in all scenes for all affordances, with what was read for each decision.

    A line of what is digested names the scene, the affordance, the acceptable objects, the
    acceptable parts of the first of them, and the cells that were read.
    """
    space = lexis.space
    codes = codes_of(space, seed)
    with lexis.taught(codes) as taught:
        lines = list(_lines(lexis, taught, list(ACTIONS)[action]))
    truth = [_truth(space, codes, list(ACTIONS)[action], *line[:2]) for line in lines]
    wrong = [f"{one}, not {other}" for one, other in zip(lines, truth, strict=True) if one != other]
    text = "".join(f"{' '.join(map(str, line))}\n" for line in lines)
    counts = [sum(min(line[2].bit_count(), 2) == n for line in lines) for n in range(3)]
    facts = {"codes": codes, "none": counts[0], "unique": counts[1], "ties": counts[2]}
    return {**facts, "digest": hashlib.sha256(text.encode()).hexdigest()}, wrong


Line = tuple[int, int, int, int, int]  # scene, affordance, objects, parts, cells read


def _lines(lexis: TaughtSpace, taught: Taught, action: str) -> Iterator[Line]:
    space = lexis.space
    for mask in range(2 ** len(space.objects)):
        for number, affordance in enumerate(space.affordances):
            decided = taught.decide(action, Target(used_for=affordance), space.scene(mask))
            yield mask, number, *_outcome(lexis, decided)


def _outcome(lexis: TaughtSpace, decided: Decided) -> tuple[int, int, int]:
    space = lexis.space
    names = [each.object for each in acceptable(decided.object)]
    parts = parts_mask(space, names[0], decided) if names else 0
    return space.mask(names), parts, lexis.bits(decided.read)


def _truth(space: Space, codes: Codes, action: str, mask: int, affordance: int) -> Line:
    """What the definition says: by the codes alone, not by the inference."""
    scene = [i for i in range(len(space.objects)) if mask >> i & 1]
    cells = [i * len(space.affordances) + affordance for i in scene]
    tops = best([codes[cell] for cell in cells])
    objects = [name for i, name in enumerate(scene) if tops >> i & 1]
    grasped = _part_cells(space, action, objects[0]) if objects else []
    parts = best([codes[cell] for cell in grasped])
    step = len(space.affordances)
    everywhere = range(affordance, len(space.objects) * step, step)
    read = sum(1 << cell for cell in (*(cells if objects else everywhere), *grasped) if codes[cell])
    return mask, affordance, sum(1 << i for i in objects), parts, read


def _part_cells(space: Space, action: str, number: int) -> list[int]:
    """The cells of an object's parts under an action; none where it does not grasp."""
    name = space.objects[number]
    contexts = [context for context in CONTEXTS if context == action]
    return [space.index[Cell(name, part, c)] for c in contexts for part in space.parts[name]]
