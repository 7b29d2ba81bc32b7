# SPDX-License-Identifier: Apache-2.0
"""Speed of inference, with ProbLog beside it where it is installed.

    pytest benchmarks/test_inference_speed.py --benchmark-only

The figures to reach: getFeatures and getAffordance at a node with the paper's 32 rules, p50 at most
0.25 ms in memory and 0.5 ms on disk, at least 20 times as fast as ProbLog on the same rules; five
million vectorised rule applications a second on one core.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hilt.agent.agent import Agent
from hilt.agent.evaluation.scenarios import load_scenarios
from hilt.inference import Affordances, Goal, Observation, Target, vectorised
from hilt.kb.interval import Interval
from hilt.kb.rule import Atom

NODE = "pass/findObject"
CUTTING = Goal("pass", Target(used_for="cutting"))
SCENE = ("knife", "spatula", "spoon", "shoe", "hammer", "glass", "mug", "screwdriver")
SURE = 0.95
APPLICATIONS = 5_000_000


@pytest.fixture(params=["memory", "disk"])
def affordances(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Affordances]:
    """Inference over the 32 rules of Scenario A."""
    location = "memory:" if request.param == "memory" else str(tmp_path / "kb")
    with Agent.open(location, simulate=False) as agent:
        for sentence in load_scenarios()[0].sentences():
            agent.hear(sentence)
        yield agent.affordances


def decide(affordances: Affordances) -> str:
    """One getFeatures, one perfect search, one getAffordance."""
    features = affordances.features(NODE, CUTTING)
    seen = [
        Observation(name, name, {Atom("object", name): Interval(SURE, 1.0)})
        for name in SCENE
        if Atom("object", name) in features
    ]
    best = affordances.infer(NODE, CUTTING, seen).best
    return best.name if best else ""


def test_one_node_with_the_papers_rules(benchmark: Any, affordances: Affordances):
    """GetFeatures and getAffordance, rules already assimilated."""
    assert benchmark(decide, affordances) == "knife"


def test_one_node_right_after_something_was_told(benchmark: Any, affordances: Affordances):
    """The same when the rules of the node must be read from the store again."""

    def forget() -> None:
        affordances._sequence = -1

    def cold() -> str:
        forget()
        return decide(affordances)

    assert benchmark(cold) == "knife"


def problog_decision() -> Callable[[], str]:
    """The same decision by ProbLog: rules as probabilistic clauses, detection as a fact."""
    problog = pytest.importorskip("problog")
    from problog.program import PrologString

    levels = {"generally": 0.95, "often": 0.75, "sometimes": 0.5, "occasionally": 0.25}
    clauses = [
        f"{levels[level]}::used_for({name}, {affordance}) :- seen({name})."
        for affordance, columns in load_scenarios()[0].affordances.items()
        for level, names in columns.items()
        for name in names
    ]
    facts = [f"{SURE}::seen({name})." for name in SCENE]
    model = "\n".join([*clauses, *facts, "query(used_for(_, cutting))."])

    def decide_by_problog() -> str:
        found = problog.get_evaluatable().create_from(PrologString(model)).evaluate()
        return str(max(found, key=lambda term: found[term]).args[0])

    return decide_by_problog


def test_problog_on_the_same_rules(benchmark: Any):
    """The peer, for the ratio."""
    assert benchmark(problog_decision()) == "knife"


def test_vectorised_rule_applications(benchmark: Any):
    """AND of two antecedents, modus ponens, and fusion of pairs, for five million rules."""
    rng = np.random.default_rng(7)
    rules = np.sort(rng.random((APPLICATIONS, 2)), axis=-1)
    premises = np.sort(rng.random((APPLICATIONS, 2, 2)), axis=-1)
    starts = np.arange(0, APPLICATIONS, 2)

    def apply() -> np.ndarray:
        concluded = vectorised.modus_ponens(vectorised.conjunction(premises), rules)
        return vectorised.fuse_yager(concluded, starts)

    fused = benchmark.pedantic(apply, rounds=3)

    assert fused.shape == (len(starts), 2)
