"""Views of the rules at an earlier time, and according to one speaker.

No rule is ever deleted, so the history can be replayed: the utterances until a moment assert,
retract and supersede rules in their order. In the view of one speaker only that speaker's
utterances count, and with full trust.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

from ..ontology.errors import DataError, NotFoundError
from ..ontology.vocabulary import split
from .history import HISTORY, Utterance, parse_trust, read_utterance
from .interval import CERTAIN, Interval
from .reader import RuleReader, atom_named
from .rule import DEFAULT_SPEAKER, Rule
from .stores.base import described_nodes

_DATE = re.compile(r"\d{4}-\d{2}-\d{2}")


@dataclass(frozen=True)
class RuleView:
    """The rules that held at some time or for one speaker, in the order they were last said.

    It is a source of rules that never changes, and so is its `sequence`.
    """

    all: tuple[Rule, ...]
    sequence: int = 0

    def rules(
        self,
        *,
        object: str | None = None,
        affordance: str | None = None,
        context: str | None = None,
        part: str | None = None,
        speaker: str | None = None,
    ) -> list[Rule]:
        """The rules that match; arguments as for `RuleReader.rules`."""
        argument = atom_named("affordance", affordance) or atom_named("part", part)
        feature, action = atom_named("object", object), atom_named("action", context)
        return [
            rule
            for rule in self.all
            if (feature is None or feature in rule.features)
            and (action is None or action in rule.contexts)
            and argument in (None, rule.argument)
            and speaker in (None, rule.speaker)
        ]

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """The rules at action-tree nodes, as `RuleReader.rules_at_nodes` gives them."""
        wanted = frozenset(nodes)
        return sorted((rule for rule in self.all if rule.node in wanted), key=lambda one: one.id)


def view(
    base: RuleReader, *, at: datetime | int | None = None, according_to: str | None = None
) -> RuleView:
    """The rules at an earlier time, or according to one speaker, or both.

    `at` is a moment, or the number of the last utterance that counts; now by default. Only the
    utterances of the speaker `according_to` count; everybody's by default. UnknownNameError if
    there is no such utterance, or no utterance of that speaker.
    """
    events = _utterances(base)
    _check(base, events, at, according_to)
    counted = [one for one in events if at is None or _is_until(one, at)]
    active, finally_active = _replayed(base, counted, according_to), _replayed(base, events, None)
    # A rule that is inactive now although no utterance of this base ended it came with a file or
    # another base, where it was retracted at an unknown time.
    found = [
        rule
        for rule in map(base.rule, active)
        if rule.status == "active" or rule.id not in finally_active
    ]
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
    """The moment that a text names; DataError if it names none.

    >>> parse_moment("12")
    12
    >>> print(parse_moment("2026-11-21T09:30:00Z"))
    2026-11-21 09:30:00+00:00

    Args:
        text: the number of an utterance, or an ISO date with or without a time. A date alone is
            the end of that day; a time without a zone is local.
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


def _utterances(base: RuleReader) -> list[Utterance]:
    nodes = described_nodes(base.store, HISTORY)
    found = (read_utterance(some) for node, some in nodes if split(node)[0] == "utterance")
    return sorted(found, key=lambda one: (one.time, one.sequence))


def _check(
    base: RuleReader, events: list[Utterance], at: datetime | int | None, according_to: str | None
) -> None:
    last = max((one.sequence for one in events), default=0)
    if isinstance(at, int) and not 0 <= at <= last:
        raise NotFoundError("utterance", str(at), [f"0 to {last}"])
    speakers = {one.speaker for one in events}
    if according_to is None or according_to in speakers:
        return
    if not base.rules(speaker=according_to, status=None):
        raise NotFoundError("speaker", according_to, speakers)


def _is_until(one: Utterance, at: datetime | int) -> bool:
    return one.sequence <= at if isinstance(at, int) else one.time <= at


def _replayed(
    base: RuleReader, events: list[Utterance], according_to: str | None
) -> dict[str, Utterance]:
    active: dict[str, Utterance] = {}
    for one in events:
        if according_to is None or one.speaker == according_to:
            for ended in (*one.retracts, *one.supersedes):
                active.pop(ended, None)
        for asserted in one.asserts:
            if according_to is None or base.rule(asserted).speaker == according_to:
                active[asserted] = one
    return active


def _trust(
    base: RuleReader, speakers: set[str], events: list[Utterance], counted: list[Utterance]
) -> dict[str, float]:
    ever, then = (dict(filter(None, map(parse_trust, some))) for some in (events, counted))
    found: dict[str, float] = {}
    for name in speakers:
        start = CERTAIN if name == DEFAULT_SPEAKER else Interval(0, 0)
        now = base.trust(name) or Interval(0, 0)
        found[name] = then.get(name, start if name in ever else now).lower
    return found
