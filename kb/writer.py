"""Writing of utterances into a store, with the changes of rules, words and trust they cause.

Each utterance is one atomic write: the utterance, the rules it asserts, retracts or supersedes,
their edges and its number. A rule is never deleted: its status changes, and the history keeps it.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime, timezone
from functools import partial
from typing import cast

from ..ontology.errors import NotFoundError
from ..ontology.vocabulary import Iri, iri, split, term
from . import learned
from .episodes import EPISODES, FORGOTTEN_BY, trial_nodes
from .history import HISTORY, SEQUENCE, Utterance, trust_bounds, utterance_iri, utterance_quads
from .interval import Interval
from .learned import TAUGHT_ACTIONS, LearnedMapping, LearnedPhrase, LearnedWord, TaughtAction
from .rdf import rule_mapping
from .rdf.record_mapping import Record
from .rdf.rule_mapping import BELIEFS
from .rdf.terms import BASE_GRAPH, BASE_NODE, Quad
from .reader import RuleReader
from .rule import DEFAULT_SPEAKER, Rule, Status, check_speaker
from .stores.base import Store


@dataclass
class _Change:
    insert: list[Quad] = field(default_factory=list[Quad])
    delete: list[Quad] = field(default_factory=list[Quad])

    def replace(self, old: Iterable[Quad], new: Iterable[Quad]) -> None:
        before, after = set(old), set(new)
        self.delete += sorted(before - after, key=str)
        self.insert += sorted(after - before, key=str)


class RuleWriter(RuleReader):
    """Writes rules and utterances into `store`, at the times that `clock` gives."""

    def __init__(self, store: Store, *, clock: Callable[[], datetime] | None = None) -> None:
        super().__init__(store)
        self._own = 0
        self.clock = clock or partial(datetime.now, timezone.utc)

    def believe(
        self,
        text: str,
        predicate: str,
        speaker: str,
        rules: Iterable[Rule],
        *,
        retracts: Iterable[str] = (),
        supersedes: Iterable[str] = (),
        words: Iterable[LearnedWord] = (),
        actions: Iterable[TaughtAction] = (),
        kind: str = "statement",
        answer: str = "",
        heard: float = 1.0,
        time: datetime | None = None,
        source: str | None = None,
    ) -> Utterance:
        """Add an utterance and the rules it asserts; durable when this returns.

        The same rule said again by the same speaker stays one rule. The caller decides whether the
        speaker is to be believed (`trust`).

        The arguments are those of `Utterance`; its time is now by default. The rules are attributed
        to its speaker, or to the `source` whose words the speaker reports; `words` and `actions`
        are what else was learned from it. `heard` is already part of the intervals of the rules.
        UnknownNameError if a rule to retract does not exist; StoreError if it could not be written;
        nothing has changed.
        """
        teller = source or speaker
        asserted = {rule.id: rule for rule in (replace(one, speaker=teller) for one in rules)}
        gone = set(retracts) - set(asserted)
        utterance = Utterance(
            *(0, text, predicate, speaker, to_milliseconds(time or self.clock()), kind),
            answer=answer,
            asserts=tuple(sorted(asserted)),
            retracts=tuple(sorted(gone)),
            supersedes=tuple(sorted(set(supersedes) - gone - set(asserted))),
            heard=heard,
        )
        with self.store.writing():
            change, number = _Change(), self.sequence + 1
            change.insert += speaker_quads(source, BELIEFS) if source else []
            for word in words:
                node = learned.WORDS.node(word)
                before = self.store.quads(node, learned.LOOK.predicate, None, None)
                change.replace(before, learned.WORDS.learned_quads(replace(word, utterance=number)))
            for action in actions:
                for known in TAUGHT_ACTIONS.active(self.store):
                    if known.name == action.name:
                        self._end_learned(change, TAUGHT_ACTIONS, known)
                change.insert += TAUGHT_ACTIONS.learned_quads(replace(action, utterance=number))
            return self._write(utterance, list(asserted.values()), change)

    def record(
        self,
        text: str,
        predicate: str,
        speaker: str,
        kind: str,
        *,
        accepted: bool,
        answer: str = "",
        heard: float = 1.0,
    ) -> Utterance:
        """Add an utterance that changes no rule, as a command; arguments as for `Utterance`."""
        said = (0, text, predicate, speaker, to_milliseconds(self.clock()), kind, accepted, answer)
        return self.write(Utterance(*said, heard=heard))

    def retract(
        self, rule_id: str, text: str, predicate: str, speaker: str, *, answer: str = ""
    ) -> Utterance:
        """Retract a rule because of an utterance; UnknownNameError if there is no such rule."""
        return self.believe(
            text, predicate, speaker, [], retracts=[rule_id], kind="correction", answer=answer
        )

    def write(
        self,
        utterance: Utterance,
        rules: Sequence[Rule] = (),
        *,
        insert: Iterable[Quad] = (),
        delete: Iterable[Quad] = (),
    ) -> Utterance:
        """Number an utterance and write it, the rules it asserts or ends, and other statements."""
        with self.store.writing():
            return self._write(utterance, rules, _Change([*insert], [*delete]))

    def set_trust(
        self, speaker: str, lower: float, *, upper: float | None = None, by: str = DEFAULT_SPEAKER
    ) -> Interval:
        """Set the trust in a speaker, in [0, 1]; `by` is who sets it, for the history.

        Rules of the speaker are discounted by `lower`; `upper` is 1 by default, 0 if `lower` is 0.
        """
        check_speaker(speaker)
        trust = Interval(lower, (1.0 if lower else 0.0) if upper is None else upper).rounded()
        form = f"trust({speaker},{trust.lower},{trust.upper})"
        said = (0, f"trust {speaker} {trust}", form, by, to_milliseconds(self.clock()), "trust")
        with self.store.writing():
            before = {*self.store.quads(iri("speaker", speaker), None, None, BELIEFS)}
            after = {*trust_quads(speaker, trust)}
            self.write(Utterance(*said), insert=after - before, delete=before - after)
        return trust

    def learn_phrase(self, phrase: LearnedPhrase) -> None:
        """Store a phrase that the last utterance confirmed; durable when this returns."""
        with self.store.writing():
            kept = [*learned.PHRASES.learned_quads(replace(phrase, utterance=self.last_written))]
            before = {*self.store.quads(kept[0].subject, None, None, learned.LEXICON)}
            self.store.apply(insert=kept, delete=before - {*kept})

    def forget_trials(
        self, text: str, speaker: str, *, of: str | None = None, part: str | None = None
    ) -> int:
        """Let grasp trials no longer count as experience, and return how many they were.

        They are those `of` a kind of object by this part; None for any. `text` is the utterance
        that forgets them, for the history. A NotFoundError says that there are none.
        """
        with self.store.writing():
            if not (found := list(trial_nodes(self.store, of, part))):
                raise NotFoundError("experience", " ".join(filter(None, (of, part))) or "any", ())
            by = utterance_iri(self.sequence + 1)
            forgotten = [Quad(node, FORGOTTEN_BY, by, EPISODES) for node in found]
            self.write(self._correction(text, speaker), insert=forgotten)
        return len(found)

    def forget(
        self,
        mapping: LearnedMapping[Record],
        name: str,
        text: str,
        speaker: str,
        *,
        answer: str = "",
    ) -> Record:
        """Retract what was learned and has this name; its node stays.

        `mapping` is `WORDS`, `PHRASES` (their names are the pattern, and an utterance from which it
        was learned), or `TAUGHT_ACTIONS`; `text` is the utterance that retracts it, for the
        history. A NotFoundError says that there is none.
        """
        with self.store.writing():
            known = mapping.active(self.store)
            if not (found := [record for record in known if name in mapping.names(record)]):
                others = (each for one in known for each in mapping.names(one))
                raise NotFoundError(mapping.what.removeprefix("A "), name, others)
            change = _Change()
            for record in found:
                self._end_learned(change, mapping, record)
            self._write(replace(self._correction(text, speaker), answer=answer), [], change)
        return found[-1]

    def _end_learned(self, change: _Change, kind: LearnedMapping[Record], record: Record) -> None:
        before = self.store.quads(kind.node(record), None, None, kind.graph)
        change.replace(before, kind.learned_quads(record, status="retracted"))

    @property
    def last_written(self) -> int:
        """The number of the last utterance of this process; of all, if it has written none."""
        return self._own or self.sequence

    def _correction(self, text: str, speaker: str) -> Utterance:
        return Utterance(0, text, "", speaker, to_milliseconds(self.clock()), "correction")

    def _write(self, utterance: Utterance, rules: Sequence[Rule], change: _Change) -> Utterance:
        last, time = self.sequence, utterance.time
        if last and self.is_shared:  # by processes whose clocks may differ a little
            at = self.store.quads(utterance_iri(last), rule_mapping.GENERATED_AT, None, HISTORY)
            time = max([time, *(cast(datetime, quad.object) for quad in at)])
        numbered = replace(utterance, sequence=last + 1, time=time)
        change.replace(
            [Quad(BASE_NODE, SEQUENCE, last, BASE_GRAPH)] if last else [],
            [Quad(BASE_NODE, SEQUENCE, last + 1, BASE_GRAPH)],
        )
        change.insert += utterance_quads(numbered)
        change.insert += speaker_quads(utterance.speaker, HISTORY)
        for rule in rules:
            asserted = replace(rule, utterance=last + 1, time=time, status="active")
            before = self.store.quads(rule_mapping.rule_iri(rule.id), None, None, BELIEFS)
            change.replace(before, rule_mapping.rule_quads(asserted))
        self._end(change, numbered.retracts, "retracted", rules)
        self._end(change, numbered.supersedes, "superseded", rules)
        self.store.apply(insert=change.insert, delete=change.delete)
        self._own = last + 1
        return numbered

    def _end(
        self, change: _Change, rule_ids: Sequence[str], status: Status, new: Sequence[Rule]
    ) -> None:
        ended = [self.rule(one) for one in rule_ids]
        gone = {rule.id for rule in ended}
        for rule in ended:
            change.replace(*map(rule_mapping.property_quads, (rule, replace(rule, status=status))))
            change.delete.append(rule_mapping.node_edge(rule))
            gone_edges = {*rule_mapping.edges(rule)} - self._asserted(rule, gone, new)
            change.delete += sorted(gone_edges, key=str)

    def _asserted(self, ended: Rule, gone: set[str], new: Sequence[Rule]) -> set[Quad]:
        found = {quad for rule in new for quad in rule_mapping.edges(rule)}
        for edge in rule_mapping.plain_edges(ended):
            end = cast(Iri, edge.object)
            concludes = (rule_mapping.argument_property(split(end)[0]), end)
            about = (rule_mapping.FEATURE, edge.subject)
            nodes = self.nodes_with([about, concludes, rule_mapping.ACTIVE])
            left = (node for node in nodes if rule_mapping.rule_id(node) not in gone)
            for rule in self.read_rules((node, self.properties(node)) for node in left):
                found.update(rule_mapping.edges(rule))
        return found


def trust_quads(speaker: str, trust: Interval) -> list[Quad]:
    """The statements of the trust in a speaker."""
    node = iri("speaker", speaker)
    return [*speaker_quads(speaker, BELIEFS), *trust_bounds(node, trust, BELIEFS)]


def speaker_quads(speaker: str, graph: Iri) -> list[Quad]:
    """The type and name of a speaker."""
    pairs = ((rule_mapping.TYPE, term("Speaker")), (rule_mapping.LABEL, speaker))
    return [Quad(iri("speaker", speaker), key, value, graph) for key, value in pairs]


def to_milliseconds(time: datetime) -> datetime:
    """A time truncated to milliseconds, as it is stored."""
    return time.replace(microsecond=time.microsecond // 1000 * 1000)
