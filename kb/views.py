# SPDX-License-Identifier: Apache-2.0
"""The rules as they were at some time, and as one person sees them.

Nothing is ever deleted, so the history can be gone through again: what was said until a moment
asserts, takes back and supersedes rules, in the order in which it was said. In one person's view
only that person's sentences count, and they count whole: nobody distrusts himself.
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
    """Rules that held somewhere in the history; inference can be asked about them as about a base.

    Attributes:
        all: every rule that held, in the order in which they were last told.
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
        """Those that match, as `RuleReader.rules` has it."""
        argument = _atom("affordance", affordance) or _atom("part", part)
        seen, done = _atom("object", object), _atom("action", context)
        return [
            rule
            for rule in self.all
            if (seen is None or seen in rule.features)
            and (done is None or done in rule.contexts)
            and (argument is None or argument == rule.argument)
            and (speaker is None or speaker == rule.speaker)
        ]

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """Those that hang on action-tree nodes, as `RuleReader.rules_at_nodes` has it."""
        wanted = frozenset(nodes)
        return sorted((rule for rule in self.all if rule.node in wanted), key=lambda one: one.id)


def view(
    base: RuleReader, *, at: datetime | int | None = None, according_to: str | None = None
) -> RuleView:
    """The rules as they were, or as one person sees them, or both.

    Args:
        base: where the history is.
        at: a moment, or the number of the last utterance that counts; now by default.
        according_to: whose sentences count; everybody's by default.

    Raises:
        UnknownNameError: there is no such utterance, or nobody of that name said anything.
    """
    said = _said(base)
    _check(base, said, at, according_to)
    heard = [one for one in said if _is_until(one, at)]
    held = _replayed(base, heard, according_to)
    for unexplained in _ended_elsewhere(base, said, held):
        del held[unexplained]
    told = [base.rule(one) for one in held]
    names = {rule.speaker for rule in told} if according_to is None else set[str]()
    trust = _trust(base, names, said, heard)
    rules = [
        replace(
            rule,
            utterance=held[rule.id].sequence,
            time=held[rule.id].time,
            status="active",
            trust=trust.get(rule.speaker, 1.0),
        )
        for rule in told
    ]
    return RuleView(tuple(sorted(rules, key=lambda rule: (rule.utterance or 0, rule.id))))


def parse_moment(text: str) -> datetime | int:
    """A moment as a person writes it.

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
    said = text.strip()
    if said.isdecimal() and len(said) < len("20261121"):
        return int(said)
    try:
        moment = datetime.fromisoformat(said.replace("Z", "+00:00"))
    except ValueError as error:
        problem = "expected a date, as 2026-11-21 or 2026-11-21T09:30, or the number of an"
        raise DataError(f"{problem} utterance.", source=text) from error
    if _DATE.fullmatch(said):
        moment += timedelta(days=1, milliseconds=-1)
    return moment if moment.tzinfo else moment.astimezone()


@dataclass
class _Said:
    """What an utterance did, as far as a view needs it."""

    sequence: int
    time: datetime
    speaker: str
    is_trust: bool
    asserts: list[str]
    ends: list[str]


def _said(base: RuleReader) -> list[_Said]:
    """All utterances in their order; one scan for each property, so that it is cheap anywhere."""
    links = {key: _objects(base, key) for key in (ASSERTS, RETRACTS, SUPERSEDES)}
    once = {key: _objects(base, key) for key in (GENERATED_AT, ATTRIBUTED_TO, KIND)}
    found = [
        _Said(
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


def _ended_elsewhere(base: RuleReader, said: list[_Said], held: dict[str, _Said]) -> list[str]:
    """The rules among these that do not hold now although nothing that was said here ended them.

    They came with a file or another base, where they were taken back; when is not known.
    """
    in_the_end = _replayed(base, said, None)
    return [one for one in held if one in in_the_end and base.rule(one).status != "active"]


def _check(
    base: RuleReader, said: list[_Said], at: datetime | int | None, according_to: str | None
) -> None:
    last = max((one.sequence for one in said), default=0)
    if isinstance(at, int) and not 0 <= at <= last:
        raise NotFoundError("utterance", str(at), [f"0 to {last}"])
    speakers = {one.speaker for one in said}
    if according_to is None or according_to in speakers:
        return
    if not base.rules(speaker=according_to, status=None):
        raise NotFoundError("speaker", according_to, speakers)


def _is_until(one: _Said, at: datetime | int | None) -> bool:
    if at is None:
        return True
    return one.sequence <= at if isinstance(at, int) else one.time <= at


def _replayed(base: RuleReader, heard: list[_Said], according_to: str | None) -> dict[str, _Said]:
    """The ids of the rules that held in the end, with what said each of them last."""
    held: dict[str, _Said] = {}
    for one in heard:
        if according_to is None or one.speaker == according_to:
            for gone in one.ends:
                held.pop(gone, None)
        for told in one.asserts:
            if according_to is None or base.rule(told).speaker == according_to:
                held[told] = one
    return held


def _trust(
    base: RuleReader, speakers: set[str], said: list[_Said], heard: list[_Said]
) -> dict[str, float]:
    """How far each speaker was trusted.

    Whom nobody ever spoke of is trusted as now: that came with a base that was taken over.
    """
    ever, then = (dict(_trusts(base, some)) for some in (said, heard))
    return {name: _then(base, name, ever, then).lower for name in speakers}


def _then(
    base: RuleReader, name: str, ever: dict[str, Interval], then: dict[str, Interval]
) -> Interval:
    start = CERTAIN if name == DEFAULT_SPEAKER else Interval(0, 0)
    now = base.trust(name) or Interval(0, 0)
    return then.get(name, start if name in ever else now)


def _trusts(base: RuleReader, said: list[_Said]) -> Iterator[tuple[str, Interval]]:
    for one in said:
        if one.is_trust:
            found = parse_trust(base.utterance(one.sequence))
            if found:
                yield found


def _atom(kind: str, name: str | None) -> Atom | None:
    return Atom(kind, name) if name is not None else None
