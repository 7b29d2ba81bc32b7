# SPDX-License-Identifier: Apache-2.0
"""Verification of all 3840 · 2^288 pairs of problem situation and learning scenario.

The paper calls them infeasible to test (section 4.1). They factorise: if (H1) the beliefs depend on
the set of rules taught alone, (H2) the score of a cell on that cell alone, and (H3) a choice on the
order of the scores alone, then the program is right everywhere if it is right on

    words       288 sentences, 15 commands, 256 scenes
    scores      72 · 16 scores of a cell at a code
    choices     every weak order of the objects of every scene
    grasps      8 · 2 · 16² choices between the parts of an object

2,189,146 cases, which are run with the code under test. The hypotheses are tested too: teaching
tests H1 (shuffled, doubled, read back), the traces of scores and of whole decisions (situations)
test H2, and choices are made among scores that can only be compared (H3). The certificate contains
all results in one file that others can check.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, cast

from ....inference.interval_operators import EPSILON
from ....inference.settings import Settings
from ...execution.outcome import Json
from ..case import Case, CaseResult
from ..experiment import Experiment
from ..learning_scenarios import ACTIONS
from ..verification.certificate import count_totals, make_certificate
from ..verification.finite_cases import (
    CheckResult,
    VerbalizedSpace,
    check_grasps,
    check_scores,
    check_words,
)
from ..verification.hypotheses import check_situations, check_teaching
from ..verification.scenario_space import ScenarioSpace
from ..verification.weak_orders import WeakOrderClass, weak_order_blocks


@dataclass(frozen=True)
class AllScenariosExperiment(Experiment):
    """The verification of all learning scenarios.

    Attributes:
        seed: the seed of the learning scenarios that test the hypotheses.
        objects: number of objects of the paper; fewer for a quick run.
        affordances: number of its affordances.
        taught: number of learning scenarios taught by sentence, in three orders each.
        traced: number of learning scenarios of which all situations are traced.
    """

    name: ClassVar[str] = "all-scenarios"
    objects: int = 8
    affordances: int = 5
    taught: int = 9
    traced: int = 3

    def cases(self) -> Sequence[Case]:
        """Return the finite cases, in blocks, and the tests of the hypotheses."""
        codes = range(self._space.full + 1)
        actions = range(len(ACTIONS))
        found: list[tuple[str, tuple[int, ...]]] = [
            ("words", ()),
            *(("scores", (shift,)) for shift in codes),
            *(("grasps", (code,)) for code in codes),
            *(("teaching", (number,)) for number in range(self.taught)),
            *(("situations", (n, action)) for n in range(self.traced) for action in actions),
            *(("choices", (each.ranked, each.levels)) for each in weak_order_blocks(self.objects)),
        ]
        return [
            Case(self.name, "/".join([what, *map(str, numbers)]), {what: list(numbers)})
            for what, numbers in found
        ]

    def run(self, case: Case) -> CaseResult:
        """Run one block with the code under test."""
        facts, wrong = self._run(case.spec)
        found = f"{len(wrong)} wrong" + (f", the first: {wrong[0]}" if wrong else "")
        return CaseResult(case.key, not wrong, "check", 0, found, "0 wrong", facts)

    def summary(self, results: Sequence[CaseResult]) -> Json:
        """Return the numbers of cases, and of the situations and rules they cover."""
        return count_totals(self._space, self._facts(results))

    def files(self, results: Sequence[CaseResult]) -> Mapping[str, Json]:
        """Return the certificate."""
        threshold = Settings.load().threshold
        pinned: Json = {"seed": self.seed, "threshold": threshold, "tolerance": EPSILON}
        return {"certificate.json": make_certificate(self._space, self._facts(results), pinned)}

    @cached_property
    def _space(self) -> ScenarioSpace:
        return ScenarioSpace.from_paper(self.objects, self.affordances)

    @cached_property
    def _taught_space(self) -> VerbalizedSpace:
        return VerbalizedSpace(self._space)

    def _run(self, spec: Json) -> CheckResult:
        ((what, numbers),) = spec.items()
        first, second = [*cast("list[int]", numbers), 0, 0][:2]
        match what:
            case "words":
                return check_words(self._taught_space)
            case "scores":
                return check_scores(self._taught_space, first)
            case "grasps":
                return check_grasps(self._taught_space, first)
            case "teaching":
                return check_teaching(self._taught_space, self.seed + first)
            case "situations":
                return check_situations(self._taught_space, self.seed + first, second)
            case _:
                return WeakOrderClass(self.objects, first, second).verify()

    @staticmethod
    def _facts(results: Sequence[CaseResult]) -> dict[str, list[Json]]:
        """Return kind of cases -> their facts, in the order of the cases."""
        found: dict[str, list[Json]] = defaultdict(list)
        for result in results:
            if result.kind == "check":  # errors are left out: then the certificate is incomplete
                found[result.key.partition("/")[0]].append(result.facts)
        return found
