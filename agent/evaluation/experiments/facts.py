"""People's own data: a table of what objects are used for, taught by sentence and decided upon.

The file has tab-separated columns with the names `object`, `use` (a gerund) and `share` in [0, 1]:
the share of people, texts or occasions that agree. Each row is said with the word of confidence
that is nearest to its share. A row is right if exactly what was said is stored. Then decisions in
random scenes are compared with the file.
"""

import csv
import io
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from random import Random
from typing import ClassVar

from ....kb.rule import Rule
from ....ontology.errors import DataError, HiltError
from ....ontology.objects import ObjectType
from ....ontology.yaml_reader import read_text
from ....sim.scene.scene import Scene, scene_with
from ...agent import Agent
from ...config import actions_with, household, load_language, open_base
from ...execution.embodiment import Embodiment
from ..experiment import Case, CaseResult, Experiment, Json
from ..learning_scenarios import command, rule_sentence
from .ground_truth import CorrectChoices

COLUMNS = ("object", "use", "share")
WORDS = {"generally": 0.95, "often": 0.75, "sometimes": 0.5, "occasionally": 0.25, "never": 0.0}


@dataclass(frozen=True)
class Fact:
    """A row of the file: an object, a use, and the share in [0, 1] that agrees."""

    object: str
    use: str
    share: float

    @property
    def word(self) -> str:
        """The word of confidence that is nearest to the share; the surer one of two."""
        return min(WORDS, key=lambda word: abs(WORDS[word] - self.share))

    @property
    def sentence(self) -> str:
        """The sentence that states it."""
        return rule_sentence(self.object, self.use, level=self.word)

    def is_stated_by(self, rule: Rule) -> bool:
        """Whether a rule says the same."""
        bound = rule.interval.lower if self.word != "never" else 1 - rule.interval.upper
        wanted = WORDS[self.word] if self.word != "never" else WORDS["generally"]
        # The object of a use is stored in the singular: "opening bottles".
        used = f"{rule.affordance} {rule.material or ''}".strip()
        is_same = self.use in {used, f"{used}s"} and rule.object == self.object
        return is_same and abs(bound - wanted) < 1e-6 and len(rule.features) == 1


def read_facts(path: Path) -> list[Fact]:
    """Return the rows of a file; a DataError gives the line that is wrong."""
    facts: list[Fact] = []
    rows = csv.DictReader(io.StringIO(read_text(path)), delimiter="\t")
    for line, row in enumerate(rows, start=2):
        name, use, share = ((row.get(column) or "").strip() for column in COLUMNS)
        try:
            number = float(share)
        except ValueError:
            number = -1.0
        if not name or not use or not 0 <= number <= 1:
            found = list(row.values())
            problem = f"expected {', '.join(COLUMNS)}, the last one in [0, 1], found {found}."
            raise DataError(problem, source=str(path), line=line)
        facts.append(Fact(name, use, number))
    return facts


@dataclass(frozen=True)
class FactsExperiment(Experiment):
    """The facts of a file, and decisions about its uses in random scenes of its objects."""

    name: ClassVar[str] = "facts"
    file: str = ""
    scenes: int = 100

    def cases(self) -> Sequence[Case]:
        """Return a case for each row, then one for each scene, with a use drawn from the file."""
        rng = Random(self.seed)  # noqa: S311 - scenes, not secrets
        uses, objects = self._names("use"), self._names("object")
        rows = [Case(self.name, f"fact/{n}", {"row": n}) for n in range(len(self._facts))]
        for number in range(self.scenes):
            scene = rng.sample(objects, rng.randint(1, min(8, len(objects))))
            spec: Json = {"scene": scene, "use": rng.choice(uses)}
            rows.append(Case(self.name, f"scene/{number}", spec))
        return rows

    def run(self, case: Case) -> CaseResult:
        """Compare what was stored, or what is chosen, with the file."""
        if "row" in case.spec:
            fact, (rules, said) = self._facts[case.spec["row"]], self._taught[1][case.spec["row"]]
            is_same = len(rules) == 1 and fact.is_stated_by(rules[0])
            found = "as said" if is_same else "otherwise" if rules else "refused"
            facts: Json = {"why": [fact.sentence, said, *map(repr, rules)]}
            return CaseResult(case.key, is_same, "check", 0, found, "as said", facts)
        scene, use = case.spec["scene"], case.spec["use"]
        about = (fact for fact in self._facts if fact.use == use and fact.object in scene)
        shares = {fact.object: WORDS[fact.word] for fact in about}
        top = max(shares.values(), default=0.0)
        right = frozenset(name for name, share in shares.items() if share == top > 0)
        truth = CorrectChoices(right, 0, dict.fromkeys(scene, frozenset[str]()))
        agent, _ = self._taught
        with agent.in_scene(scene_with(scene, seed=0, objects=agent.objects)) as other:
            reply = other.hear(command("pointTo", use), only="do", keep=False)
        chosen = reply.chosen.object if reply.chosen else None
        is_right, expected = truth.allows(chosen, None), truth.describe()
        return CaseResult(case.key, is_right, truth.kind, 0, chosen or "nothing", expected)

    def summary(self, results: Sequence[CaseResult]) -> Json:
        """Return how the rows were stored, and how many decisions agree with the file."""
        stored = Counter(result.found for result in results if result.kind == "check")
        decided = [result.right for result in results if result.kind in {"none", "unique", "tie"}]
        return {"facts": dict(stored), "decisions": {"all": len(decided), "right": sum(decided)}}

    @cached_property
    def _facts(self) -> list[Fact]:
        if not self.file:
            raise DataError("expected a file of object, use and share.", source=self.name)
        if not (facts := read_facts(Path(self.file))):
            raise DataError("expected at least one row.", source=self.file)
        return facts

    def _names(self, column: str) -> list[str]:
        return list(dict.fromkeys(str(getattr(fact, column)) for fact in self._facts))

    @cached_property
    def _taught(self) -> tuple[Agent, list[tuple[Sequence[Rule], str]]]:
        kinds = household()
        plain = {o: ObjectType(o, None, frozenset(), True, {}, ()) for o in self._names("object")}
        known = replace(kinds, objects={**plain, **kinds.objects})
        body = Embodiment(Scene((), seed=self.seed), known, simulate=False)
        agent = Agent(open_base("memory:"), load_language(kinds), actions_with(None), body)
        told: list[tuple[Sequence[Rule], str]] = []
        for fact in self._facts:
            try:
                reply = agent.hear(fact.sentence, only="tell")
            except HiltError as error:
                told.append(((), str(error)))
                continue
            learned = reply.rules if reply.is_done else ()
            told.append(([agent.base.rule(rule.id) for rule in learned], reply.said))
        return agent, told
