"""Induction of rules by analogy: from how a knife is passed to how a screwdriver might be.

The paper's future work (section 7): "knives and screwdrivers are both tools that have pointed ends
and must be handled carefully". A rule about one object is transferred to a similar object, and its
part to the corresponding part. Similarity is Tversky's ratio model (1977) with equal weights,
|A ∩ B| / |A ∪ B|, over the properties, roles of parts and superclasses in the ontology. Features of
the object and the best matching of its parts have equal weight.

A use is transferred only to an object that has the features on which the use rests. These are the
features that were taught with it ("a heavy hammer is used for pounding", or "because it is heavy",
of which a rule about anything heavy is kept that neither asserts nor denies the use), or else
abduced: what all objects with this use have in common, and no object that was denied it has. Of
these the roles of their working parts, all but the grip, come first: a knife cuts by its edge.

An induced rule is discounted by the similarity and by `CAUTION`, so that it never ranks above its
source. It is marked as induced, and not made where anything was taught.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Protocol, TypeAlias

from ..kb.rule import KIND_OF, Atom, Rule
from ..ontology.objects import ObjectType, ObjectTypes, PartType
from .affordance import RuleSource
from .proof import Json

CAUTION = 0.8  # discount of a conclusion by similarity alone
LEAST_SIMILARITY = 0.3  # below this nothing is induced
INDUCER = "induction"  # the speaker of induced rules
GRIP = "grip"  # the role of a part for holding, on which no use rests

Classes: TypeAlias = Mapping[str, str | None]  # a class of objects -> its superclass
Traits = frozenset[str]  # what an object or part has: its features and superclasses


class TaughtRules(RuleSource, Protocol):
    """The rules that induction starts from, such as a knowledge base."""

    def rules(self) -> Sequence[Rule]:
        """Return all active rules."""
        ...


@dataclass(frozen=True)
class InducedRule:
    """An induced rule, discounted by the similarity of the two objects (and parts), in [0, 1].

    `shared` are the features that they have in common, `needed` those on which a use rests.
    """

    rule: Rule
    source: Rule
    similarity: float
    shared: tuple[str, ...]
    needed: tuple[str, ...] = ()

    def as_json(self) -> Json:
        """Return the JSON object that `hilt induce --json` prints: a rule with its reasons."""
        return self.rule.as_json() | {
            "status": self.rule.status,
            "source": self.source.id,
            "similarity": round(self.similarity, 6),
            "shared": list(self.shared),
            **({"needed": list(self.needed)} if self.needed else {}),
        }


def induce(
    rules: Iterable[Rule], objects: ObjectTypes, *, classes: Classes | None = None
) -> list[InducedRule]:
    """Return the rules induced from taught rules, in descending order of belief.

    There is at most one rule for each object, context and part or affordance; none where a rule
    about that object and conclusion (or, for grasps, that object and context) was taught. `classes`
    maps a class of objects to its superclass.
    """
    taught = list(rules)
    traits = {name: _traits(name, objects, classes or {}) for name in objects}
    known = {_topic(rule) for rule in taught}
    general = [r for r in taught if r.object is None and not r.interval.is_vacuous]
    found: dict[tuple[object, ...], InducedRule] = {}
    for rule in taught:
        needed = needed_features(rule, taught, objects) if rule.affordance else frozenset[str]()
        others = frozenset(atom for atom in rule.contexts if atom.kind != "material")
        for name, kind in objects.items():
            induced = _transferred(rule, name, objects, traits, needed)
            if induced is None or any(_covers(each, induced.rule, kind) for each in general):
                continue
            # On a topic on which something was taught, also for any material, nothing is induced.
            for_any = replace(induced.rule, contexts=others)
            if not known.isdisjoint((_topic(induced.rule), _topic(for_any))):
                continue
            key = (*_topic(induced.rule), induced.rule.argument)
            best = found.get(key)
            if best is None or induced.rule.interval.lower > best.rule.interval.lower:
                found[key] = induced
    return sorted(found.values(), key=lambda each: (-each.rule.interval.lower, each.rule.id))


class InducedRuleSource:
    """A source of rules that adds the rules of `induce` to the taught ones."""

    def __init__(self, source: TaughtRules, objects: ObjectTypes, classes: Classes) -> None:
        self.source = source
        self._objects, self._classes = objects, classes
        self._sequence: int | None = None
        self._induced: dict[str, list[Rule]] = defaultdict(list)

    @property
    def sequence(self) -> int:
        """The number of the last change of the taught rules."""
        return self.source.sequence

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """Return the taught and induced rules at the given nodes."""
        if self.sequence != self._sequence:
            self._sequence = self.sequence
            self._induced.clear()
            for each in induce(self.source.rules(), self._objects, classes=self._classes):
                self._induced[each.rule.node].append(each.rule)
        added = [rule for node in dict.fromkeys(nodes) for rule in self._induced.get(node, ())]
        return [*self.source.rules_at_nodes(nodes), *added]


def similarity(one: Traits, other: Traits) -> tuple[float, tuple[str, ...]]:
    """Return the similarity of two sets, |A ∩ B| / |A ∪ B| in [0, 1], and what they share."""
    union, shared = one | other, one & other
    return (len(shared) / len(union) if union else 0.0), tuple(sorted(shared))


def needed_features(rule: Rule, rules: Iterable[Rule], objects: ObjectTypes) -> frozenset[str]:
    """Return the features on which a rule's use rests, taught or abduced; none if not known."""
    same = [r for r in rules if (r.argument, r.contexts) == (rule.argument, rule.contexts)]
    general = (r for r in same if r.object is None and (r.asserts or r.interval.is_vacuous))
    for each in (rule, *general):
        if told := frozenset(str(atom) for atom in each.features if atom.kind != "object"):
            return told
    known = [(r.asserts, objects[r.object]) for r in same if r.object and r.object in objects]
    having = [_features(kind) for asserts, kind in known if asserts]
    lacking = [_features(kind) for asserts, kind in known if not asserts]
    common = frozenset.intersection(*having).difference(*lacking) if having else frozenset[str]()
    roles = frozenset(feature for feature in common if feature.startswith("role:"))
    # What a single object has besides its working parts may have nothing to do with its use.
    return roles or (common if lacking or len(having) > 1 else frozenset())


def _features(kind: ObjectType) -> frozenset[str]:
    properties = (f"property:{prop}" for prop in kind.properties)
    working = (_part_traits(part) for part in kind.parts.values() if part.role != GRIP)
    return frozenset[str]().union(properties, (f"part:{name}" for name in kind.parts), *working)


def _traits(name: str, objects: ObjectTypes, classes: Classes) -> Traits:
    kind = objects.get(name)
    above = kind.is_a if kind else classes.get(name)
    own = frozenset(f"property:{prop}" for prop in (kind.properties if kind else ()))
    return own | {above} | _traits(above, objects, classes) if above else own


def _part_traits(part: PartType) -> Traits:
    return frozenset({f"role:{part.role}", *(f"property:{prop}" for prop in part.properties)})


def _covers(general: Rule, induced: Rule, kind: ObjectType) -> bool:
    features = {str(atom) for atom in general.features}
    if general.part:
        features.add(f"part:{general.part}")
    same = general.functor == induced.functor and general.contexts <= induced.contexts
    is_alike = general.part is not None or general.argument == induced.argument
    return same and is_alike and features <= _features(kind)


def _transferred(
    rule: Rule, name: str, objects: ObjectTypes, traits: Mapping[str, Traits], needed: Traits
) -> InducedRule | None:
    if rule.object is None or rule.object == name or rule.object not in objects:
        return None
    is_of_object = rule.kind == "norm" or rule.functor == KIND_OF  # not of what is like it
    if is_of_object or not objects[name].graspable or not rule.asserts:
        return None
    alike, shared = similarity(traits[rule.object], traits[name])
    argument = rule.argument
    if rule.affordance:
        if not needed or not needed <= _features(objects[name]):
            return None
        alike = max(alike, LEAST_SIMILARITY)  # what matters for the use is the same
    if rule.part:
        source, target = objects[rule.object].parts, objects[name].parts
        if (part := _matching(source, target).get(rule.part)) is None:
            return None
        alike_part, shared_part = similarity(*map(_part_traits, (source[rule.part], target[part])))
        argument = Atom("part", part)
        alike, shared = (alike + alike_part) / 2, tuple(dict.fromkeys((*shared, *shared_part)))
    if alike < LEAST_SIMILARITY:
        return None
    others = frozenset(atom for atom in rule.features if atom.kind != "object")
    induced = replace(
        rule,
        features=others | {Atom("object", name)},
        argument=argument,
        interval=rule.support.discounted(CAUTION * alike),
        speaker=INDUCER,
        status="induced",
    )
    return InducedRule(induced, rule, alike, shared, tuple(sorted(needed)))


def _matching(source: Mapping[str, PartType], target: Mapping[str, PartType]) -> dict[str, str]:
    """Return the part of one object for each of another, so that they are most alike in all."""
    import networkx as nx  # imported here: it takes half a second to load

    pairs: nx.Graph[tuple[str, str]] = nx.Graph()
    for one, other in product(source, target):
        alike, _ = similarity(_part_traits(source[one]), _part_traits(target[other]))
        pairs.add_edge(("one", one), ("other", other), weight=alike)
    matching = (dict(pair) for pair in nx.max_weight_matching(pairs, maxcardinality=True))
    return {pair["one"]: pair["other"] for pair in matching}


def _topic(rule: Rule) -> tuple[object, ...]:
    topic = (rule.object, rule.contexts, rule.functor)
    return topic if rule.part else (*topic, rule.argument)
