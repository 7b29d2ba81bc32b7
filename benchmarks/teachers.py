"""The evaluation of the paper with teachers who disagree, with right choices in exact fractions.

    PYTHONPATH=benchmarks hilt evaluate teachers:TeachersExperiment --seed 0

Of each cell (an object and an affordance, or an object, a part and a context) there are up to five
opinions: of teachers who are trusted to different degrees, for and against it, about the object,
about all that is of its class, or about those with a property. So fusion, negation, trust and
specificity act, which the scenarios of the paper leave alone. The right choices follow from the
definitions of docs/inference.md, written here again in exact fractions, without the inference.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from math import log2, prod
from random import Random
from typing import ClassVar

from hilt.agent.agent import Agent
from hilt.agent.config import household
from hilt.agent.evaluation.experiments.decisions import PaperExperiment
from hilt.agent.evaluation.learning_scenarios import CONTEXTS, load_scenarios, rule_sentence

TRUST: Mapping[str, str] = {"sam": "1", "ann": "0.9", "bob": "0.75", "eve": "0.5"}
WORDS: Mapping[str, tuple[str, str]] = {  # word -> interval
    "always": ("1", "1"),
    "generally": ("0.95", "1"),
    "often": ("0.75", "1"),
    "sometimes": ("0.5", "1"),
    "occasionally": ("0.25", "1"),
    "rarely": ("0", "0.25"),
    "never": ("0", "0.05"),
}
THRESHOLD = 0.005
CLASSES = ("cutlery", "footwear", "vessel")
ABSENT = "red"  # a property that none of the objects has

_paper = cache(lambda: load_scenarios()[0])

Exact = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Opinion:
    """What one teacher says of one cell.

    Attributes:
        speaker: the teacher.
        word: the word of confidence.
        about: what it is about: an object, its class, or the object with a property.
        rank: how specific that is: 0 a class, 1 an object, 2 with a property.
        conclusion: an affordance, or a part.
        context: the action it is grasped for; empty for an affordance.
    """

    speaker: str
    word: str
    about: str
    rank: int
    conclusion: str
    context: str = ""

    @property
    def sentence(self) -> str:
        """The sentence that states it."""
        return rule_sentence(self.about, self.conclusion, self.context, self.word)

    @property
    def asserts(self) -> bool:
        """Whether it is for its conclusion."""
        return WORDS[self.word][1] == "1"

    @property
    def support(self) -> Exact:
        """Its interval, discounted by the trust in the teacher."""
        trust = Fraction(TRUST[self.speaker])
        lower, upper = map(Fraction, WORDS[self.word])
        return trust * lower, 1 - trust * (1 - upper)


def fused(opinions: Iterable[Opinion]) -> Exact:
    """Return the interval of opinions about one cell by Yager's rule."""
    pairs = [each.support for each in opinions]
    one = Fraction(1)
    either = prod((upper - lower for lower, upper in pairs), start=one)
    against = prod((one - lower for lower, _ in pairs), start=one)
    return prod((upper for _, upper in pairs), start=one) - either, one - against + either


def plausibility(interval: Exact) -> Fraction | None:
    """Return the relative plausibility of an interval that may be acted on; None of others."""
    lower, upper = interval
    share = upper / (1 + upper - lower)
    certainty = 1 + sum(float(p) * log2(p) for p in (share, 1 - share) if p)
    return share if lower + upper > 1 and certainty > THRESHOLD else None


def standing(opinions: Iterable[Opinion]) -> list[Opinion]:
    """Return the opinions that no more specific one overrides; parts are alternatives."""
    found: list[Opinion] = []
    for each in sorted(opinions, key=lambda one: -one.rank):
        above = (one for one in found if one.rank > each.rank)
        if not any(
            one.conclusion == each.conclusion or (one.asserts and each.asserts) for one in above
        ):
            found.append(each)
    return found


def best(scores: Mapping[str, Fraction | None]) -> frozenset[str]:
    """Return the names with the highest score; none if no score may be acted on."""
    highest = max((score for score in scores.values() if score), default=None)
    return frozenset(name for name, score in scores.items() if score and score == highest)


@dataclass(frozen=True)
class DisputedScenario:
    """A learning scenario of opinions about the objects of the paper, drawn from a seed."""

    name: str
    seed: int

    @property
    def affordances(self) -> tuple[str, ...]:
        """The affordances of the paper."""
        return tuple(_paper().affordances)

    @property
    def grasps(self) -> tuple[str, ...]:
        """The objects of the paper."""
        return tuple(_paper().grasps)

    def told(self) -> list[tuple[str, str]]:
        """Return the teachers and what they say, in a random order."""
        said = [(each.speaker, each.sentence) for each in self._opinions]
        return Random(self.seed).sample(said, len(said))  # noqa: S311 - an order

    def best(self, affordance: str, scene: Collection[str]) -> frozenset[str]:
        """Return the right choices for an affordance in a scene; empty if there are none."""
        return best({name: self._scores[name, affordance] for name in scene})

    @cached_property
    def _scores(self) -> Mapping[tuple[str, str], Fraction | None]:
        """Object and affordance -> score."""
        return {
            (name, use): plausibility(fused(standing(self._about(name, "", use))))
            for name in self.grasps
            for use in self.affordances
        }

    def parts(self, name: str, action: str) -> frozenset[str]:
        """Return the right parts of an object for an action; empty if none may be acted on."""
        left = standing(self._about(name, action)) if action in CONTEXTS else []
        groups = {
            each.conclusion: [o for o in left if o.conclusion == each.conclusion] for each in left
        }
        return best({part: plausibility(fused(each)) for part, each in groups.items()})

    def _about(self, name: str, context: str, conclusion: str = "") -> Iterator[Opinion]:
        """Yield the opinions that apply to an object; those about any conclusion if it is empty."""
        shown = {
            household().objects[name].is_a,
            name,
            *(f"{each} {name}" for each in _properties(name)),
        }
        for each in self._opinions:
            is_asked = each.context == context and conclusion in {"", each.conclusion}
            if is_asked and each.about in shown:
                yield each

    @cached_property
    def _opinions(self) -> tuple[Opinion, ...]:
        rng = Random(f"{self.seed}/{self.name}")  # noqa: S311 - scenarios, not secrets
        parts = household().objects
        cells = [(name, "", use) for use in self.affordances for name in (*CLASSES, *self.grasps)]
        cells += [(o, c, part) for o in self.grasps for c in CONTEXTS for part in parts[o].parts]
        return tuple(opinion for cell in cells for opinion in _drawn(*cell, rng))


@dataclass(frozen=True)
class TeachersExperiment(PaperExperiment):
    """The evaluation of the paper with teachers who disagree, drawn from the seed."""

    name: ClassVar[str] = "teachers:TeachersExperiment"

    @cached_property
    def scenarios(self) -> Mapping[str, DisputedScenario]:
        """Two disputed scenarios."""
        return {name: DisputedScenario(name, self.seed) for name in "AB"}

    def new_agent(self) -> Agent:
        """Return an agent that trusts the teachers to their degrees."""
        agent = super().new_agent()
        for speaker, trust in TRUST.items():
            agent.base.set_trust(speaker, float(trust))
        return agent

    def _covers(self, _: object) -> bool:
        """Take the scenes as they come: a seed may have no two objects with equal opinions."""
        return True


def _properties(name: str) -> list[str]:
    return sorted(household().objects[name].properties)


def _drawn(name: str, context: str, conclusion: str, rng: Random) -> Iterator[Opinion]:
    """Yield random opinions of one cell: of each teacher at most one about the same objects."""
    if name in CLASSES:
        abouts = [(name, 0, rng.choice([0, 1]))]
    else:
        shown = f"{_properties(name)[0]} {name}"
        abouts = [(name, 1, rng.choice([0, 2, 3])), (shown, 2, rng.choice([0, 0, 2]))]
        abouts.append((f"{ABSENT} {name}", 2, rng.choice([0, 0, 1])))
    for about, rank, count in abouts:
        for speaker in rng.sample(sorted(TRUST), count):
            word = rng.choice(list(WORDS))
            yield Opinion(speaker, word, about, rank, conclusion, context)
