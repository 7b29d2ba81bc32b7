# SPDX-License-Identifier: Apache-2.0
"""Tables and trees for the terminal: dialogue, rules, executions, decisions, query results.

Each function turns a value of the agent into something that rich can print; rich chooses colours
and width, so a pipe gets plain text. Nothing here prints.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from itertools import islice

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from ...inference.abduction import Hypothesis
from ...inference.conflicts import Conflict
from ...inference.explanation import Counterfactual
from ...inference.induction import InducedRule
from ...inference.types import Candidate
from ...kb.learned_words import Word
from ...kb.rdf.terms import Iri, Term
from ...kb.rule import Rule
from ...kb.sparql.named_queries import NamedQuery
from ...kb.sparql.results import BooleanResult as Truth
from ...kb.sparql.results import Solutions
from ...nlu.parsing.understanding import Understanding
from ...ontology.vocabulary import prefixed
from ..dialogue.reply import Reply
from ..execution.outcome import Decision, ExecutionResult, GoalResult, WalkStep
from .text import counted, printable

Quote = Callable[[int], str]  # the text of an utterance by its number
SHOWN_DIGITS = 8  # of the id of a rule; 4 are enough to name it when they are unique
MOST_ROWS = 1000  # of a query result; the layout of more takes longer than the query


def wrap_cells(table: Table) -> Table:
    """Return the table with cells that wrap, so that nothing is cut off."""
    for column in table.columns:
        column.overflow = "fold"
    return table


def turn(reply: Reply) -> RenderableType:
    """Return one turn of a dialogue: the utterance, its predicate form, and the answer."""
    grid = Table.grid(padding=(0, 2))
    grid.add_row(Text(reply.speaker.capitalize(), "bold cyan"), Text(printable(reply.text)))
    if reply.understanding.pragmatics:
        grid.add_row("", Text(reply.understanding.pragmatics, "dim"))
    grid.add_row(Text("Hilt", "bold green"), Text(printable(reply.said)))
    return wrap_cells(grid)


def understanding(found: Understanding) -> RenderableType:
    """How an utterance was understood: its derivation, predicate forms, and meaning."""
    facts = Table(show_header=False)
    for name, value in found.as_json().items():
        if name not in {"text", "speaker", "addressee"}:
            facts.add_row(name, escape(value if isinstance(value, str) else json.dumps(value)))
    return Group(Text(str(found.derivation or "")), wrap_cells(facts))


def rules(found: Iterable[Rule]) -> Table:
    """A table of rules with interval and source."""
    table = Table("id", "rule", "interval", "speaker", "utterance")
    for rule in found:
        table.add_row(
            rule.id.removeprefix("rule/")[:SHOWN_DIGITS],
            escape(rule_text(rule)),
            escape(str(rule.interval)),
            rule.speaker,
            str(rule.utterance),
        )
    table.caption = counted(table.row_count, "rule")
    return wrap_cells(table)


def rule_text(rule: Rule) -> str:
    """A rule as the paper writes it: "object:knife & action:pass => graspObject(part:blade)"."""
    left = " & ".join(str(atom) for atom in (*sorted(rule.features), *sorted(rule.contexts)))
    return f"{left} => {rule.functor}({rule.argument or ''})"


def walk(steps: Sequence[WalkStep]) -> Tree:
    """Return the executed action tree, with the four operations at each node."""
    tree = Tree("Action tree, in preorder")
    branches: dict[str, Tree] = {}
    for step in steps:
        parent, _, name = step.node.rpartition("/")
        branch = branches.get(parent, tree).add(Text(name, "bold"))
        branches[step.node] = branch
        for operation, result in _operations(step):
            branch.add(Text.assemble((f"{operation:<15}", "dim"), result))
    return tree


def _operations(step: WalkStep) -> Iterable[tuple[str, str]]:
    seen = ", ".join(f"{name} {sure:.2f}" for name, sure in step.percepts.items())
    constraint = step.constraint
    held_by = f" by the {constraint.part}" if constraint and constraint.part else ""
    concluded = (
        f"{constraint.object}{held_by} [{constraint.lower:.2f}, {constraint.upper:.2f}]"
        if constraint
        else "no constraint"
    )
    yield "getFeatures", ", ".join(step.features) or "none"
    yield "visual search", seen or ("nothing seen" if step.features else "not needed")
    yield "getAffordance", concluded
    yield "action", step.action.replace("_", " ")


def decision(made: Decision, quote: Quote) -> Table:
    """Every candidate with its interval, lambda and reason; the part below the object."""
    table = Table(
        "candidate", "interval", "lambda", "", "because", title="Decision", title_justify="left"
    )
    for candidate in made.object.candidates:
        _add_candidate(table, candidate, candidate.name, quote)
    for candidate in made.part.candidates if made.part else ():
        part = candidate.argument.name if candidate.argument else ""
        _add_candidate(table, candidate, f"  by the {part}", quote)
    return wrap_cells(table)


def _add_candidate(table: Table, candidate: Candidate, name: str, quote: Quote) -> None:
    mark = Text("yes", "green") if candidate.accepted else Text("no", "red")
    told = [
        f'{_source(rule)}: "{quote(rule.utterance)}"' for rule in candidate.rules if rule.utterance
    ]
    table.add_row(
        name,
        escape(str(candidate.interval)),
        f"{candidate.certainty:.4f}",
        mark,
        escape("\n".join((*told, candidate.reason))),
    )


def _source(rule: Rule) -> str:
    return "It is like" if rule.status == "induced" else f"{rule.speaker.capitalize()} said"


def execution_result(happened: ExecutionResult) -> Table:
    """Return what happened in the world, a line each."""
    table = Table(show_header=False, title="In the world", title_justify="left")
    if not happened.executed:
        table.add_row("executed", "no")
        return table
    table.add_row("fingers touched", ", ".join(happened.touched) or "nothing")
    table.add_row("lifted", f"{happened.lifted_m:.3f} m")
    table.add_row("held", f"{happened.held_s:.1f} s")
    table.add_row("handed over", "yes" if happened.handed_over else "no")
    table.add_row("closings of the hand", str(happened.attempts))
    return wrap_cells(table)


def goal_result(came: GoalResult, quote: Quote) -> RenderableType:
    """Return the whole result of a command: the execution, the decision, the world."""
    parts: list[RenderableType] = [walk(came.steps)]
    if came.decision and came.decision.object.candidates:
        parts.append(decision(came.decision, quote))
    parts.append(execution_result(came.world))
    return Group(*parts)


def explanation(reply: Reply, changes: Sequence[Counterfactual]) -> RenderableType:
    """A decision with its proofs, and what would change it."""
    decision = reply.achievement.decision if reply.achievement else None
    parts: list[RenderableType] = [turn(reply)]
    for inference in (decision.object, decision.part) if decision else ():
        shown = (*inference.candidates, *inference.absent) if inference else ()
        for candidate in shown:
            about = f"{candidate.name} {candidate.argument or ''}".strip()
            parts.append(Text(f"{about}: {candidate.verdict}, {candidate.reason}", "bold"))
            parts.append(Text("\n".join(f"  {line}" for line in candidate.proof.lines())))
    if changes:
        table = Table(
            "if instead of", "it were", "about", "I would choose",
            title="What would change my mind", title_justify="left",
        )  # fmt: skip
        for change in changes:
            before, after = str(change.evidence.interval), str(change.after)
            row = (before, after, change.evidence.about, change.chosen or "nothing")
            table.add_row(*map(escape, row))
        parts.append(table)
    return Group(*parts)


def conflicts(found: Sequence[Conflict]) -> RenderableType:
    """Rules that contradict each other, a pair a row."""
    table = Table("conflict", "one says", "another says", caption=counted(len(found), "conflict"))
    for each in found:
        told = (_told(each.first), _told(each.second))
        table.add_row(f"{each.weight:.4f}", *map(escape, told))
    return wrap_cells(table)


def _told(rule: Rule) -> str:
    return f"{rule_text(rule)} {rule.interval} ({rule.speaker}, utterance {rule.utterance})"


def induced(found: Sequence[InducedRule]) -> RenderableType:
    """Return rules that follow by similarity, with their reasons."""
    table = Table(
        "rule", "interval", "from", "alike", "both have", caption=counted(len(found), "rule")
    )
    for each in found:
        row = (
            rule_text(each.rule),
            str(each.rule.interval),
            rule_text(each.source),
            f"{each.similarity:.2f}",
            ", ".join(each.shared),
        )
        table.add_row(*map(escape, row))
    return wrap_cells(table)


def hypotheses(found: Sequence[Hypothesis]) -> RenderableType:
    """Return hypotheses that explain a conclusion, the likeliest first."""
    caption = counted(len(found), "hypothesis", "hypotheses")
    table = Table("if it were", "while", "then", "told by", caption=caption)
    for each in found:
        features, contexts = (
            ", ".join(sorted(map(str, s))) for s in (each.features, each.contexts)
        )
        speakers = ", ".join(sorted({rule.speaker for rule in each.rules}))
        table.add_row(features, contexts, escape(str(each.interval)), speakers)
    return wrap_cells(table)


def words(found: Sequence[Word]) -> Table:
    """Learned words with their teachers."""
    table = Table(
        "word", "is", "said as", "speaker", "utterance", caption=counted(len(found), "word")
    )
    for word in found:
        row = (word.atom.name, word.atom.kind, word.said, word.speaker, str(word.utterance))
        table.add_row(*map(escape, row))
    return wrap_cells(table)


def results(found: Solutions | Truth) -> RenderableType:
    """Return a query result: a table of rows, or yes or no."""
    if isinstance(found, Truth):
        return Text("yes" if found.value else "no")
    table = Table(*found.variables)
    for row in islice(found, MOST_ROWS):
        table.add_row(*(escape(short_term(term)) for term in row))
    count = counted(len(found), "row")
    if len(found) > MOST_ROWS:
        count += f", of which the first {MOST_ROWS} are shown; all of them: --format csv"
    return Group(wrap_cells(table), Text(count))


def short_term(term: Term | None) -> str:
    """Return a term for a table: an IRI with its prefix, a literal as its value."""
    if isinstance(term, Iri):
        return prefixed(term)
    return "" if term is None else str(term)


def questions(named: Iterable[NamedQuery]) -> Table:
    """Return a table of the named queries, with their parameters."""
    table = Table("name", "question", "--arg", box=None, pad_edge=False)
    for one in named:
        asked = "\n".join(f"{p.name}={p.kind}" for p in one.parameters.values())
        table.add_row(one.name, escape(one.question), asked)
    return wrap_cells(table)
