"""Experience: how grasps turned out, as evidence beside what was told.

Of n grasps s held. The interval of the probability that the next one holds is the envelope of the
equal-tailed credible intervals of the Beta posteriors over Walley's near-ignorance priors of
strength 1, Beta(t, 1 - t) for all t in (0, 1):

    [ B(α/2; s, n - s + 1),  B(1 - α/2; s + 1, n - s) ]

where B is the quantile of the Beta distribution and α = 1 - `CREDIBILITY`. It is [0, 1] for n = 0,
and equal to the exact interval of Clopper and Pearson (1934). For whole numbers, B(q; s, n - s + 1)
is the share at which s or more of n grasps hold with probability q.

What was told, [a, b], is discounted by experience [l, u] to [a·u, b]: the mass that supports it is
unreliable to the degree 1 - u at least, that against it is not touched (contextual discounting,
Mercier, Quost and Denœux 2008). The two contradict each other by the mass a·(1 - u).
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from math import exp, lgamma, log, log1p

from ..kb.episodes import HELD
from ..kb.interval import Interval
from ..kb.knowledge_base import KnowledgeBase
from ..kb.rdf.record_mapping import local_name
from ..kb.rule import Rule
from ..kb.sparql.named_queries import named_query
from ..ontology.vocabulary import Iri
from .proof import Json

CREDIBILITY = 0.95
PRECISION = 1e-16


@cache
def credible_interval(held: int, trials: int) -> Interval:
    """Return the interval of the probability of success after some successes in some trials."""
    return Interval(_lower_bound(held, trials), 1 - _lower_bound(trials - held, trials))


def _lower_bound(held: int, trials: int) -> float:
    low, high = 0.0, held / trials if held else 0.0
    while low < (middle := (low + high) / 2) < high:
        is_rarer = _upper_tail(held, trials, middle) < (1 - CREDIBILITY) / 2
        low, high = (middle, high) if is_rarer else (low, middle)
    return low


def _upper_tail(least: int, trials: int, share: float) -> float:
    ways = lgamma(trials + 1) - lgamma(least + 1) - lgamma(trials - least + 1)
    term = exp(ways + least * log(share) + (trials - least) * log1p(-share))
    total, odds, held = 0.0, share / (1 - share), least
    while term > total * PRECISION:
        total += term
        term *= odds * (trials - held) / (held + 1)
        held += 1
    return total


def contradiction(told: Interval, seen: Interval) -> float:
    """Return the mass by which experience contradicts what was told, in [0, 1]."""
    return told.lower * (1 - seen.upper)


@dataclass(frozen=True)
class OutcomeCounts:
    """How often grasps came to each outcome: pairs of an outcome and a number, sorted."""

    outcomes: tuple[tuple[str, int], ...] = ()

    @classmethod
    def of(cls, counts: Mapping[str, int]) -> "OutcomeCounts":
        """Return the counts that are not 0."""
        return cls(tuple(sorted((name, times) for name, times in counts.items() if times)))

    @property
    def trials(self) -> int:
        """The number of grasps."""
        return sum(times for _, times in self.outcomes)

    @property
    def held(self) -> int:
        """How many of them held."""
        return dict(self.outcomes).get(HELD, 0)

    @property
    def failures(self) -> Mapping[str, int]:
        """How often each failure occurred."""
        return {name: times for name, times in self.outcomes if name != HELD}

    @property
    def interval(self) -> Interval:
        """The interval of the probability that the next grasp holds."""
        return credible_interval(self.held, self.trials)

    def __add__(self, other: "OutcomeCounts") -> "OutcomeCounts":
        return OutcomeCounts.of(Counter(dict(self.outcomes)) + Counter(dict(other.outcomes)))

    def since(self, earlier: "OutcomeCounts") -> "OutcomeCounts":
        """Return what was added to earlier counts; nothing where some were forgotten since."""
        return OutcomeCounts.of(Counter(dict(self.outcomes)) - Counter(dict(earlier.outcomes)))

    def as_json(self) -> Json:
        """Return the counts with the interval that follows from them."""
        interval = self.interval.rounded()
        bounds = {"lower": interval.lower, "upper": interval.upper}
        return {"trials": self.trials, "outcomes": dict(self.outcomes), **bounds}

    def __str__(self) -> str:
        each = (f"{name.replace('_', ' ')} {times}" for name, times in self.outcomes)
        return f"{', '.join(each)} of {self.trials}" if self.outcomes else "none"


@dataclass(frozen=True)
class GraspRecord:
    """The outcomes of grasping an object by a part, in the context of an action, by a robot."""

    object: str
    part: str
    context: str
    robot: str
    counts: OutcomeCounts

    def as_json(self) -> Json:
        """Return the JSON object that `hilt experience --json` prints."""
        names = {name: value for name, value in vars(self).items() if name != "counts"}
        return names | self.counts.as_json()


def read_records(base: KnowledgeBase, **wanted: str) -> list[GraspRecord]:
    """Return the records of a base; `wanted` are arguments of the named query "experience"."""
    query = named_query("experience")
    found: dict[tuple[str, str, str, str], dict[str, int]] = {}
    for row in base.select(query.text, query.bindings(wanted)):
        said = (local_name(one) if isinstance(one, Iri) else str(one) for one in row)
        name, part, context, robot, outcome, times = said
        found.setdefault((name, part, context, robot), {})[outcome] = int(times)
    return [GraspRecord(*key, OutcomeCounts.of(counts)) for key, counts in found.items()]


class Experience:
    """The experience of one robot, as a base has it now, or had it `before` an utterance."""

    def __init__(self, base: KnowledgeBase, robot: str, *, before: int | None = None) -> None:
        self.base = base
        self._version: tuple[object, object] | None = None
        self._wanted = {"robot": robot} | ({"before": str(before)} if before else {})
        self._counts: dict[str, dict[tuple[str, str], OutcomeCounts]] = {}

    def of(self, name: str, part: str, context: str) -> OutcomeCounts:
        """Return the outcomes of grasping an object by a part for an action."""
        version = self.base.sequence, self.base.episodes_recorded
        if version != self._version:
            self._counts.clear()
            self._version = version
        if name not in self._counts:
            records = read_records(self.base, object=name, **self._wanted)
            self._counts[name] = {(each.part, each.context): each.counts for each in records}
        return self._counts[name].get((part, context), NO_TRIALS)


NO_TRIALS = OutcomeCounts()


@dataclass(frozen=True)
class TeacherRecord:
    """The trust in a speaker, in [0, 1], and how grasps turned out as the speaker's rules say."""

    speaker: str
    trust: float
    counts: OutcomeCounts

    @property
    def suggested(self) -> float:
        """The trust that agrees with the record and is nearest to the present one."""
        agreeing = self.counts.interval
        return min(max(self.trust, agreeing.lower), agreeing.upper)

    def as_json(self) -> Json:
        """Return the JSON object that `hilt trust --suggest --json` prints."""
        known = {"speaker": self.speaker, "trust": self.trust}
        return known | self.counts.as_json() | {"suggested": round(self.suggested, 6)}


def teacher_records(
    rules: Iterable[Rule], trust: Mapping[str, Interval], records: Sequence[GraspRecord]
) -> list[TeacherRecord]:
    """Return the record of each speaker with a rule about a grasp, by name."""
    said: dict[str, set[tuple[str | None, ...]]] = defaultdict(set)
    for rule in rules:
        if rule.part and rule.asserts:
            said[rule.speaker].add((rule.object, rule.part, rule.context))
    counts = dict.fromkeys(sorted(said), NO_TRIALS)
    for each in records:
        claims = {*product((each.object, None), [each.part], (each.context, None))}
        for name in counts:
            if not claims.isdisjoint(said[name]):
                counts[name] += each.counts
    believed = {name: interval.lower for name, interval in trust.items()}
    return [TeacherRecord(name, believed.get(name, 0.0), each) for name, each in counts.items()]
