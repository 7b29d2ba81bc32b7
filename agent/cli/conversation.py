# SPDX-License-Identifier: Apache-2.0
"""Commands that talk to the robot: demo, tell, do, ask, chat."""

from __future__ import annotations

import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from .common import STDIN, converse, finish, open_agent, open_for_reading, show, terminal
from .options import (
    ActionsFile,
    AsJson,
    Choices,
    Contexts,
    Eyes,
    Gui,
    Heard,
    Induce,
    Kb,
    NoiseText,
    NoSim,
    Objects,
    Out,
    Record,
    Robot,
    SceneSpec,
    Seed,
    SettingsFile,
    Speaker,
    UserLexicon,
    Utterance,
    app,
    example,
)

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from ..agent import Agent


@app.command(epilog=example("demo --no-sim"))
def demo(
    *,
    kb: Kb = "memory:",
    seed: Seed = 0,
    robot: Robot = "panda",
    vision: Eyes = "mask",
    noise: NoiseText = "",
    out: Out = Path("out/demo"),
    gui: Gui = False,
    no_sim: NoSim = False,
    as_json: AsJson = False,
) -> None:
    """Run the paper's running example: three sentences, and a knife passed by the blade."""
    from .. import demo as example

    with open_agent(
        kb, seed=seed, robot=robot, vision=vision, noise=noise, gui=gui, no_sim=no_sim
    ) as agent:
        came = example.run(agent, terminal(stderr=True), out)
        if as_json:
            show(came.as_json())
        else:
            example.show(came, terminal(), agent)
    finish(came.is_as_told)


@app.command(epilog=example('tell "To pass a knife, grab it by the blade"'))
def tell(
    text: Utterance,
    *,
    kb: Kb = None,
    objects: Objects = None,
    actions: ActionsFile = None,
    lexicon: UserLexicon = None,
    speaker: Speaker = "sam",
    heard: Heard = 1.0,
    as_json: AsJson = False,
) -> None:
    """Teach a rule: "A knife is used for cutting"."""
    with open_agent(kb, objects=objects, actions=actions, lexicon=lexicon) as agent:
        done = converse(
            agent,
            text,
            lambda said: agent.hear(said, speaker=speaker, only="tell", heard=heard),
            (lambda reply: reply.as_tell_json()) if as_json or text == STDIN else None,
        )
    finish(done)


@app.command(epilog=example('do "pass me something used for cutting" --no-sim'))
def do(
    text: Utterance,
    *,
    kb: Kb = None,
    scene: SceneSpec = "all",
    objects: Objects = None,
    seed: Seed = 0,
    speaker: Speaker = "sam",
    robot: Robot = "panda",
    vision: Eyes = "mask",
    noise: NoiseText = "",
    as_json: AsJson = False,
    record: Record = None,
    gui: Gui = False,
    no_sim: NoSim = False,
    induce: Induce = False,
    actions: ActionsFile = None,
    context: Contexts = None,
    settings: SettingsFile = None,
    choices: Choices = None,
    lexicon: UserLexicon = None,
    heard: Heard = 1.0,
) -> None:
    """Ask for something to be done: "pass me something used for cutting"."""
    with (
        open_agent(
            kb,
            scene=scene,
            objects=objects,
            seed=seed,
            robot=robot,
            vision=vision,
            noise=noise,
            gui=gui,
            no_sim=no_sim,
            induces=induce,
            actions=actions,
            contexts=context,
            settings=settings,
            choices=choices,
            lexicon=lexicon,
        ) as agent,
        _filmed(agent, record),
    ):
        done = converse(
            agent,
            text,
            lambda said: agent.hear(said, speaker=speaker, only="do", heard=heard),
            (lambda reply: reply.as_do_json()) if as_json or text == STDIN else None,
        )
    finish(done)


def _filmed(agent: Agent, path: Path | None) -> AbstractContextManager[object]:
    """A recording of what is done in the block; nothing when no file is named."""
    if path is None:
        return nullcontext()
    if not agent.simulate:
        raise typer.BadParameter("--record films a robot. Leave out --no-sim.")
    return agent.filmed(path)


@app.command(epilog=example('ask "how do you pass a knife?"'))
def ask(
    text: Utterance,
    *,
    kb: Kb = None,
    scene: SceneSpec = "all",
    objects: Objects = None,
    seed: Seed = 0,
    speaker: Speaker = "sam",
    lexicon: UserLexicon = None,
    as_json: AsJson = False,
) -> None:
    """Ask what is known: "what is a knife used for?"."""
    with open_agent(
        kb, scene=scene, objects=objects, seed=seed, no_sim=True, lexicon=lexicon
    ) as agent:
        done = converse(
            agent,
            text,
            lambda said: agent.hear(said, speaker=speaker, only="ask"),
            (lambda reply: reply.as_ask_json()) if as_json or text == STDIN else None,
        )
    finish(done)


@app.command(epilog=example("chat --no-sim"))
def chat(
    *,
    kb: Kb = None,
    scene: SceneSpec = "all",
    objects: Objects = None,
    seed: Seed = 0,
    speaker: Speaker = "sam",
    robot: Robot = "panda",
    vision: Eyes = "mask",
    noise: NoiseText = "",
    gui: Gui = False,
    no_sim: NoSim = False,
    induce: Induce = False,
    actions: ActionsFile = None,
    context: Contexts = None,
    settings: SettingsFile = None,
    choices: Choices = None,
    lexicon: UserLexicon = None,
) -> None:
    """Talk: teach, ask and command, a line each; /rules, /why, /scene, /speaker and /quit."""
    from ..chat import run

    with open_agent(
        kb,
        scene=scene,
        objects=objects,
        seed=seed,
        robot=robot,
        vision=vision,
        noise=noise,
        gui=gui,
        no_sim=no_sim,
        induces=induce,
        actions=actions,
        contexts=context,
        settings=settings,
        choices=choices,
        lexicon=lexicon,
    ) as agent:
        run(agent, terminal(), sys.stdin, speaker)


@app.command(epilog=example("words --json"))
def words(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the words that were learned, with their teachers."""
    from ..presentation import console

    with open_for_reading(kb) as base:
        found = base.words()
    if as_json:
        show([word.as_json() for word in found])
    else:
        terminal().print(console.words(found))
