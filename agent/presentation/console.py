"""Tables and trees for the terminal: dialogue, rules, decisions, query results, history, imports.

Each function turns a value of the agent into something that rich can print, plain for a pipe.
"""

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from datetime import datetime
from itertools import islice
from operator import attrgetter
from typing import TYPE_CHECKING, Any, cast

from rich.console import Console, Group, RenderableType
from rich.markup import escape
from rich.progress import BarColumn, Progress, ProgressColumn
from rich.table import Column, Table
from rich.text import Text
from rich.tree import Tree

from ...inference.explanation import rejection_reason
from ...kb.rdf.terms import Iri
from ...kb.sparql.results import BooleanResult, SelectResult
from ...nlu.generation.templates import proper_name
from ...ontology.vocabulary import prefixed
from .plain_text import counted, printable

if TYPE_CHECKING:
    from ...inference.experience import GraspRecord, TeacherRecord
    from ...inference.explanation import Counterfactual
    from ...inference.induction import InducedRule
    from ...inference.rule_analysis import Conflict, Hypothesis
    from ...inference.types import Candidate
    from ...kb.bulk.reconciliation import ImportSummary
    from ...kb.episodes import Episode
    from ...kb.history import Utterance
    from ...kb.learned import LearnedPhrase, LearnedWord, TaughtAction
    from ...kb.rule import Rule
    from ...kb.sparql.named_queries import NamedQuery
    from ...kb.views import BaseDifference, UtteranceChanges
    from ...nlu.parsing.understanding import Understanding
    from ..dialogue.reply import Reply
    from ..execution.outcome import Decision, GoalResult, WalkStep, WorldOutcome
    from ..replay import ReplayResult
    from ..speech.listening import Heard

Quote = Callable[[int], str]  # the text of an utterance by its number
SHOWN_DIGITS = 8  # of the id of a rule; 4 are enough to name it when they are unique
MOST_ROWS = 1000  # of a query result; the layout of more takes longer than the query


def grid(rows: Iterable[Iterable[Text | str]]) -> Table:
    """Return rows of plain texts in columns without borders, of which nothing is cut off."""
    table = Table.grid(padding=(0, 2))
    for row in rows:
        table.add_row(*(Text(cell) if isinstance(cell, str) else cell for cell in row))
    for column in table.columns:
        column.overflow = "fold"
    return table


def table(
    columns: Sequence[str], rows: Iterable[Iterable[object]], *counts: str, **more: Any
) -> Table:
    """Return a table of texts; `counts` is the noun of its rows, and its plural if irregular.

    Times are shown as those of this place, and sets in alphabetical order.
    """
    found = Table(*(Column(each, overflow="fold") for each in columns), **more)
    for row in rows:
        found.add_row(*map(_cell, row))
    if counts:
        found.caption = counted(found.row_count, *counts)
    return found


def progress_bar(out: Console | None, *columns: ProgressColumn | str) -> Progress:
    """Return a bar that vanishes when all is done, and that shows nothing but on a terminal."""
    quiet = out is None or not out.is_terminal
    # Few refreshes: more take time that the work needs.
    options: dict[str, Any] = {"transient": True, "refresh_per_second": 4, "disable": quiet}
    return Progress("{task.description}", BarColumn(), *columns, console=out, **options)


def yes_or_no(is_so: bool) -> Text:
    """Return whether something is so, in a word and a colour."""
    return Text("yes", "green") if is_so else Text("no", "red")


def _cell(value: object) -> Text | str:
    if isinstance(value, Text):
        return value
    if isinstance(value, datetime):
        return value.astimezone().strftime("%Y-%m-%d %H:%M:%S")
    if isinstance(value, frozenset):
        return escape(", ".join(sorted(map(str, cast("frozenset[object]", value)))))
    return "" if value is None else escape(str(value))


def turn(reply: "Reply") -> RenderableType:
    """Return one turn of a dialogue: the utterance, its predicate form, and the answer."""
    said = (Text(proper_name(reply.speaker), "bold cyan"), printable(reply.text))
    meant = ("", Text(reply.understanding.pragmatics, "dim"))
    answer = (Text("Hilt", "bold green"), printable(reply.said))
    return grid((said, meant, answer) if meant[1] else (said, answer))


def heard(found: "Heard") -> RenderableType:
    """What may have been said, best first, with the certainty of each text."""
    rows = ((each.text, f"{each.score:.2f}") for each in found.alternatives)
    return table(("text", "certainty"), rows)


def understanding(found: "Understanding") -> RenderableType:
    """How an utterance was understood: its derivation, predicate forms, features, and meaning."""
    features = found.reading.features.as_json() if found.reading else {}
    facts = (
        (name, value if isinstance(value, str) else json.dumps(value))
        for name, value in {**found.as_json(), "features": features}.items()
        if name not in {"text", "speaker", "addressee"}
    )
    return Group(Text(str(found.derivation or "")), table(("", ""), facts, show_header=False))


def rules(found: "Iterable[Rule]") -> Table:
    """A table of rules with interval and source."""
    ids = ((rule, rule.id.removeprefix("rule/")[:SHOWN_DIGITS]) for rule in found)
    rows = ((id_, rule_text(r), r.interval, r.speaker, r.utterance) for r, id_ in ids)
    return table(("id", "rule", "interval", "speaker", "utterance"), rows, "rule")


def sentences(found: "Iterable[Rule]", describe: "Callable[[Rule], str]") -> RenderableType:
    """Return rules as sentences with who told them; `describe` puts a rule in words."""
    told = [(describe(rule), Text(proper_name(rule.speaker), "dim")) for rule in found]
    rows = ((f"{said[:1].upper()}{said[1:]}.", speaker) for said, speaker in told)
    return grid(rows) if told else Text("Nobody has told me anything yet.")


def rule_text(rule: "Rule") -> str:
    """A rule as the paper writes it: "object:knife & action:pass => graspObject(part:blade)"."""
    left = " & ".join(str(atom) for atom in (*sorted(rule.features), *sorted(rule.contexts)))
    return f"{left} => {rule.functor}({rule.argument or ''})"


def walk(steps: "Sequence[WalkStep]") -> Tree:
    """Return the executed action tree, with the four operations at each node."""
    tree = Tree("Action tree, in preorder")
    branches: dict[str, Tree] = {}
    for step in steps:
        parent, _, name = step.node.rpartition("/")
        branch = branches.get(parent, tree).add(Text(name, "bold"))
        branches[step.node] = branch
        seen = ", ".join(f"{name} {sure:.2f}" for name, sure in step.percepts.items())
        bound = step.constraint
        what = f"{_by_part(bound.object, bound.part)} {bound.interval}" if bound else ""
        operations = {
            "getFeatures": ", ".join(step.features) or "none",
            "visual search": seen or ("nothing seen" if step.features else "not needed"),
            "getAffordance": what or "no constraint",
            "action": step.action.replace("_", " "),
        }
        for operation, result in operations.items():
            branch.add(Text.assemble((f"{operation:<15}", "dim"), result))
    return tree


def _by_part(name: str | None, part: str | None) -> str:
    return " by the ".join(filter(None, (name, part)))


def decision(made: "Decision", quote: Quote) -> Table:
    """Every candidate with its interval, lambda and reason; the part below the object."""

    def row(each: "Candidate", name: str) -> tuple[object, ...]:
        because = "\n".join((*_told_by(each, quote), each.reason))
        return name, each.interval, f"{each.certainty:.4f}", yes_or_no(each.accepted), because

    parts = made.part.candidates if made.part else ()
    rows = [row(each, each.name) for each in made.object.candidates]
    rows += [row(p, f"  by the {p.argument.name if p.argument else ''}") for p in parts]
    columns = ("candidate", "interval", "lambda", "", "because")
    return table(columns, rows, title="Decision", title_justify="left")


def reasons(made: "Decision", quote: Quote) -> Table:
    """Return why each candidate was chosen, or was not, in words without figures."""
    rows: list[tuple[str, str]] = []
    for node, wording in zip(made.inferences, ("the {}", "by the {}"), strict=False):
        for each in node.candidates:
            name = each.argument.name if node is made.part and each.argument else each.name
            mark = "" if each is node.best else "not "
            is_named = each.accepted and each.argument is None
            why = "that is what was asked for" if is_named else rejection_reason(node, each)
            rows.append((mark + wording.format(name), "\n".join([*_told_by(each, quote)] or [why])))
    return grid(rows)


def _told_by(candidate: "Candidate", quote: Quote) -> Iterator[str]:
    for rule in candidate.rules:
        who = "It is like" if rule.status == "induced" else f"{proper_name(rule.speaker)} said"
        if rule.utterance:
            yield f'{who}: "{quote(rule.utterance)}"'


def execution_result(happened: "WorldOutcome") -> Table:
    """Return what happened in the world, a line each."""
    lines = {
        "fingers touched": ", ".join(happened.touched) or "nothing",
        "lifted": f"{happened.lifted_m:.3f} m",
        "held": f"{happened.held_s:.1f} s",
        "handed over": "yes" if happened.handed_over else "no",
        "closings of the hand": str(happened.attempts),
    }
    rows = (lines if happened.executed else {"executed": "no"}).items()
    return table(("", ""), rows, show_header=False, title="In the world", title_justify="left")


def goal_result(result: "GoalResult", quote: Quote) -> RenderableType:
    """Return the whole result of a command: the execution, the decision, the world."""
    parts: list[RenderableType] = [walk(result.steps)]
    if result.decision and result.decision.object.candidates:
        parts.append(decision(result.decision, quote))
    parts.append(execution_result(result.world))
    return Group(*parts)


def explanation(
    reply: "Reply", changes: "Sequence[Counterfactual]", describe: "Callable[[Rule], str]"
) -> RenderableType:
    """A decision with its proofs, and what would change it; `describe` puts a norm in words."""
    parts: list[RenderableType] = [turn(reply)]
    for verdict in reply.result.verdicts if reply.result else ():
        for each in verdict.conflicts:
            norms = (f'"{describe(norm)}"' for norm in (each.prevailing, each.overruled))
            parts.append(Text(f"{' prevails over '.join(norms)}: it is {each.reason}"))
        if verdict.forbidding and verdict.proof:
            parts.append(Text(f'forbidden: "{describe(verdict.forbidding)}"', "bold"))
            parts.append(Text("\n".join(f"  {line}" for line in verdict.proof.lines())))
    for about, proof in reply.decision.explained() if reply.decision else ():
        parts += [Text(about, "bold"), Text("\n".join(proof))]
    if changes:
        cells = attrgetter("evidence.interval", "after", "evidence.about", "chosen")
        rows = ((*before, chosen or "nothing") for *before, chosen in map(cells, changes))
        columns = ("if instead of", "it were", "about", "I would choose")
        parts.append(table(columns, rows, title="What would change my mind", title_justify="left"))
    return Group(*parts)


def conflicts(found: "Sequence[Conflict]") -> RenderableType:
    """Rules that contradict each other, a pair a row."""
    rows = ((f"{c.weight:.4f}", _told(c.first), _told(c.second)) for c in found)
    return table(("conflict", "one says", "another says"), rows, "conflict")


def _told(rule: "Rule") -> str:
    return f"{rule_text(rule)} {rule.interval} ({rule.speaker}, utterance {rule.utterance})"


def induced(found: "Sequence[InducedRule]") -> RenderableType:
    """Return rules that follow by similarity, with their reasons."""
    alike = ((each, f"{each.similarity:.2f}", ", ".join(each.shared)) for each in found)
    rows = ((rule_text(i.rule), i.rule.interval, rule_text(i.source), *more) for i, *more in alike)
    return table(("rule", "interval", "from", "alike", "both have"), rows, "rule")


def hypotheses(found: "Sequence[Hypothesis]") -> RenderableType:
    """Return hypotheses that explain a conclusion, the likeliest first."""
    told = ((each, frozenset(rule.speaker for rule in each.rules)) for each in found)
    rows = ((each.features, each.contexts, each.interval, speakers) for each, speakers in told)
    return table(("if it were", "while", "then", "told by"), rows, "hypothesis", "hypotheses")


def words(found: "Sequence[LearnedWord | LearnedPhrase]") -> Table:
    """Learned words and phrases with their teachers."""
    keys = ("word", "kind", "said", "speaker", "utterance")
    rows = ([each[key] for key in keys] for each in (one.as_json() for one in found))
    return table(("word", "is", "said as", "speaker", "utterance"), rows, "entry", "entries")


def actions(found: "Sequence[TaughtAction]") -> Table:
    """Taught actions with what taught them and their teachers."""
    rows = map(attrgetter("name", "said", "speaker", "utterance"), found)
    return table(("action", "said as", "speaker", "utterance"), rows, "action", "actions")


def results(found: SelectResult | BooleanResult) -> RenderableType:
    """Return a query result: a table of rows, or yes or no."""
    if isinstance(found, BooleanResult):
        return Text("yes" if found.value else "no")
    shown = ([prefixed(t) if isinstance(t, Iri) else t for t in row] for row in found)
    rows = table(found.variables, islice(shown, MOST_ROWS))
    count = counted(len(found), "row")
    if len(found) > MOST_ROWS:
        count += f", of which the first {MOST_ROWS} are shown; all of them: --format csv"
    return Group(rows, Text(count))


def questions(named: "Iterable[NamedQuery]") -> Table:
    """Return a table of the named queries, with their parameters."""
    rows = (
        (one.name, one.question, "\n".join(f"{p.name}={p.kind}" for p in one.parameters.values()))
        for one in named
    )
    return table(("name", "question", "--arg"), rows, box=None, pad_edge=False)


def history(found: "Sequence[Utterance]") -> Table:
    """Utterances with their effect, a row each."""
    rows = ((u.sequence, u.time, u.speaker, printable(u.text), _effect(u)) for u in found)
    return table(("", "when", "who", "said", "did"), rows, "utterance")


def change(found: "UtteranceChanges") -> RenderableType:
    """One utterance as it happens, with the rules that it touched below."""
    said = found.utterance
    head = Text.assemble(
        (f"{said.sequence} ", "dim"), (said.speaker, "bold cyan"), f": {printable(said.text)}"
    )
    told = (("+", "green", found.told), ("-", "red", found.retracted + found.superseded))
    lines = [Text(f"  {mark} {_weighed(r)}", style) for mark, style, rules in told for r in rules]
    return Group(head, *lines)


def difference(found: "BaseDifference") -> RenderableType:
    """Return the difference of two bases, as the lines of a patch."""
    lines = [
        *((f"- {_weighed(rule)}", "red") for rule in found.removed),
        *((f"+ {_weighed(rule)}", "green") for rule in found.added),
        *(
            (f"~ {rule_text(now)} ({now.speaker}): {_state(was)} -> {_state(now)}", "yellow")
            for was, now in ((each.before, each.after) for each in found.altered)
        ),
        *(
            (f"~ trust in {speaker}: {was or 'none'} -> {now or 'none'}", "yellow")
            for speaker, was, now in found.trust
        ),
        *((f"- word {word.atom.name}", "red") for word in found.words_removed),
        *((f"+ word {word.atom.name}", "green") for word in found.words_added),
    ]
    return Group(*(Text(*line) for line in lines)) if lines else Text("They believe the same.")


def episodes(found: "Sequence[Episode]") -> Table:
    """Return a table of episodes, a row each."""
    chosen = ((one, _by_part(one.object, one.part)) for one in found)
    rows = ((one.id, one.time, one.speaker, one.text, one.outcome, it) for one, it in chosen)
    return table(("id", "when", "who", "said", "outcome", "chosen"), rows, "episode")


def experience(found: "Sequence[GraspRecord]") -> Table:
    """Return a table of what grasps came to, a row for each object, part, action and robot."""
    cells = attrgetter("object", "part", "context", "robot", "counts", "counts.interval")
    columns = ("object", "part", "to", "robot", "outcomes", "holds")
    return table(columns, map(cells, found), "record")


def teachers(found: "Sequence[TeacherRecord]") -> Table:
    """Return a table of what the record says about each speaker."""
    trust = ((one, f"{one.trust:g}", f"{one.suggested:.2f}") for one in found)
    rows = ((one.speaker, now, one.counts, one.counts.interval, to) for one, now, to in trust)
    return table(("who", "trust", "grasps as told", "holds", "suggested"), rows, "teacher")


def replay_result(found: "ReplayResult", quote: Quote) -> RenderableType:
    """Return the result of a replay, and whether it equals the recorded one."""
    shown: list[RenderableType] = [Text(found.episode.text, "bold")]
    shown.append(Text(str(found.repeated["said"])))
    if found.result.steps:
        shown.append(goal_result(found.result, quote))
    state = found.repeated["state"] or "nothing moved"
    same = f"The same as in {found.episode.id}, bit for bit (state of the world: {state})."
    shown += [Text(each, "red") for each in found.differences] or [Text(same, "green")]
    return Group(*shown)


def import_summary(found: "ImportSummary", source: str, *, dry_run: bool) -> RenderableType:
    """What came from a file or another base: numbers, conflicts, what was not taken."""
    read = f"{'Would read' if dry_run else 'Read'} {counted(found.new + found.known, 'rule')}"
    known = f"{found.known} already known, {found.conflicting} conflicting"
    lines = [f"{read} from {source}: {found.new} new, {known}."]
    lines += [f"  {e.new} contradicts {e.believed}: {e.weight:.4f}" for e in found.conflicts]
    if found.conflicting > len(found.conflicts):
        lines.append(f"  ... and {found.conflicting - len(found.conflicts)} more")
    lines += [f"{rule_text(r)}: {r.status} in {source}; stays as it is here." for r in found.kept]
    left = ((counted(number, "statement"), what) for what, number in found.not_taken.items())
    lines += [f"Not taken: {statements} with {what}." for statements, what in left]
    if found.untrusted:
        doubt = f"Nobody trusts {', '.join(found.untrusted)}, so what they say weighs nothing."
        lines.append(f"{doubt} Run: hilt trust NAME DEGREE")
    return Text("\n".join(lines))


def _effect(said: "Utterance") -> str:
    counts = {"told": said.asserts, "took back": said.retracts, "replaced": said.supersedes}
    done = ", ".join(f"{verb} {len(ids)}" for verb, ids in counts.items() if ids)
    return done or (said.kind if said.accepted else f"{said.kind}, not accepted")


def _weighed(rule: "Rule") -> str:
    return f"{rule_text(rule)} {rule.interval} ({rule.speaker})"


def _state(rule: "Rule") -> str:
    return str(rule.interval) if rule.status == "active" else rule.status
