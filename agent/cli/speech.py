"""Commands about speech: listen."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from .. import presentation
from . import options
from .common import exit_with, print_json, terminal
from .options import AsJson, UserLexicon, app, example

File = Annotated[Path | None, typer.Argument(metavar="FILE.wav", help="A sound to listen to.")]
Microphone = Annotated[bool, typer.Option("--microphone", help="Listen to one utterance.")]


@app.command(epilog=example("listen command.wav"))
def listen(
    file: File = None,
    *,
    from_microphone: Microphone = False,
    recogniser: options.Recognisers = None,
    keep_sound: options.KeptSound = None,
    lexicon: UserLexicon = None,
    as_json: AsJson = False,
) -> None:
    """Show what is heard: the text, its alternatives, and how it is understood."""
    if (file is None) != from_microphone:
        raise typer.BadParameter("Give either a file or --microphone.")
    from ...nlu.language import Language
    from ..speech.listening import Listener
    from ..speech.sound import Sound, microphone
    from ..speech.talk import keep

    listener = Listener.open(recogniser or (), Language.load(extra_lexicon=lexicon))
    with nullcontext(iter([Sound.read(file)])) if file else microphone() as sounds:
        sound = next(sounds)
    heard = listener.hear(sound)
    if keep_sound:
        keep(sound, heard, keep_sound)
    understood = listener.language.understand(heard.text, heard=heard.heard)
    if as_json:
        print_json(heard.as_json() | {"understood": understood.as_json()})
    else:
        terminal().print(presentation.console.heard(heard))
        terminal().print(presentation.console.understanding(understood))
    exit_with(understood.reading is not None)
