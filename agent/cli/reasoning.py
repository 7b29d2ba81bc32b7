# SPDX-License-Identifier: Apache-2.0
"""Commands that show the reasoning: explain, conflicts, induce, abduce."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ...ontology.errors import DataError
from .options import AsJson, Kb, SceneSpec, Seed, Speaker, app
from .terminal import finish, open_agent, open_base, show, terminal


@app.command()
def explain(
    text: Annotated[str, typer.Argument(help="A command; it is decided, not carried out.")],
    *,
    kb: Kb = None,
    scene: SceneSpec = "all",
    seed: Seed = 0,
    speaker: Speaker = "sam",
    svg: Annotated[
        Path | None, typer.Option("--svg", help="Also draw the proof into this file.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Prove a decision: from what was said to what is chosen, and what would change it."""
    from ...inference.explanation import changes_of_mind
    from .. import console, drawing

    with open_agent(kb, scene=scene, seed=seed, no_sim=True) as agent:
        reply = agent.hear(text, speaker=speaker, only="do", keep=False)
        decision = reply.achievement.decision if reply.achievement else None
        changes = changes_of_mind(decision.object, agent.affordances.settings) if decision else []
        if svg and decision:
            _write(svg, drawing.svg(decision))
        if as_json:
            proofs = decision.proofs_as_json() if decision else []
            said = {"utterance": text, "said": reply.said, "outcome": reply.ending}
            show(said | {"proofs": proofs, "changes": [each.as_json() for each in changes]})
        else:
            terminal().print(console.explanation(reply, changes))
    finish(reply.is_done)


@app.command()
def conflicts(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the rules that contradict each other, the heaviest conflict first."""
    from ...inference.conflicts import conflicts as find
    from .. import console

    with open_base(kb) as base:
        found = find(base.rules())
    if as_json:
        show([each.as_json() for each in found])
    else:
        terminal().print(console.conflicts(found))


@app.command()
def induce(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the rules that follow by likeness from those that were taught."""
    from ...inference.induction import induce as find
    from ...ontology.objects import load_household
    from .. import console

    household = load_household()
    with open_base(kb) as base:
        found = find(base.rules(), household.objects, classes=household.classes)
    if as_json:
        show([each.as_json() for each in found])
    else:
        terminal().print(console.induced(found))


@app.command()
def abduce(
    conclusion: Annotated[
        str, typer.Argument(help="What to explain: affordance:cutting, or part:blade.")
    ],
    *,
    given: Annotated[
        list[str] | None, typer.Option("--given", help="What is known: object:knife, ...")
    ] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Tell what would have to be true for something to follow, the likeliest first."""
    from ...inference.abduction import hypotheses
    from ...kb.rule import GRASP_OBJECT, USED_FOR, Atom
    from .. import console

    argument = Atom.parse(conclusion)
    functor = USED_FOR if argument.kind == "affordance" else GRASP_OBJECT
    known = frozenset(Atom.parse(each) for each in given or ())
    with open_base(kb) as base:
        found = hypotheses(base.rules(), functor, argument, given=known)
    if as_json:
        show([each.as_json() for each in found])
    else:
        terminal().print(console.hypotheses(found))
    finish(bool(found))


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise DataError(f"cannot be written: {error.strerror}.", source=str(path)) from error
