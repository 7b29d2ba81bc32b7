"""Commands on past utterances and episodes, and on differences between bases."""

import sys
import time
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ...ontology.errors import DataError, HiltError
from .. import config, presentation
from ..presentation.plain_text import counted
from . import common
from .options import AsJson, DryRun, Gui, Kb, Record, Speaker, app, example
from .rules import Object

if TYPE_CHECKING:
    from ...kb.knowledge_base import KnowledgeBase

ADDRESSES = ("http://", "https://", "memory:")
By = Annotated[str | None, typer.Option(help="Only what this one said.")]
Which = Annotated[str, typer.Argument(metavar="ID|last", help="An episode's id, or its start.")]
Form = Literal["csv", "json", "mcap"]
Since = Annotated[int | None, typer.Option(min=0, help="Only after this utterance.")]

episodes_app = typer.Typer(epilog=example("episodes --last 5"), invoke_without_command=True)
app.add_typer(episodes_app, name="episodes")


@app.command(epilog=example("history --last 10 --speaker sam"))
def history(
    *,
    since: Since = None,
    last: Annotated[int | None, typer.Option(min=1, help="Only the last so many.")] = None,
    speaker: By = None,
    about: Annotated[
        str | None, typer.Option(metavar="RULE", help="Only what touched this rule.")
    ] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """List the utterances: when, by whom, and their effect on the rules."""
    from ...kb.views import find_rule

    with common.open_for_reading(kb) as base:
        rule = find_rule(base, about) if about else None
        said = base.history(since=since or 0, newest_first=True)  # so that the last come at once
        if speaker:
            said = (one for one in said if one.speaker.casefold() == speaker.casefold())
        if rule:
            said = (one for one in said if rule.id in one.asserts + one.retracts + one.supersedes)
        shown = [*islice(said, last)][::-1]
    common.show(shown, presentation.console.history, as_json=as_json)


@app.command(epilog=example("forget last"))
def forget(
    what: Annotated[
        list[str],
        typer.Argument(
            metavar="RULE|last|word WORD|phrase PHRASE|action ACTION|experience [OBJECT [PART]]",
            help='A rule by its id or the first digits of it (see "hilt rules"), the last sentence '
            "that taught something, a learned word, phrase or action, or what grasping an object "
            "came to.",
        ),
    ],
    *,
    speaker: Speaker = "sam",
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Take back a rule, what was told last, a word, an action, ..; the history keeps it."""
    from ..documents import forgotten_as_json

    with common.open_base(kb) as base:
        before = base.sequence
        said = _forgotten(base, what, speaker)
        done = forgotten_as_json(base, said, before)
    common.announce(done, said, as_json=as_json)


@app.command(epilog=example("watch --json"))
def watch(
    *,
    since: Since = None,
    speaker: By = None,
    name: Object = None,
    every: Annotated[float, typer.Option(min=0.05, help="Seconds between looks.")] = 0.5,
    seconds: Annotated[
        float | None,
        typer.Option("--for", min=0.0, help="Stop after so many seconds; 0 only shows what is."),
    ] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Show changes as they happen, until Ctrl-C; others may go on teaching meanwhile.

    Who stopped goes on with --since and the last number ("sequence") that was shown.
    """
    from ...kb.views import rule_changes

    out = common.terminal()
    with suppress(KeyboardInterrupt):
        for base, new in _new_states(kb, since, every, seconds):
            for change in rule_changes(base, since=new.start - 1, speaker=speaker, object=name):
                if change.utterance.sequence not in new:  # said meanwhile; it comes next time
                    break
                common.print_json(change.as_json()) if as_json else out.print(
                    presentation.console.change(change), soft_wrap=True
                )


@app.command(epilog=example("diff mine/ rules.yaml"))
def diff(
    one: Annotated[str, typer.Argument(metavar="A", help="A base, or a file that export wrote.")],
    other: Annotated[str, typer.Argument(metavar="B", help="Another.")],
    as_json: AsJson = False,
) -> None:
    """Show how what B believes differs from what A believes; exit code 1 when it does."""
    from ...kb.views import compare_bases

    with _opened(one) as before, _opened(other) as after:
        found = compare_bases(before, after)
    common.show(found, presentation.console.difference, as_json=as_json, soft_wrap=True)
    common.exit_with(found.is_empty)


@app.command(epilog=example("merge mine/ theirs.trig --dry-run"))
def merge(
    into: Annotated[str, typer.Argument(metavar="A", help="The base that is changed.")],
    other: Annotated[str, typer.Argument(metavar="B", help="The base or file to merge.")],
    *,
    dry_run: DryRun = False,
    as_json: AsJson = False,
) -> None:
    """Add what B knows to A, whole or not at all, and report the conflicts."""
    from ...kb.bulk import importer

    with common.open_to_change(into, dry_run=dry_run) as base, _opened(other) as source:
        found = importer.merge(base, source.store, source=other, dry_run=dry_run)
    common.show_import(found, other, dry_run=dry_run, as_json=as_json)


@episodes_app.callback()
def episodes(
    context: typer.Context,
    *,
    last: Annotated[int | None, typer.Option(min=1, help="Only the last so many.")] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """List the episodes: each command with its time, outcome, object and part."""
    if context.invoked_subcommand:
        return
    from ..documents import episode_as_json

    with common.open_for_reading(kb) as base:
        found = list(base.episodes())
    shown = found[-last:] if last else found
    if as_json:
        common.print_json([episode_as_json(one) for one in shown])
    else:
        common.terminal().print(presentation.console.episodes(shown))


@episodes_app.command(epilog=example("episodes trajectory last --out arm.csv"))
def trajectory(
    which: Which,
    *,
    form: Annotated[Form, typer.Option("--format", help="csv, json or mcap.")] = "csv",
    out: Annotated[str, typer.Option(help='A file; "-" is standard output.')] = "-",
    kb: Kb = None,
) -> None:
    """Export where the joints of the robot were in an episode, 48 times a second."""
    from ...sim.robot.trajectory import export
    from ..replay import find_episode

    if form == "mcap" and out == "-" and sys.stdout.isatty():
        raise typer.BadParameter("MCAP is binary: name a file (--out), or redirect the output.")
    with common.open_for_reading(kb) as base:
        found = find_episode([*base.episodes()], which)
    if found.trajectory is None:
        raise HiltError(f"{found.id} has no trajectory: no simulated arm moved, or Hilt was older.")
    common.write_bytes(out, export(found.trajectory, form))


@app.command(epilog=example("experience --object screwdriver"))
def experience(
    *,
    name: Annotated[str | None, typer.Option("--object", help="With this object.")] = None,
    part: Annotated[str | None, typer.Option(help="Grasped by this part.")] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """List how often grasps held, by object, part, action and robot, and what follows from it."""
    from ...inference.experience import read_records

    given = {"object": name, "part": part}
    with common.open_for_reading(kb) as base:
        found = read_records(base, **{key: value for key, value in given.items() if value})
    common.show(found, presentation.console.experience, as_json=as_json)


@app.command(epilog=example("replay last --record again.gif"))
def replay(
    which: Which, *, kb: Kb = None, record: Record = None, gui: Gui = False, as_json: AsJson = False
) -> None:
    """Run an episode again from its seed and its rules; exit code 1 when the result differs."""
    from ..replay import replay as run

    with common.open_for_reading(kb) as base:
        with common.spinner(f"Running {which} again"):
            found = run(base, which, gui=gui, film=record)
        if record:
            typer.echo(f"Film written to {record}.", err=True)
        quote = partial(presentation.console.replay_result, quote=lambda n: base.utterance(n).text)
        common.show(found, quote, as_json=as_json)
    common.exit_with(not found.differences)


def _forgotten(base: "KnowledgeBase", what: list[str], speaker: str) -> str:
    from ...kb.learned import PHRASES, TAUGHT_ACTIONS, WORDS
    from ..documents import forget_rules, rules_to_forget

    said, speaker = f"forget {' '.join(what)}", base.match_speaker(speaker)
    match what:
        case ["word" | "phrase" as kind]:
            raise typer.BadParameter(f'Which {kind}? "hilt words" lists those that were learned.')
        case ["word", name]:
            base.forget(WORDS, name, said, speaker)
            return f'Forgot the word "{name}".'
        case ["phrase", *words]:
            phrase = base.forget(PHRASES, " ".join(words), said, speaker)
            return f'Forgot the phrase "{phrase.pattern}".'
        case ["action", *words] if words:
            action = base.forget(TAUGHT_ACTIONS, " ".join(words), said, speaker)
            return f'Forgot the action "{action.name}".'
        case ["experience", *names] if len(names) <= 2:
            name, part = (*names, None, None)[:2]
            number = base.forget_trials(said, speaker, of=name, part=part)
            return f"Forgot what {counted(number, 'grasp')} came to."
        case [name]:
            return forget_rules(base, rules_to_forget(base, name, speaker), said, speaker)
        case _:
            raise typer.BadParameter(
                'Expected RULE, "last", "word" and a word, "phrase" and a phrase, "action" and an '
                'action, or "experience".'
            )


def _new_states(
    kb: str | None, since: int | None, every: float, seconds: float | None
) -> "Iterator[tuple[KnowledgeBase, range]]":
    from ...kb.stores.mark import read_mark

    folder = Path(kb or config.default_location()).expanduser()
    end, last, seen = time.monotonic() + (seconds or 0), since, b""
    while True:
        mark = read_mark(folder)  # without one, as at an endpoint, the base says what is new
        if not mark or mark != seen:
            with common.open_for_reading(kb) as base:
                before, last = last, base.sequence
                yield base, range((last if before is None else before) + 1, last + 1)
        seen = mark
        if seconds is not None and time.monotonic() >= end:
            return
        time.sleep(every)


@contextmanager
def _opened(name: str) -> "Generator[KnowledgeBase]":
    from ...kb.formats.import_export import import_file
    from ...kb.knowledge_base import KnowledgeBase

    is_base = name.startswith(ADDRESSES) or Path(name).is_dir()
    if not is_base and not Path(name).exists():
        raise DataError("is neither a knowledge base nor a file.", source=name)
    with KnowledgeBase.open(name if is_base else "memory:", read_only=is_base) as base:
        if not is_base:
            import_file(base, name)
        yield base
