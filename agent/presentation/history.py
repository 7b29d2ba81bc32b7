# SPDX-License-Identifier: Apache-2.0
"""Tables for the history: utterances, changes, differences, merges, episodes.

As in `console`, each function turns a value into something that rich can print.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from ...kb.diff import BaseDifference, RuleChange
from ...kb.episodes import Episode
from ...kb.history import Utterance
from ...kb.interval import Interval
from ...kb.rule import Rule
from .console import Quote, conflicts, goal_result, rule_text, wrap_cells
from .text import counted, printable

if TYPE_CHECKING:
    from ..merge_report import MergeReport
    from ..replay import Replay


def history(found: Sequence[Utterance]) -> Table:
    """Utterances with their effect, a row each."""
    table = Table("", "when", "who", "said", "did", caption=counted(len(found), "utterance"))
    for said in found:
        when = said.time.astimezone().strftime("%Y-%m-%d %H:%M:%S")
        row = (str(said.sequence), when, said.speaker, printable(said.text), _effect(said))
        table.add_row(*map(escape, row))
    return wrap_cells(table)


def change(found: RuleChange) -> RenderableType:
    """One utterance as it happens, with the rules that it touched below."""
    said = found.utterance
    head = Text.assemble(
        (f"{said.sequence} ", "dim"), (said.speaker, "bold cyan"), f": {printable(said.text)}"
    )
    told = (("+", "green", found.told), ("-", "red", found.retracted + found.superseded))
    lines = [Text(f"  {mark} {_weighed(r)}", style) for mark, style, rules in told for r in rules]
    return Group(head, *lines)


def difference(found: BaseDifference) -> RenderableType:
    """Return the difference of two bases, as the lines of a patch."""
    lines = list(_lines(found))
    return Group(*lines) if lines else Text("They believe the same.")


def episodes(found: Sequence[Episode]) -> Table:
    """Return a table of episodes, a row each."""
    table = Table(
        "id", "when", "who", "said", "came", "chosen", caption=counted(len(found), "episode")
    )
    for one in found:
        when = one.time.astimezone().strftime("%Y-%m-%d %H:%M:%S") if one.time else ""
        chosen = " by the ".join(filter(None, (one.object, one.part)))
        table.add_row(*map(escape, (one.id, when, one.speaker, one.text, one.outcome, chosen)))
    return wrap_cells(table)


def replay_result(came: Replay, quote: Quote) -> RenderableType:
    """Return the result of a replay, and whether it equals the recorded one."""
    lines: list[RenderableType] = [Text(came.episode.text, "bold"), Text(str(came.after["said"]))]
    if came.achievement.steps:
        lines.append(goal_result(came.achievement, quote))
    state = came.after["state"] or "nothing moved"
    told = f"The same as in {came.episode.id}, bit for bit (state of the world: {state})."
    lines += [Text(each, "red") for each in came.differences] or [Text(told, "green")]
    return Group(*lines)


def merge_result(report: MergeReport) -> RenderableType:
    """Return the result of a merge: numbers, conflicts, and rules of different status."""
    came = report.summary
    done = "Would take over" if report.dry_run else "Took over"
    lines: list[RenderableType] = [
        Text(f"{done} {counted(came.new, 'rule')} ({came.known} known already) "
             f"and {counted(came.utterances, 'utterance')}.")
    ]  # fmt: skip
    if came.untrusted:
        lines.append(Text(f"Nobody trusts {', '.join(came.untrusted)}; their rules weigh nothing."))
    if report.conflicts:
        lines.append(conflicts(report.conflicts))
    lines += (
        Text(f"{rule_text(rule)}: {rule.status} in the other; stays as it is here.")
        for rule in report.kept
    )
    return Group(*lines)


def _effect(said: Utterance) -> str:
    counts = (
        ("told", said.asserts), ("took back", said.retracts), ("replaced", said.supersedes),
    )  # fmt: skip
    done = ", ".join(f"{verb} {len(ids)}" for verb, ids in counts if ids)
    return done or (said.kind if said.accepted else f"{said.kind}, not accepted")


def _lines(found: BaseDifference) -> Iterator[Text]:
    yield from _marked("- ", "red", map(_weighed, found.removed))
    yield from _marked("+ ", "green", map(_weighed, found.added))
    for each in found.altered:
        was, now = (_state(rule) for rule in (each.before, each.after))
        about = f"{rule_text(each.after)} ({each.after.speaker})"
        yield Text(f"~ {about}: {was} -> {now}", "yellow")
    for speaker, before, after in found.trust:
        yield Text(f"~ trust in {speaker}: {_shown(before)} -> {_shown(after)}", "yellow")
    yield from _marked("- word ", "red", (word.atom.name for word in found.words_removed))
    yield from _marked("+ word ", "green", (word.atom.name for word in found.words_added))


def _marked(mark: str, style: str, texts: Iterable[str]) -> Iterator[Text]:
    return (Text(f"{mark}{text}", style) for text in texts)


def _weighed(rule: Rule) -> str:
    return f"{rule_text(rule)} {rule.interval} ({rule.speaker})"


def _state(rule: Rule) -> str:
    return str(rule.interval) if rule.status == "active" else rule.status


def _shown(trust: Interval | None) -> str:
    return str(trust) if trust else "none"
