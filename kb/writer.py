# SPDX-License-Identifier: Apache-2.0
"""How what is said changes what is believed.

Everything that is said becomes one atomic write: the utterance, the rules it asserts, retracts or
supersedes, their edges and the number of the utterance. Nothing is ever deleted by forgetting:
a rule changes its status, and history tells.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime, timezone
from decimal import Decimal

from ..ontology.errors import NotFoundError
from ..ontology.vocabulary import Iri, iri, term
from .history import HISTORY, SEQUENCE, Utterance, utterance_quads
from .interval import Interval
from .learned_words import LEXICON, Word, word_iri, word_quads
from .rdf import rule_mapping
from .rdf.rule_mapping import BELIEFS
from .rdf.terms import Quad
from .reader import BASE_GRAPH, BASE_NODE, TRUST_LOWER, TRUST_UPPER, RuleReader
from .rule import DEFAULT_SPEAKER, Rule, Status, check_speaker

_TRUST = re.compile(r"trust\(([^,()]+),([0-9.e-]+),([0-9.e-]+)\)")  # as `set_trust` writes it


@dataclass
class _Change:
    """Statements to be written as one unit."""

    insert: list[Quad] = field(default_factory=list[Quad])
    delete: list[Quad] = field(default_factory=list[Quad])

    def replace(self, old: Iterable[Quad], new: Iterable[Quad]) -> None:
        """Exchange statements, leaving alone what is in both."""
        before, after = set(old), set(new)
        self.delete += sorted(before - after, key=str)
        self.insert += sorted(after - before, key=str)


class RuleWriter:
    """Writes rules and utterances into a store.

    Attributes:
        clock: gives the time of what is said.
    """

    def __init__(self, reader: RuleReader, *, clock: Callable[[], datetime] | None = None) -> None:
        """Write into the store of a reader.

        Args:
            reader: reads what is there already.
            clock: gives the time of what is said; the system's by default.
        """
        self._reader, self._store = reader, reader.store
        self.clock = clock or _now

    # What is said

    def believe(
        self,
        text: str,
        predicate: str,
        speaker: str,
        rules: Iterable[Rule],
        *,
        retracts: Iterable[str] = (),
        supersedes: Iterable[str] = (),
        words: Iterable[Word] = (),
        kind: str = "statement",
        answer: str = "",
        heard: float = 1.0,
        time: datetime | None = None,
    ) -> Utterance:
        """Believe what was said; it is durable when this returns.

        The same rule told again by the same speaker stays one rule. Whether the speaker may be
        believed is for the caller to ask (`trust`).

        Args:
            text: as it was said.
            predicate: what was understood, in predicate form.
            speaker: who said it; the rules become this speaker's.
            rules: what to believe.
            retracts: ids of rules that are taken back.
            supersedes: ids of rules that are replaced by these.
            words: new words that were learned from it.
            kind: statement or correction.
            answer: what was said back.
            heard: how surely the words were recognised, in [0, 1]; already part of the rules.
            time: when it was said; now by default.

        Returns:
            The utterance as it stands in the history.

        Raises:
            UnknownNameError: a rule to take back is not there.
            StoreError: it could not be written; nothing has changed.
        """
        told = {rule.id: rule for rule in (replace(one, speaker=speaker) for one in rules)}
        utterance = Utterance(
            0,
            text,
            predicate,
            speaker,
            to_milliseconds(time or self.clock()),
            kind,
            True,
            answer,
            tuple(sorted(told)),
            tuple(sorted(set(retracts) - set(told))),
            tuple(sorted(set(supersedes) - set(told))),
            heard,
        )
        with self._store.writing():
            change = _Change()
            for word in words:
                change.insert += word_quads(word, self._reader.sequence + 1)
            return self._write(utterance, list(told.values()), change)

    def record(
        self,
        text: str,
        predicate: str,
        speaker: str,
        kind: str,
        *,
        accepted: bool,
        answer: str = "",
        time: datetime | None = None,
        heard: float = 1.0,
    ) -> Utterance:
        """Keep in the history what changes no rule: a command, a question, a refused statement.

        Args:
            text: as it was said.
            predicate: what was understood, in predicate form; empty when nothing was.
            speaker: who said it.
            kind: command, question, statement, ...
            accepted: whether it was carried out or believed.
            answer: what was said back.
            time: when it was said; now by default.
            heard: how surely the words were recognised, in [0, 1].
        """
        moment = to_milliseconds(time or self.clock())
        utterance = Utterance(
            0, text, predicate, speaker, moment, kind, accepted, answer, heard=heard
        )
        with self._store.writing():
            return self._write(utterance, [])

    def retract(
        self,
        rule_id: str,
        text: str,
        predicate: str,
        speaker: str,
        *,
        answer: str = "",
        time: datetime | None = None,
    ) -> Utterance:
        """Take a rule back because somebody said so; history keeps it.

        Raises:
            UnknownNameError: there is no such rule.
        """
        gone, kind = [rule_id], "correction"
        return self.believe(
            text, predicate, speaker, [], retracts=gone, kind=kind, answer=answer, time=time
        )

    def set_trust(
        self,
        speaker: str,
        lower: float,
        *,
        upper: float | None = None,
        by: str = DEFAULT_SPEAKER,
    ) -> Interval:
        """Say how far a speaker is trusted; what the speaker tells is discounted by `lower`.

        It is kept in the history, as it changes what the rules weigh.

        Args:
            speaker: whom.
            lower: how far at least, in [0, 1].
            upper: how far at most; 1 by default, but 0 where `lower` is 0: not at all.
            by: who says so.
        """
        check_speaker(speaker)
        most = (1.0 if lower else 0.0) if upper is None else upper
        trust = Interval(lower, most).rounded()
        said = f"trust {speaker} {trust}"
        form = f"trust({speaker},{trust.lower},{trust.upper})"
        utterance = Utterance(0, said, form, by, to_milliseconds(self.clock()), "trust")
        with self._store.writing():
            before = self._store.quads(iri("speaker", speaker), None, None, BELIEFS)
            change = _Change()
            change.replace(before, trust_quads(speaker, trust))
            self._write(utterance, [], change)
        return trust

    def forget_word(self, name: str, text: str, speaker: str) -> Word:
        """Revoke a learned word because somebody said so; the graph keeps it as retracted.

        Raises:
            UnknownNameError: no word of that name was learned.
        """
        with self._store.writing():
            known = {word.atom.name: word for word in self._reader.words()}
            if name not in known:
                raise NotFoundError("learned word", name, known)
            change = _Change()
            node, word = word_iri(known[name].atom), known[name]
            kept = word_quads(word, word.utterance or 0, status="retracted")
            change.replace(self._store.quads(node, None, None, LEXICON), kept)
            moment = to_milliseconds(self.clock())
            self._write(Utterance(0, text, "", speaker, moment, "correction"), [], change)
        return word

    # How it is written

    def _write(
        self, utterance: Utterance, rules: Sequence[Rule], change: _Change | None = None
    ) -> Utterance:
        """Number and write an utterance with all that it does; the lock is held."""
        last = self._reader.sequence
        numbered = replace(utterance, sequence=last + 1)
        change = change or _Change()
        change.replace(
            [Quad(BASE_NODE, SEQUENCE, last, BASE_GRAPH)] if last else [],
            [Quad(BASE_NODE, SEQUENCE, last + 1, BASE_GRAPH)],
        )
        change.insert += utterance_quads(numbered)
        change.insert += speaker_quads(utterance.speaker, HISTORY)
        for rule in rules:
            self._assert(change, numbered, rule)
        self._end(change, numbered.retracts, "retracted", rules)
        self._end(change, numbered.supersedes, "superseded", rules)
        self._store.apply(insert=change.insert, delete=change.delete)
        return numbered

    def _assert(self, change: _Change, utterance: Utterance, rule: Rule) -> None:
        told = replace(rule, utterance=utterance.sequence, time=utterance.time, status="active")
        before = self._store.quads(rule_mapping.rule_iri(rule.id), None, None, BELIEFS)
        change.replace(before, rule_mapping.rule_quads(told))

    def _end(
        self, change: _Change, rule_ids: Sequence[str], status: Status, new: Sequence[Rule]
    ) -> None:
        ended = [self._reader.rule(one) for one in rule_ids]
        gone = {rule.id for rule in ended}
        for rule in ended:
            change.replace(
                rule_mapping.property_quads(rule),
                rule_mapping.property_quads(replace(rule, status=status)),
            )
            change.delete.append(rule_mapping.node_edge(rule))
            for edge in rule_mapping.plain_edges(rule):
                if not self._is_asserted(edge, without=gone, new=new):
                    change.delete.append(edge)

    def _is_asserted(self, edge: Quad, *, without: set[str], new: Sequence[Rule]) -> bool:
        """Whether a rule is left that the plain edge stands for."""
        if any(edge in rule_mapping.plain_edges(rule) for rule in new):
            return True
        active = (rule_mapping.STATUS, rule_mapping.status_iri("active"))
        nodes = self._reader.nodes_with([(rule_mapping.FEATURE, edge.subject), active])
        left = (node for node in nodes if rule_mapping.rule_id(node) not in without)
        rules = self._reader.read_rules((node, self._reader.properties(node)) for node in left)
        return any(edge in rule_mapping.plain_edges(rule) for rule in rules)


def trust_quads(speaker: str, trust: Interval) -> list[Quad]:
    """The statements that say how far a speaker is trusted."""
    node = iri("speaker", speaker)
    return [
        *speaker_quads(speaker, BELIEFS),
        Quad(node, TRUST_LOWER, Decimal(str(trust.lower)), BELIEFS),
        Quad(node, TRUST_UPPER, Decimal(str(trust.upper)), BELIEFS),
    ]


def parse_trust(utterance: Utterance) -> tuple[str, Interval] | None:
    """Whom an utterance says how far to trust; None when it speaks of something else."""
    found = _TRUST.fullmatch(utterance.predicate)
    if utterance.kind != "trust" or found is None:
        return None
    return found[1], Interval(float(found[2]), float(found[3]))


def speaker_quads(speaker: str, graph: Iri) -> list[Quad]:
    """The type and name of a speaker."""
    node = iri("speaker", speaker)
    return [
        Quad(node, rule_mapping.TYPE, term("Speaker"), graph),
        Quad(node, rule_mapping.LABEL, speaker, graph),
    ]


def _now() -> datetime:
    return datetime.now(timezone.utc)


def to_milliseconds(time: datetime) -> datetime:
    """A time as precise as it is stored."""
    return time.replace(microsecond=time.microsecond // 1000 * 1000)
