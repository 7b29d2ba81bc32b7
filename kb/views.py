# SPDX-License-Identifier: Apache-2.0
"""Views of the rules at an earlier time, and according to one speaker.

No rule is ever deleted, so the history can be replayed: the utterances until a moment assert,
retract and supersede rules in their order. In the view of one speaker only that speaker's
utterances count, and with full trust.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import cast

from ..ontology.errors import DataError, NotFoundError
from ..ontology.vocabulary import Iri, split
from .history import ASSERTS, HISTORY, KIND, RETRACTS, SEQUENCE, SUPERSEDES
from .interval import CERTAIN, Interval
from .rdf.rule_mapping import ATTRIBUTED_TO, GENERATED_AT, rule_id
from .reader import RuleReader
from .rule import DEFAULT_SPEAKER, Atom, Rule
from .writer import parse_trust

_DATE = re.compile(r"\d{4}-\d{2}-\d{2}")


@dataclass(frozen=True)
class RuleView:
    """The rules that were active in a view; a source of rules for inference, as a base is.

    Attributes:
        all: every rule, in the order in which they were last said.
    """

    all: tuple[Rule, ...]

    def rules(
        self,
        *,
        object: str | None = None,  # noqa: A002 - the name that it has everywhere
        affordance: str | None = None,
        context: str | None = None,
        part: str | None = None,
        speaker: str | None = None,
    ) -> list[Rule]:
        """The rules that match; arguments as for `RuleReader.rules`."""
        argument = _atom("affordance", affordance) or _atom("part", part)
        feature, action = _atom("object", object), _atom("action", context)
        return [
            rule
            for rule in self.all
            if (feature is None or feature in rule.features)
            and (action is None or action in rule.contexts)
            and (argument is None or argument == rule.argument)
            and (speaker is None or speaker == rule.speaker)
        ]

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """The rules at action-tree nodes, as `RuleReader.rules_at_nodes` gives them."""
        wanted = frozenset(nodes)
        return sorted((rule for rule in self.all if rule.node in wanted), key=lambda one: one.id)


def view(
    base: RuleReader, *, at: datetime | int | None = None, according_to: str | None = None
) -> RuleView:
    """The rules at an earlier time, or according to one speaker, or both.

    Args:
        base: reads the history.
        at: a moment, or the number of the last utterance that counts; now by default.
        according_to: the speaker whose utterances count; everybody's by default.

    Raises:
        UnknownNameError: there is no such utterance, or no utterance of that speaker.
    """
    events = _events(base)
    _check(base, events, at, according_to)
    counted = [one for one in events if _is_until(one, at)]
    active = _replayed(base, counted, according_to)
    for unexplained in _ended_elsewhere(base, events, active):
        del active[unexplained]
    found = [base.rule(one) for one in active]
    names = {rule.speaker for rule in found} if according_to is None else set[str]()
    trust = _trust(base, names, events, counted)
    rules = [
        replace(
            rule,
            utterance=active[rule.id].sequence,
            time=active[rule.id].time,
            status="active",
            trust=trust.get(rule.speaker, 1.0),
        )
        for rule in found
    ]
    return RuleView(tuple(sorted(rules, key=lambda rule: (rule.utterance or 0, rule.id))))


def parse_moment(text: str) -> datetime | int:
    """The moment that a text names.

    >>> parse_moment("12")
    12
    >>> print(parse_moment("2026-11-21T09:30:00Z"))
    2026-11-21 09:30:00+00:00

    Args:
        text: the number of an utterance, or an ISO date with or without a time. A date alone is
            the end of that day; a time without a zone is local.

    Raises:
        DataError: it is neither.
    """
    stripped = text.strip()
    if stripped.isdecimal() and len(stripped) < len("20261121"):
        return int(stripped)
    try:
        moment = datetime.fromisoformat(stripped.replace("Z", "+00:00"))
    except ValueError as error:
        problem = "expected a date, as 2026-11-21 or 2026-11-21T09:30, or the number of an"
        raise DataError(f"{problem} utterance.", source=text) from error
    if _DATE.fullmatch(stripped):
        moment += timedelta(days=1, milliseconds=-1)
    return moment if moment.tzinfo else moment.astimezone()


@dataclass
class _Event:
    """The effects of an utterance."""

    sequence: int
    time: datetime
    speaker: str
    is_trust: bool
    asserts: list[str]
    ends: list[str]


def _events(base: RuleReader) -> list[_Event]:
    """The effects of all utterances in their order, by one scan for each property."""
    links = {key: _objects(base, key) for key in (ASSERTS, RETRACTS, SUPERSEDES)}
    once = {key: _objects(base, key) for key in (GENERATED_AT, ATTRIBUTED_TO, KIND)}
    found = [
        _Event(
            cast(int, number),
            cast(datetime, once[GENERATED_AT][node][0]),
            split(cast(Iri, once[ATTRIBUTED_TO][node][0]))[1],
            once[KIND][node] == ["trust"],
            _rules(links[ASSERTS][node]),
            _rules(links[RETRACTS][node] + links[SUPERSEDES][node]),
        )
        for node, (number, *_) in _objects(base, SEQUENCE).items()
    ]
    return sorted(found, key=lambda one: (one.time, one.sequence))


def _objects(base: RuleReader, key: Iri) -> defaultdict[Iri, list[object]]:
    found: defaultdict[Iri, list[object]] = defaultdict(list)
    for quad in base.store.quads(None, key, None, HISTORY):
        found[quad.subject].append(quad.object)
    return found


def _rules(nodes: list[object]) -> list[str]:
    return [rule_id(cast(Iri, node)) for node in nodes]


def _ended_elsewhere(
    base: RuleReader, events: list[_Event], active: dict[str, _Event]
) -> list[str]:
    """The rules among these that are inactive now although no utterance of this base ended them.

    They came with a file or another base where they were retracted at an unknown time.
    """
    finally_active = _replayed(base, events, None)
    return [one for one in active if one in finally_active and base.rule(one).status != "active"]


def _check(
    base: RuleReader, events: list[_Event], at: datetime | int | None, according_to: str | None
) -> None:
    last = max((one.sequence for one in events), default=0)
    if isinstance(at, int) and not 0 <= at <= last:
        raise NotFoundError("utterance", str(at), [f"0 to {last}"])
    speakers = {one.speaker for one in events}
    if according_to is None or according_to in speakers:
        return
    if not base.rules(speaker=according_to, status=None):
        raise NotFoundError("speaker", according_to, speakers)


def _is_until(one: _Event, at: datetime | int | None) -> bool:
    if at is None:
        return True
    return one.sequence <= at if isinstance(at, int) else one.time <= at


def _replayed(
    base: RuleReader, events: list[_Event], according_to: str | None
) -> dict[str, _Event]:
    """The ids of the rules that are active after the events, with the last event of each."""
    active: dict[str, _Event] = {}
    for one in events:
        if according_to is None or one.speaker == according_to:
            for ended in one.ends:
                active.pop(ended, None)
        for asserted in one.asserts:
            if according_to is None or base.rule(asserted).speaker == according_to:
                active[asserted] = one
    return active


def _trust(
    base: RuleReader, speakers: set[str], events: list[_Event], counted: list[_Event]
) -> dict[str, float]:
    """The trust in each speaker after the counted events.

    A trust that no utterance set came with a merged base, and is taken as it is now.
    """
    ever, then = (dict(_trust_settings(base, some)) for some in (events, counted))
    found: dict[str, float] = {}
    for name in speakers:
        start = CERTAIN if name == DEFAULT_SPEAKER else Interval(0, 0)
        now = base.trust(name) or Interval(0, 0)
        found[name] = then.get(name, start if name in ever else now).lower
    return found


def _trust_settings(base: RuleReader, events: list[_Event]) -> Iterator[tuple[str, Interval]]:
    for one in events:
        if one.is_trust and (found := parse_trust(base.utterance(one.sequence))):
            yield found


def _atom(kind: str, name: str | None) -> Atom | None:
    return Atom(kind, name) if name is not None else None
