"""Commands about the language: parse, and the lexicon."""

import json
import random
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...ontology.errors import DataError
from ...ontology.yaml_reader import read_text
from .. import presentation
from .common import announce, exit_with, print_json, report_error, show, utterances, write_svg
from .options import AsJson, Speaker, UserLexicon, app, example

if TYPE_CHECKING:
    from ...nlu.language import Session

Said = Annotated[
    str | None, typer.Argument(metavar="TEXT", help='What to parse, or "-" for lines from stdin.')
]
Before = Annotated[list[str] | None, typer.Option(help="What was said before; may be repeated.")]
Jsonl = Annotated[
    Path | None, typer.Option(help='A file of {"text", "before": [..]} lines; a result line each.')
]
Svg = Annotated[Path | None, typer.Option(help="Draw the derivation into this .svg file.")]


@app.command(epilog=example('parse "pass it" --before "A knife is for cutting"'))
def parse(
    text: Said = None,
    *,
    before: Before = None,
    jsonl: Jsonl = None,
    svg: Svg = None,
    lexicon: UserLexicon = None,
    speaker: Speaker = "sam",
    as_json: AsJson = False,
) -> None:
    """Show how a sentence is understood: derivation, predicate form, meaning."""
    if (text is None) == (jsonl is None):
        raise typer.BadParameter("Give either a text or --jsonl FILE.")
    if jsonl is not None and (before or svg):
        raise typer.BadParameter("--before and --svg are for one text, not for --jsonl.")
    session = _session(lexicon)
    if jsonl is not None:
        _parse_file(session, jsonl, speaker)
        return

    session = session.after(before or (), speaker=speaker)
    understood = [session.hear(said, speaker=speaker)[0] for said in utterances(text or "")]
    for found in understood:
        show(found, presentation.console.understanding, as_json=as_json)
        if svg is not None and found.derivation is not None:
            drawn = presentation.deduction_svg.from_derivation(found.derivation)
            write_svg(svg, presentation.deduction_svg.draw_svg([drawn]))
    exit_with(all(found.kind not in {"error", "ask_back"} for found in understood))


lexicon_app = typer.Typer(help="The words of the language.")
app.add_typer(lexicon_app, name="lexicon")


@lexicon_app.command(epilog=example("lexicon check mine.yaml"))
def check(
    file: Annotated[Path, typer.Argument(help="A lexicon file of your own.")],
    *,
    as_json: AsJson = False,
) -> None:
    """Check a lexicon file: declared categories, terms of the right type, unmixed features."""
    from ...nlu.semantics.clause_features import check_spellings

    language = _session(None).language
    before = sum(1 for _ in language.lexicon.senses())
    entries = sum(1 for _ in _session(file).language.lexicon.senses()) - before
    check_spellings(file, language.parser.features)
    found = {"file": str(file), "entries": entries}
    announce(found, f"{file}: {entries} entries, no mistake.", as_json=as_json)


@lexicon_app.command(name="list", epilog=example("lexicon list knife"))
def list_entries(
    word: Annotated[str | None, typer.Argument(help="Only entries with this word.")] = None,
    *,
    lexicon: UserLexicon = None,
    as_json: AsJson = False,
) -> None:
    """List the entries: words, category, lambda term."""
    from ...nlu.grammar.word_patterns import words_of

    entries = sorted(
        (entry.says, str(entry.category), str(entry.term))
        for sense in _session(lexicon).language.lexicon.senses()
        if word is None or word in words_of(sense.says)
        for entry in [sense.entry()]
    )
    if word and not entries:
        report_error(f'No entry has the word "{word}".', as_json=as_json)
    if as_json:
        print_json([{"words": each[0], "category": each[1], "term": each[2]} for each in entries])
    else:
        typer.echo("".join(f"{each[0]}  {each[1]} : {each[2]}\n" for each in entries), nl=False)
    exit_with(bool(entries))


@lexicon_app.command(epilog=example("lexicon grammar > hilt.jsgf"))
def grammar(
    *,
    jsgf: Annotated[
        bool, typer.Option("--jsgf", help="In the JSpeech Grammar Format (the only one).")
    ] = True,
    count: Annotated[
        int, typer.Option("--sentences", min=0, help="Print so many of its sentences instead.")
    ] = 0,
    seed: Annotated[int, typer.Option(help="The seed of the sentences.")] = 0,
    lexicon: UserLexicon = None,
) -> None:
    """Print a grammar for a speech recogniser: whatever it allows is understood."""
    from ...nlu.jsgf import grammar_of, sentences

    language = _session(lexicon).language
    if count:
        for text in sentences(language, count, random.Random(seed)):  # noqa: S311 - no secret
            typer.echo(text)
    elif jsgf:
        typer.echo(grammar_of(language), nl=False)


def _session(lexicon: Path | None) -> "Session":
    from ...nlu.language import Language, Session

    return Session(Language.load(extra_lexicon=lexicon))


def _parse_file(session: "Session", path: Path, speaker: str) -> None:
    for number, line in enumerate(read_text(path).split("\n"), start=1):
        if not line.strip():
            continue
        try:
            case: dict[str, Any] = json.loads(line)
            text, before = case["text"], case.get("before", [])
            if isinstance(before, str) or not all(isinstance(t, str) for t in (text, *before)):
                raise TypeError
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            problem = 'expected JSON, {"text": ..., "before": [...]} with texts.'
            raise DataError(problem, source=str(path), line=number) from error
        found, _ = session.after(before, speaker=speaker).hear(text, speaker=speaker)
        print_json(found.as_json())
