"""Reading of rules, of the history, and of the trust in speakers.

`rules_at_nodes` is the most frequent query, made at every step of every action; it starts from the
edges of the given nodes, so its time depends on how many rules it finds, not on how many there are.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from heapq import nsmallest
from itertools import islice
from typing import TypeAlias, cast

from ..ontology.errors import NotFoundError
from ..ontology.vocabulary import Iri, iri, split, term
from . import history
from .interval import Interval
from .learned import PHRASES, TAUGHT_ACTIONS, WORDS, LearnedPhrase, LearnedWord, TaughtAction
from .rdf import rule_mapping
from .rdf.rule_mapping import AFFORDANCE, BELIEFS, CONTEXT, DERIVED, FEATURE, PART, atom_iri
from .rdf.terms import Properties, Term, as_sparql
from .rule import Atom, Rule, Status
from .sparql.named_queries import named_query
from .sparql.query_text import bind_variables
from .stores.base import Store, last_utterance

MAX_LISTED = 10  # rules that an error message names
_KEYS = {"object": FEATURE, "action": CONTEXT, "affordance": AFFORDANCE, "part": PART}

NodeProperties: TypeAlias = tuple[Iri, Properties]


class RuleReader:
    """Reads the rules and the history of `store`."""

    def __init__(self, store: Store) -> None:
        self.store = store

    @property
    def is_shared(self) -> bool:
        """Whether other processes may write to the store meanwhile."""
        return not self.store.has_cheap_patterns  # that of an endpoint

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """The active rules at action-tree nodes ("pass.graspObject", "graspObject"), by id."""
        if self.store.has_cheap_patterns:
            edges = (
                edge
                for node in dict.fromkeys(nodes)
                for edge in self.store.quads(iri("node", node), rule_mapping.RULE, None, DERIVED)
            )
            found = [(rule := cast(Iri, edge.object), self.properties(rule)) for edge in edges]
        else:
            query = named_query("rules-of-node").text
            bound = bind_variables(query, {"node": [iri("node", node) for node in nodes]})
            found = _gathered(self.store.select(bound))
        return self.read_rules(sorted(found, key=lambda one: one[0]))

    def rules(
        self,
        *,
        object: str | None = None,
        affordance: str | None = None,
        context: str | None = None,
        part: str | None = None,
        speaker: str | None = None,
        status: Status | None = "active",
    ) -> list[Rule]:
        """The rules that match, in the order in which they were last said.

        They are about an object, for the action `context`, on an affordance or part; None is any.
        """
        # The most selective property comes first.
        atoms = atoms_named(object=object, affordance=affordance, part=part, action=context)
        wanted = [(_KEYS[atom.kind], atom_iri(atom)) for atom in atoms]
        wanted += [(rule_mapping.ATTRIBUTED_TO, iri("speaker", speaker))] if speaker else []
        wanted += [(rule_mapping.STATUS, term(status))] if status else []
        return sorted(self.read_rules(self._with_properties(wanted)), key=_last_said)

    def count_and_rules(self, most: int, *, speaker: str | None = None) -> tuple[int, list[Rule]]:
        """The number of active rules (of a speaker), and at most `most`; only these are read."""
        by = [(rule_mapping.ATTRIBUTED_TO, iri("speaker", speaker))] if speaker else []
        nodes = self.nodes_with([*by, rule_mapping.ACTIVE])
        some = ((node, self.properties(node)) for node in nsmallest(most, nodes))
        return len(nodes), sorted(self.read_rules(some), key=_last_said)

    def rules_with_premises_of(self, rule: Rule) -> list[Rule]:
        """The active rules of the same speaker with the same premises, in any order."""
        if rule.features:  # so that the time does not depend on the size of the base
            wanted = [(FEATURE, atom_iri(one)) for one in sorted(rule.features)]
            wanted += [(CONTEXT, atom_iri(one)) for one in sorted(rule.contexts)]
            found = self.read_rules(self._with_properties([*wanted, rule_mapping.ACTIVE]))
        else:  # of any object: there are few on a node
            found = self.rules_at_nodes([rule.node])
        premises = (rule.features, rule.contexts, rule.speaker)
        return [one for one in found if (one.features, one.contexts, one.speaker) == premises]

    def rule(self, rule_id: str) -> Rule:
        """The rule with an id, whatever its status; UnknownNameError if there is none."""
        node = rule_mapping.rule_iri(rule_id)
        if found := self.properties(node):
            return self.read_rules([(node, found)])[0]
        quads = self.store.quads(None, rule_mapping.STATUS, None, BELIEFS)
        ids = [rule_mapping.rule_id(quad.subject) for quad in islice(quads, MAX_LISTED + 1)]
        more = ["..."] if len(ids) > MAX_LISTED else []
        raise NotFoundError("rule", rule_id, [*ids[:MAX_LISTED], *more])

    def utterance(self, sequence: int) -> history.Utterance:
        """The utterance with a number; UnknownNameError if there is none."""
        if not (found := self.store.properties(history.utterance_iri(sequence), history.HISTORY)):
            last = self.sequence
            raise NotFoundError("utterance", str(sequence), [f"1 to {last}"] if last else [])
        return history.read_utterance(found)

    def history(self, *, since: int = 0, newest_first: bool = False) -> Iterator[history.Utterance]:
        """The utterances after a number, in order or newest first."""
        numbers = range(since + 1, self.sequence + 1)
        for number in reversed(numbers) if newest_first else numbers:
            if found := self.store.properties(history.utterance_iri(number), history.HISTORY):
                yield history.read_utterance(found)

    def words(self) -> list[LearnedWord]:
        """The learned words that were not revoked."""
        return WORDS.active(self.store)

    def phrases(self) -> list[LearnedPhrase]:
        """The learned phrases that were not revoked."""
        return PHRASES.active(self.store)

    def actions(self) -> list[TaughtAction]:
        """The taught actions that were not revoked, the latest of each name, sorted by name."""
        known = sorted(TAUGHT_ACTIONS.active(self.store), key=lambda one: one.utterance or 0)
        latest = {each.name: each for each in known}
        return [latest[name] for name in sorted(latest)]

    @property
    def sequence(self) -> int:
        """The number of the last utterance; 0 before the first. Equal numbers mean equal rules."""
        return last_utterance(self.store)

    def trust(self, speaker: str) -> Interval | None:
        """The trust in a speaker; None when nobody has set it."""
        found = dict(self.store.properties(iri("speaker", speaker), BELIEFS))
        lower, upper = (cast("float | None", found.get(key)) for key in history.TRUST)
        return None if lower is None or upper is None else Interval(lower, upper)

    def match_speaker(self, speaker: str) -> str:
        """The speaker, trusted or not or reported, with this name in any case; else as given."""
        if self.trust(speaker) is not None:
            return speaker
        typed = self.store.quads(None, rule_mapping.TYPE, term("Speaker"), BELIEFS)
        names = sorted((split(quad.subject)[1] for quad in typed), reverse=True)
        return {name.casefold(): name for name in names}.get(speaker.casefold(), speaker)

    def speakers(self) -> tuple[str, ...]:
        """The speakers with a trust above 0, sorted."""
        return tuple(name for name, trust in self.trust_by_speaker().items() if trust.upper > 0)

    def trust_by_speaker(self) -> dict[str, Interval]:
        """The trust in every speaker for whom it was set, sorted by name."""
        quads = self.store.quads(None, history.TRUST_UPPER, None, BELIEFS)
        names = sorted({split(quad.subject)[1] for quad in quads})
        return {name: trust for name in names if (trust := self.trust(name))}

    def properties(self, node: Iri) -> Properties:
        """The properties of a rule's node, with their values."""
        return self.store.properties(node, BELIEFS)

    def _with_properties(self, wanted: Sequence[tuple[Iri, Iri]]) -> list[NodeProperties]:
        if self.store.has_cheap_patterns:
            return [(node, self.properties(node)) for node in self.nodes_with(wanted)]
        return _gathered(self.store.select(_having_query(wanted)))

    def nodes_with(self, wanted: Sequence[tuple[Iri, Iri]]) -> set[Iri]:
        """The nodes of the rules that have all of these properties, if any, else of all rules."""
        if not self.store.has_cheap_patterns:
            return {cast(Iri, node) for (node,) in self.store.select(_having_query(wanted, ""))}
        first, *others = wanted or [(rule_mapping.STATUS, None)]
        found = {quad.subject for quad in self.store.quads(None, *first, BELIEFS)}
        for key, value in others:
            found = {node for node in found if any(self.store.quads(node, key, value, BELIEFS))}
        return found

    def read_rules(self, found: Iterable[NodeProperties]) -> list[Rule]:
        """The rules of nodes with their properties, weighted by the trust in their speakers."""
        rules = [rule_mapping.read_rule(properties) for _, properties in found]
        trust = {speaker: self.trust(speaker) for speaker in {rule.speaker for rule in rules}}
        weights = {name: known.lower if known else 0.0 for name, known in trust.items()}
        pairs = [(rule, weights[rule.speaker]) for rule in rules]
        return [rule if weight == 1.0 else replace(rule, trust=weight) for rule, weight in pairs]


def atoms_named(**names: str | None) -> list[Atom]:
    """The atoms of kinds with names, in that order; none for None."""
    return [Atom(kind, name) for kind, name in names.items() if name is not None]


def _last_said(rule: Rule) -> tuple[int, str]:
    return rule.utterance or 0, rule.id


def _having_query(wanted: Sequence[tuple[Iri, Iri]], read: str = "?property ?value") -> str:
    status = rule_mapping.STATUS  # that of nearly all rules, and engines start with constants
    given = [f"{as_sparql(key)} {as_sparql(value)}" for key, value in wanted if key != status]
    has = "".join(f" FILTER(?status = {as_sparql(one)})" for key, one in wanted if key == status)
    having = f"?rule {' ; '.join([*given, f'{as_sparql(status)} ?status'])} .{has}"
    inside = f"{having} ?rule {read} ." if read else having
    return f"SELECT ?rule {read} WHERE {{ GRAPH {as_sparql(BELIEFS)} {{ {inside} }} }}"


def _gathered(rows: Iterable[tuple[Term | None, ...]]) -> list[NodeProperties]:
    found: dict[Iri, dict[tuple[Iri, Term], None]] = {}
    for node, key, value in rows:
        found.setdefault(cast(Iri, node), {})[(cast(Iri, key), cast(Term, value))] = None
    return [(node, list(properties)) for node, properties in found.items()]
