# SPDX-License-Identifier: Apache-2.0
"""Induction: from how a knife is passed to how a screwdriver might be.

The paper's future work (section 7): "knives and screwdrivers are both tools that have pointed ends
and must be handled carefully". A rule about one object is carried over to another that is like it,
and its part to the part that is like it. How alike two things are is Tversky's ratio model (1977)
with equal weights, |A ∩ B| / |A ∪ B|, over what the ontology says of them: properties, roles of
their parts, and kinds above them. An object's features and its best pairing of parts count alike.

An induced rule is discounted by that similarity and by `CAUTION`, so it never stands above the rule
it came from; it is marked as induced, and it is dropped where anything was taught. It is wrong
where likeness misleads: a spoon and a knife are both long and of metal, but only one of them cuts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

from ..kb.rule import Atom, Rule
from ..ontology.objects import ObjectType, PartType

if TYPE_CHECKING:
    import networkx as nx

CAUTION = 0.8  # share of trust that is left to a conclusion by likeness alone
LEAST_SIMILARITY = 0.3  # below this two things are not alike enough to conclude anything
INDUCER = "induction"  # the speaker of induced rules

Json = dict[str, object]


class TaughtRules(Protocol):
    """What induction asks of a knowledge base."""

    @property
    def sequence(self) -> int:
        """The number of the last change."""
        ...

    def rules(self) -> Sequence[Rule]:
        """All rules that hold."""
        ...

    def rules_at_nodes(self, nodes: Sequence[str]) -> Sequence[Rule]:
        """The rules that hang on these nodes."""
        ...


@dataclass(frozen=True)
class Induced:
    """A rule that nobody taught, with the reasons for it.

    Attributes:
        rule: discounted, with status "induced".
        source: the rule that was taught.
        similarity: of the two objects (and parts), in [0, 1].
        shared: what they have in common.
    """

    rule: Rule
    source: Rule
    similarity: float
    shared: tuple[str, ...]

    def as_json(self) -> Json:
        """As `hilt induce --json` prints it: a rule, with its reasons."""
        return self.rule.as_json() | {
            "status": self.rule.status,
            "source": self.source.id,
            "similarity": round(self.similarity, 6),
            "shared": list(self.shared),
        }


def induce(
    rules: Iterable[Rule],
    objects: Mapping[str, ObjectType],
    *,
    classes: Mapping[str, str | None] | None = None,
) -> list[Induced]:
    """The rules that follow by likeness from those that were taught, the surest first.

    Args:
        rules: those that hold.
        objects: the kinds of objects there are.
        classes: class of objects -> the class above it.

    Returns:
        At most one rule for each object, context and part or affordance; none where a rule about
        that object and conclusion (or, for grasps, that object and context) was taught.
    """
    taught = list(rules)
    graph = ontology_graph(objects, classes or {})
    known = {_matter(rule) for rule in taught}
    found: dict[tuple[object, ...], Induced] = {}
    for rule in taught:
        for name in objects:
            induced = _carried_over(rule, name, objects, graph)
            if induced is None or _matter(induced.rule) in known:
                continue
            key = (*_matter(induced.rule), induced.rule.argument)
            best = found.get(key)
            if best is None or induced.rule.interval.lower > best.rule.interval.lower:
                found[key] = induced
    return sorted(found.values(), key=lambda each: (-each.rule.interval.lower, each.rule.id))


class Inducing:
    """A source of rules that adds those which follow by likeness from the taught ones.

    Args:
        source: where the taught rules are.
        objects: the kinds of objects there are.
        classes: class of objects -> the class above it.
    """

    def __init__(
        self,
        source: TaughtRules,
        objects: Mapping[str, ObjectType],
        classes: Mapping[str, str | None],
    ) -> None:
        self.source = source
        self._objects, self._classes = objects, classes
        self._sequence = -1
        self._induced: dict[str, list[Rule]] = {}

    @property
    def sequence(self) -> int:
        """The number of the last change of what was taught."""
        return self.source.sequence

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """The rules that hang on these nodes, taught and induced ones."""
        if self.sequence != self._sequence:
            self._sequence = self.sequence
            self._induced = {}
            for each in induce(self.source.rules(), self._objects, classes=self._classes):
                self._induced.setdefault(each.rule.node, []).append(each.rule)
        added = [rule for node in dict.fromkeys(nodes) for rule in self._induced.get(node, ())]
        return [*self.source.rules_at_nodes(nodes), *added]


def ontology_graph(
    objects: Mapping[str, ObjectType], classes: Mapping[str, str | None]
) -> nx.DiGraph[str]:
    """Objects, their parts, and all that is said of them, as edges to what they have."""
    import networkx as nx  # here: half a second, and only induction needs it

    graph: nx.DiGraph[str] = nx.DiGraph()
    for name, above in classes.items():
        graph.add_node(name)
        if above:
            graph.add_edge(name, above)
    for name, kind in objects.items():
        graph.add_edges_from((name, f"property:{prop}") for prop in kind.properties)
        if kind.is_a:
            graph.add_edge(name, kind.is_a)
        for part in kind.parts.values():
            node = _part_node(name, part)
            graph.add_edge(node, f"role:{part.role}")
            graph.add_edges_from((node, f"property:{prop}") for prop in part.properties)
    return graph


def similarity(one: str, other: str, graph: nx.DiGraph[str]) -> tuple[float, tuple[str, ...]]:
    """How alike two nodes are, in [0, 1], and what they share: |A ∩ B| / |A ∪ B|."""
    import networkx as nx

    if one not in graph or other not in graph:
        return 0.0, ()
    has_one, has_other = nx.descendants(graph, one), nx.descendants(graph, other)
    union = has_one | has_other
    shared = has_one & has_other
    return (len(shared) / len(union) if union else 0.0), tuple(sorted(shared))


def _carried_over(
    rule: Rule, name: str, objects: Mapping[str, ObjectType], graph: nx.DiGraph[str]
) -> Induced | None:
    """A rule about one object as a rule about another, if they are alike enough."""
    if rule.object is None or rule.object == name or rule.object not in objects:
        return None
    if not objects[name].graspable or not rule.asserts:
        return None
    alike, shared = similarity(rule.object, name, graph)
    argument = rule.argument
    if rule.part:
        part, alike_part, shared_part = _like_part(rule, name, objects, graph)
        if part is None:
            return None
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
    return Induced(induced, rule, alike, shared)


def _like_part(
    rule: Rule, name: str, objects: Mapping[str, ObjectType], graph: nx.DiGraph[str]
) -> tuple[str | None, float, tuple[str, ...]]:
    """The part that plays the same part in another object as the one a rule names.

    All parts of the two objects are paired at once so that the pairs are most alike together: a
    grip answers to a grip, even where a metal grip is also somewhat like a metal blade.
    """
    import networkx as nx

    source = objects[rule.object or ""]
    if rule.part is None or rule.part not in source.parts:
        return None, 0.0, ()
    pairs: nx.Graph[tuple[str, str]] = nx.Graph()
    for one in source.parts.values():
        for other in objects[name].parts.values():
            nodes = _part_node(source.name, one), _part_node(name, other)
            alike, _ = similarity(*nodes, graph)
            pairs.add_edge(("one", one.name), ("other", other.name), weight=alike)
    matching = [dict(pair) for pair in nx.max_weight_matching(pairs, maxcardinality=True)]
    best = next((pair["other"] for pair in matching if pair["one"] == rule.part), None)
    if best is None:
        return None, 0.0, ()
    part, counterpart = source.parts[rule.part], objects[name].parts[best]
    return best, *similarity(_part_node(source.name, part), _part_node(name, counterpart), graph)


def _matter(rule: Rule) -> tuple[object, ...]:
    """What a rule is about: one taught rule on it leaves nothing to induce."""
    matter = (rule.object, rule.contexts, rule.functor)
    return matter if rule.part else (*matter, rule.argument)


def _part_node(name: str, part: PartType) -> str:
    return f"{name}.{part.name}"
