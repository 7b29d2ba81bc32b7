"""Verification of all 3840 · 2^288 pairs of problem situation and learning scenario.

The paper calls them infeasible to test (section 4.1). Under the hypotheses of docs/verification.md
they factorise into 2,189,146 cases, which are run with the code under test: `words`, `scores` of a
cell at a code, `choices` from every weak order of every scene, `grasps` by two parts. The other
checks test the hypotheses. The certificate contains all results in one file that others can check:
`examples/check_certificate.py` computes it again from the definition, without Hilt.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import comb
from typing import ClassVar

from ....inference.interval_operators import EPSILON
from ....inference.settings import Settings
from ....kb.rdf.record_mapping import group_pairs
from ..experiment import Case, CaseResult, Experiment, Json
from ..learning_scenarios import ACTIONS, CONTEXTS, LEVELS
from ..verification import checks
from ..verification.scenario_space import CODES, CheckResult, ScenarioSpace
from ..verification.weak_orders import OUTCOMES, check_choices, weak_order_blocks

FORMAT = 2  # of the certificate
CHECKS: Mapping[str, Callable[..., CheckResult]] = {
    "words": checks.check_words,
    "scores": checks.check_scores,
    "grasps": checks.check_grasps,
    "teaching": checks.check_teaching,
    "situations": checks.check_situations,
    "growth": checks.check_growth,
    "choices": check_choices,
}
DRAWN = ("teaching", "situations", "growth")  # from the seed


@dataclass(frozen=True)
class AllScenariosExperiment(Experiment):
    """The verification of all learning scenarios; what tests the hypotheses depends on the seed."""

    name: ClassVar[str] = "all-scenarios"
    objects: int = 8  # of the paper; fewer for a quick run
    affordances: int = 5  # of the paper
    taught: int = 50  # random learning scenarios that are taught by sentence
    traced: int = 3  # learning scenarios of which all situations are traced
    grown: int = 8  # random orders in which all rules are taught one by one

    def cases(self) -> Sequence[Case]:
        """Return the finite cases, in blocks, and the tests of the hypotheses."""
        actions = range(len(ACTIONS))
        return [
            self._case("words"),
            *(self._case("scores", shift) for shift in CODES),
            *(self._case("grasps", code) for code in CODES),
            *(self._case("teaching", number) for number in range(self.taught)),
            *(self._case("situations", n, to) for n in range(self.traced) for to in actions),
            *(self._case("growth", number) for number in range(self.grown)),
            *(self._case("choices", b.ranked, b.levels) for b in weak_order_blocks(self.objects)),
        ]

    def _case(self, what: str, *numbers: int) -> Case:
        return Case(self.name, "/".join([what, *map(str, numbers)]), {what: list(numbers)})

    def run(self, case: Case) -> CaseResult:
        """Run one block with the code under test."""
        ((what, numbers),) = case.spec.items()
        seed = (self.seed,) if what in DRAWN else ()
        facts, wrong = CHECKS[what](self._space, *seed, *numbers)
        found = f"{len(wrong)} wrong" + (f", the first: {wrong[0]}" if wrong else "")
        return CaseResult(case.key, not wrong, "check", 0, found, "0 wrong", facts)

    def summary(self, results: Sequence[CaseResult]) -> Json:
        """Return the numbers of cases, and of rule states over the whole space by outcome.

        A rule state is a way to teach the cells of one affordance, with a scene; its outcome is
        that there is no right choice, a unique one, or ties.
        """
        space, choices, codes = self._space, self._facts(results)["choices"], len(CODES)
        scenes, rules = 2 ** len(space.objects), len(space.cells) * len(LEVELS)
        counted = {
            "words": rules + len(space.commands()) + scenes,
            "scores": len(space.cells) * codes,
            "choices": sum(block[outcome] for block in choices for outcome in OUTCOMES),
            "grasps": len(space.objects) * len(CONTEXTS) * codes**2,
        }
        return {
            "cases": counted | {"all": sum(counted.values())},
            "situations": scenes * len(space.commands()),
            "rules": rules,
            "rule_states": {  # m levels can be any m non-zero codes
                outcome: sum(block[outcome] * comb(codes - 1, block["levels"]) for block in choices)
                for outcome in OUTCOMES
            },
        }

    def files(self, results: Sequence[CaseResult]) -> Mapping[str, Json]:
        """Return the certificate, with the settings that were used."""
        space, facts = self._space, self._facts(results)
        certificate: Json = {
            "format": FORMAT,
            "objects": space.objects,
            "affordances": space.affordances,
            "parts": space.parts,
            "contexts": CONTEXTS,
            "actions": list(ACTIONS),
            "levels": LEVELS,
            "seed": self.seed,
            "threshold": Settings.load().threshold,
            "tolerance": EPSILON,
            **(facts["words"][0] if facts["words"] else {}),
            **{name: [each["rows"] for each in facts[name]] for name in ("scores", "grasps")},
            **{name: facts[name] for name in ("choices", *DRAWN)},
        }
        return {"certificate.json": certificate}

    @cached_property
    def _space(self) -> ScenarioSpace:
        return ScenarioSpace.from_paper(self.objects, self.affordances)

    @staticmethod
    def _facts(results: Sequence[CaseResult]) -> dict[str, list[Json]]:
        # Errors are left out: then the certificate is incomplete.
        checked = (result for result in results if result.kind == "check")
        return group_pairs((result.key.partition("/")[0], result.facts) for result in checked)


@dataclass(frozen=True)
class RandomScenariosExperiment(AllScenariosExperiment):
    """Random learning scenarios alone, each taught by sentence and tested by random commands."""

    name: ClassVar[str] = "random"
    scenarios: int = 2000

    def cases(self) -> Sequence[Case]:
        """Return a case for each scenario; number 0 would teach everything."""
        return [self._case("teaching", number + 1) for number in range(self.scenarios)]

    def summary(self, results: Sequence[CaseResult]) -> Json:
        """Return the numbers of sentences and of decisions."""
        facts = self._facts(results)["teaching"]
        told = sum(each["told"] for each in facts)
        return {"sentences": told, "decisions": checks.COMMANDS * len(facts)}

    def files(self, results: Sequence[CaseResult]) -> Mapping[str, Json]:
        """Return no certificate: `AllScenariosExperiment` makes it."""
        return {}
