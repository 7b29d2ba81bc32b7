# SPDX-License-Identifier: Apache-2.0
"""All 3840 · 2^288 pairs of a problem situation and a learning scenario, verified by factorisation.

The paper calls them infeasible to test (section 4.1). They factor: if (H1) a base depends on the
set of rules it was taught alone, (H2) the score of a cell on that cell alone, and (H3) a choice on
how scores compare alone, then the program is right everywhere as soon as it is right on

    words       288 sentences, 15 commands, 256 scenes
    scores      72 · 16 scores of a cell at a code
    choices     every weak order of the objects of every scene
    grasps      8 · 2 · 16² choices between the parts of an object

2,189,146 cases, which are enumerated with the program's own code. The hypotheses are not assumed:
teaching shows H1 (shuffled, doubled, read back), the traces of scores and of whole decisions
(situations) show H2, and choices are made among scores that can only be compared (H3). Every result
carries what the program did; `certificate` puts them into one file that others can check.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, cast

from ....inference.evidence import EPSILON
from ....inference.settings import Settings
from ...execution.outcome import Json
from ..case import Case, Result
from ..experiment import Experiment
from ..scenarios import ACTIONS
from ..verification import finite_cases, hypotheses
from ..verification.certificate import certificate, totals
from ..verification.finite_cases import Found, TaughtSpace
from ..verification.space import Space
from ..verification.weak_orders import OrderShape, blocks


@dataclass(frozen=True)
class AllScenarios(Experiment):
    """The verification of all learning scenarios.

    Attributes:
        seed: of the learning scenarios that are taught to show the hypotheses.
        objects: how many of the paper's objects; fewer for a quick look.
        affordances: how many of its affordances.
        taught: how many learning scenarios are taught by sentence, in three orders each.
        traced: of how many all situations are traced.
    """

    name: ClassVar[str] = "all-scenarios"
    objects: int = 8
    affordances: int = 5
    taught: int = 9
    traced: int = 3

    def cases(self) -> Sequence[Case]:
        """The finite cases, in blocks, and the checks of the hypotheses."""
        codes = range(self._space.full + 1)
        actions = range(len(ACTIONS))
        found: list[tuple[str, tuple[int, ...]]] = [
            ("words", ()),
            *(("scores", (shift,)) for shift in codes),
            *(("grasps", (code,)) for code in codes),
            *(("teaching", (number,)) for number in range(self.taught)),
            *(("situations", (n, action)) for n in range(self.traced) for action in actions),
            *(("choices", (block.ranked, block.levels)) for block in blocks(self.objects)),
        ]
        return [
            Case(self.name, "/".join([what, *map(str, numbers)]), {what: list(numbers)})
            for what, numbers in found
        ]

    def run(self, case: Case) -> Result:
        """Run one block by the program's own code."""
        facts, wrong = self._run(case.spec)
        found = f"{len(wrong)} wrong" + (f", the first: {wrong[0]}" if wrong else "")
        return Result(case.key, not wrong, "check", 0, found, "0 wrong", facts)

    def summary(self, results: Sequence[Result]) -> Json:
        """How many cases there were, and how many learning scenarios they stand for."""
        return totals(self._space, self._facts(results))

    def files(self, results: Sequence[Result]) -> Mapping[str, Json]:
        """The certificate."""
        pinned: Json = {
            "seed": self.seed,
            "threshold": Settings.load().threshold,
            "tolerance": EPSILON,
        }
        return {"certificate.json": certificate(self._space, self._facts(results), pinned)}

    @cached_property
    def _space(self) -> Space:
        return Space.of_paper(self.objects, self.affordances)

    @cached_property
    def _lexis(self) -> TaughtSpace:
        return TaughtSpace(self._space)

    def _run(self, spec: Json) -> Found:
        ((what, numbers),) = spec.items()
        first, second = [*cast("list[int]", numbers), 0, 0][:2]
        match what:
            case "words":
                return finite_cases.words(self._lexis)
            case "scores":
                return finite_cases.scores(self._lexis, first)
            case "grasps":
                return finite_cases.grasps(self._lexis, first)
            case "teaching":
                return hypotheses.teaching(self._lexis, self.seed + first)
            case "situations":
                return hypotheses.situations(self._lexis, self.seed + first, second)
            case _:
                return OrderShape(self.objects, first, second).chosen()

    @staticmethod
    def _facts(results: Sequence[Result]) -> dict[str, list[Json]]:
        """What was found out, by what it is about, in the order of the cases."""
        found: dict[str, list[Json]] = {}
        for result in results:
            if result.kind == "check":  # not an error: then the certificate is not whole
                found.setdefault(result.key.partition("/")[0], []).append(result.facts)
        return found
