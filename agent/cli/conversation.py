"""Commands that talk to the robot: demo, tell, do, ask, chat, listen."""

import sys
from contextlib import ExitStack, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from .. import presentation
from ..config import AgentConfig
from . import common, options
from .options import AsJson, Kb, Speaker, app, example, with_config


@app.command(epilog=example("demo --no-sim"))
@with_config("seed", *options.ROBOT)
def demo(
    *,
    config: AgentConfig,
    kb: Kb = "memory:",
    out: options.Out = Path("out/demo"),
    as_json: AsJson = False,
) -> None:
    """Run the paper's running example: three sentences, and a knife passed by the blade."""
    from .. import demo as example

    with common.open_agent(kb, config) as agent:
        found = example.run(agent, common.terminal(stderr=True), out)
        if as_json:
            common.print_json(found.as_json())
        else:
            example.show(found, common.terminal(), agent)
    common.exit_with(found.is_as_told)


@app.command(epilog=example('tell "To pass a knife, grab it by the blade"'))
@with_config(*options.LANGUAGE)
def tell(
    text: options.Utterance,
    *,
    config: AgentConfig,
    kb: Kb = None,
    speaker: Speaker = "sam",
    heard: options.Heard = 1.0,
    alternatives: options.Alternatives = None,
    as_json: AsJson = False,
) -> None:
    """Teach a rule: "A knife is used for cutting"."""
    said = common.read_alternatives(alternatives, text)
    with common.open_agent(kb, config) as agent:
        common.converse(agent, text, speaker, "tell", heard=heard, others=said, as_json=as_json)


@app.command(epilog=example('do "pass me something used for cutting" --no-sim'))
@with_config(*options.EVERY)
def do(
    text: options.Utterance,
    *,
    config: AgentConfig,
    kb: Kb = None,
    speaker: Speaker = "sam",
    heard: options.Heard = 1.0,
    alternatives: options.Alternatives = None,
    record: options.Record = None,
    as_json: AsJson = False,
) -> None:
    """Ask for something to be done: "pass me something used for cutting"."""
    said = common.read_alternatives(alternatives, text)
    with common.open_agent(kb, config) as agent, ExitStack() as filming:
        if record and not agent.simulate:
            raise typer.BadParameter("--record films a robot. Leave out --no-sim.")
        if record:
            filming.callback(typer.echo, f"Film written to {record}.", err=True)  # also if it fails
            filming.enter_context(agent.filmed(record))
        common.converse(agent, text, speaker, "do", heard=heard, others=said, as_json=as_json)


@app.command(epilog=example('ask "how do you pass a knife?"'))
@with_config(*options.SCENE, "lexicon", *options.INFERENCE)
def ask(
    text: options.Utterance,
    *,
    config: AgentConfig,
    kb: Kb = None,
    speaker: Speaker = "sam",
    as_json: AsJson = False,
) -> None:
    """Ask what is known: "what is a knife used for?"."""
    with common.open_agent(kb, replace(config, simulate=False)) as agent:
        common.converse(agent, text, speaker, "ask", as_json=as_json)


@app.command(epilog=example("chat --no-sim"))
@with_config(*options.EVERY)
def chat(
    *,
    config: AgentConfig,
    kb: Kb = None,
    speaker: options.Host = None,
    speech: Annotated[bool, typer.Option("--speech", help="Listen, do not read.")] = False,
    sound: Annotated[
        list[Path] | None, typer.Option(help="Listen to this .wav file; may be repeated.")
    ] = None,
    speak: Annotated[bool, typer.Option("--speak", help="Speak the answers, too.")] = False,
    voice: Annotated[str, typer.Option(help="espeak, or a plug-in, NAME[:REST].")] = "espeak",
    recogniser: options.Recognisers = None,
    keep_sound: options.KeptSound = None,
) -> None:
    """Talk: teach, ask and command, a line each; /help shows what can be said."""
    from ..chat import run

    if not speech and (sound or speak or recogniser or keep_sound):
        raise typer.BadParameter("Sounds and voices need --speech.")
    with common.open_agent(kb, config) as agent, ExitStack() as opened:
        talk = None
        if speech:
            from ..speech.talk import open_talk

            parts = (sound or (), recogniser or (), agent.dialogue.conversation.language)
            spoken_by = voice if speak else ""
            talk = opened.enter_context(open_talk(*parts, voice=spoken_by, kept_in=keep_sound))
        run(agent, common.terminal(), sys.stdin, speaker, talk)


@app.command(epilog=example("listen command.wav"))
def listen(
    file: Annotated[Path | None, typer.Argument(metavar="FILE.wav", help="A recording.")] = None,
    *,
    from_microphone: Annotated[
        bool, typer.Option("--microphone", help="Listen to one utterance.")
    ] = False,
    recogniser: options.Recognisers = None,
    keep_sound: options.KeptSound = None,
    lexicon: options.UserLexicon = None,
    as_json: AsJson = False,
) -> None:
    """Show what is heard: the text, its alternatives, and how it is understood."""
    if (file is None) != from_microphone:
        raise typer.BadParameter("Give either a file or --microphone.")
    from ...nlu.language import Language
    from ..speech.listening import Listener
    from ..speech.sound import Sound, microphone
    from ..speech.talk import keep

    with nullcontext(iter([Sound.read(file)])) if file else microphone() as sounds:
        sound = next(sounds)
    listener = Listener.open(recogniser or (), Language.load(extra_lexicon=lexicon))
    heard = listener.hear(sound)
    if keep_sound:
        keep(sound, heard, keep_sound)
    understood = listener.language.understand(heard.text, heard=heard.heard)
    if as_json:
        common.print_json(heard.as_json() | {"understood": understood.as_json()})
    else:
        common.terminal().print(presentation.console.heard(heard))
        common.terminal().print(presentation.console.understanding(understood))
    common.exit_with(understood.kind not in {"error", "ask_back"})


@app.command(epilog=example("actions --json"))
def actions(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the actions that were taught, with their steps and their teachers."""
    with common.open_for_reading(kb) as base:
        found = base.actions()
    common.show(found, presentation.console.actions, as_json=as_json)


@app.command(epilog=example("words --json"))
def words(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the words and the turns of phrase that were learned, with their teachers."""
    with common.open_for_reading(kb) as base:
        found = [*base.words(), *base.phrases()]
    common.show(found, presentation.console.words, as_json=as_json)
