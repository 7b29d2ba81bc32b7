"""Reconciling an import with a base: conflicts, trust, utterances, episodes and words.

Rules have their ids from their content, so the same rule is recognised. What the base already knows
about a rule (that it was retracted, say) stays. Utterances come after those of the base, in their
order; one that is there already, word for word and to the millisecond, is not repeated.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ...ontology.vocabulary import iri, is_ontology, shortened
from .. import history
from ..episodes import EPISODES
from ..history import HISTORY, Utterance, utterance_iri
from ..interval import EPSILON
from ..knowledge_base import KnowledgeBase, derived_quads
from ..learned import ACTIONS, LEXICON
from ..rdf.domain import DOMAIN, DOMAIN_HASH
from ..rdf.record_mapping import group_pairs
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import BASE_GRAPH, BASE_NODE, Quad, Term
from ..reader import RuleReader
from ..rule import Rule
from ..writer import speaker_quads, trust_quads


@dataclass(frozen=True)
class ImportConflict:
    """A new rule that contradicts a believed one by `weight`, the mass K in [0, 1] before trust."""

    new: Rule
    believed: Rule
    weight: float

    def as_json(self) -> dict[str, object]:
        """The conflict as `hilt import --json` prints it."""
        return {**vars(self), "new": self.new.as_json(), "believed": self.believed.as_json()}


@dataclass(frozen=True)
class ImportSummary:
    """What an import changed, in numbers."""

    #: new, known: rules that the base did not know, and that it knew already
    new: int
    known: int
    conflicting: int  #: conflicts between a new rule and a believed one; `conflicts` are the first
    utterances: int  #: new utterances of the history
    #: speakers of new rules whom nobody trusts, so that their rules weigh nothing
    untrusted: tuple[str, ...]
    conflicts: tuple[ImportConflict, ...] = ()
    #: the first known rules that have another status in the base, where they keep it
    kept: tuple[Rule, ...] = ()
    #: how many statements were left out, by what and where they are: labels of its own, and
    #: statements of the domain or of trust, of which the base has others
    not_taken: Mapping[str, int] = field(default_factory=dict[str, int])

    def as_json(self) -> dict[str, object]:
        """The summary as `hilt import --json` prints it."""
        return {
            **vars(self),
            "untrusted": list(self.untrusted),
            "conflicts": [conflict.as_json() for conflict in self.conflicts],
            "kept": [{**rule.as_json(), "status": rule.status} for rule in self.kept],
            "not_taken": dict(self.not_taken),
        }


@dataclass
class AncillaryWrites:
    """What is to be written besides the rules: statements to insert and to delete."""

    last: int  #: the number of the last utterance there will be
    insert: list[Quad] = field(default_factory=list[Quad])
    delete: list[Quad] = field(default_factory=list[Quad])
    #: the number that each imported utterance has in the base
    numbers: dict[int, int] = field(default_factory=dict[int, int])
    #: the new utterances, with the ids of the rules that they assert
    added: list[Utterance] = field(default_factory=list[Utterance])
    #: how many statements are left out, by their predicate and graph
    left: Counter[str] = field(default_factory=Counter[str])

    def add(self, utterance: Utterance) -> None:
        """Add an utterance under the number that it has."""
        self.added.append(utterance)
        self.insert += history.utterance_quads(replace(utterance, asserts=()))
        self.insert += speaker_quads(utterance.speaker, HISTORY)

    def leave_out(self, quads: Iterable[Quad]) -> None:
        """Count statements that are not taken."""
        places = ((shortened(quad.predicate), shortened(quad.graph or BELIEFS)) for quad in quads)
        self.left.update(f"{key} in {graph}" for key, graph in places)


def believed_rules(base: KnowledgeBase, node: str) -> Mapping[object, Sequence[Rule]]:
    """The active rules at a node of an action tree, by their premises and conclusion (`claim`)."""
    return group_pairs((claim(rule), rule) for rule in base.rules_at_nodes([node]))


def claim(rule: Rule) -> tuple[object, ...]:
    """What a rule says, whatever its interval: its premises and its conclusion."""
    return (rule.features | rule.contexts, rule.functor, rule.argument)


def conflicts_of(rule: Rule, believed: Iterable[Rule]) -> list[ImportConflict]:
    """The conflicts of a new rule with rules of the same premises and conclusion."""
    same = [other for other in believed if other.contexts == rule.contexts]
    found = [ImportConflict(rule, each, rule.interval.conflict(each.interval)) for each in same]
    return [each for each in found if each.weight > EPSILON]


def plan_trust(plan: AncillaryWrites, base: KnowledgeBase, other: RuleReader) -> None:
    """Adopt trust in speakers of whom the base says nothing; an empty base adopts all."""
    is_empty = base.sequence == 0
    for speaker in other.speakers():
        own, theirs, node = base.trust(speaker), other.trust(speaker), iri("speaker", speaker)
        if theirs and theirs != own and (own is None or is_empty):
            plan.delete += base.store.quads(node, None, None, BELIEFS)
            plan.insert += trust_quads(speaker, theirs)
        elif theirs != own:
            plan.leave_out(other.store.quads(node, history.TRUST_LOWER, None, BELIEFS))


def plan_history(plan: AncillaryWrites, base: KnowledgeBase, said: Iterable[Utterance]) -> None:
    """Add the utterances that the base has not, after its own."""
    for utterance in sorted(said, key=lambda one: one.sequence):
        if there := _same_utterance(base, utterance):
            plan.numbers[utterance.sequence] = there
            continue
        plan.last = max(utterance.sequence, plan.last + 1)
        plan.numbers[utterance.sequence] = plan.last
        plan.add(replace(utterance, sequence=plan.last))


def plan_rest(plan: AncillaryWrites, base: KnowledgeBase, other: RuleReader) -> None:
    """Add episodes, words and taught actions, and the domain where the base has none.

    Of another domain the statements that the base has not are left out.
    """
    numbers = plan.numbers.items()
    renumbered: dict[Term, Term] = {utterance_iri(old): utterance_iri(new) for old, new in numbers}
    for graph in (EPISODES, LEXICON, ACTIONS):
        plan.insert += (
            quad._replace(object=renumbered.get(quad.object, quad.object))
            for quad in other.store.quads(None, None, None, graph)
        )
    plan.insert += derived_quads(other.store, EPISODES)
    plan.insert += (quad for quad in other.store.quads() if is_ontology(quad.graph))
    domain = set(other.store.quads(None, None, None, DOMAIN))
    if not any(base.store.quads(BASE_NODE, DOMAIN_HASH, None, BASE_GRAPH)):
        plan.insert += domain
        plan.insert += other.store.quads(BASE_NODE, DOMAIN_HASH, None, BASE_GRAPH)
    elif domain:
        plan.leave_out(domain.difference(base.store.quads(None, None, None, DOMAIN)))


def _same_utterance(base: KnowledgeBase, utterance: Utterance) -> int | None:
    for quad in base.store.quads(None, history.TEXT, utterance.text, HISTORY):
        for number in base.store.quads(quad.subject, history.SEQUENCE, None, HISTORY):
            if isinstance(number.object, int):
                there = base.utterance(number.object)
                if replace(there, sequence=utterance.sequence) == utterance:
                    return there.sequence
    return None
