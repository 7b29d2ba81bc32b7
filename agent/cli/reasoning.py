"""Commands that show the reasoning: explain, conflicts, induce, abduce."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from .. import presentation
from ..config import AgentConfig
from . import common
from .options import INFERENCE, SCENE, AsJson, Kb, Speaker, app, example, with_config


@app.command(epilog=example('explain "pass me something used for cutting"'))
@with_config(*SCENE, "actions", "lexicon", *INFERENCE)
def explain(
    text: Annotated[str, typer.Argument(help="A command; it is decided, not carried out.")],
    *,
    config: AgentConfig,
    kb: Kb = None,
    speaker: Speaker = "sam",
    svg: Annotated[Path | None, typer.Option(help="Also draw the proof into this file.")] = None,
    as_json: AsJson = False,
) -> None:
    """Prove a decision: from what was said to what is chosen, and what would change it."""
    from ..documents import Explanation

    common.require_base(kb)
    with common.open_agent(kb, replace(config, simulate=False)) as agent:
        found = Explanation(agent, text, speaker)
        decision = found.reply.decision
        drawing, describe = presentation.deduction_svg, agent.dialogue.conversation.describe
        if svg and decision:
            proved = [drawing.from_proof(each, describe) for each in decision.proofs()]
            common.write_svg(svg, drawing.draw_svg(proved))
        if as_json:
            common.print_json(found.as_json())
        else:
            explained = presentation.console.explanation(found.reply, found.changes, describe)
            common.terminal().print(explained)
    common.exit_with(found.reply.is_done)


@app.command(epilog=example("conflicts --json"))
def conflicts(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the rules that contradict each other, the heaviest conflict first."""
    from ...inference.rule_analysis import find_conflicts

    with common.open_for_reading(kb) as base:
        found = find_conflicts(base.rules())
    common.show(found, presentation.console.conflicts, as_json=as_json)


@app.command(epilog=example("induce --json"))
def induce(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the rules that follow by similarity from those that were taught."""
    from ...inference.induction import induce as find
    from ...ontology.objects import load_household

    household = load_household()
    with common.open_for_reading(kb) as base:
        found = find(base.rules(), household.objects, classes=household.classes)
    common.show(found, presentation.console.induced, as_json=as_json)


@app.command(epilog=example("abduce affordance:cutting --given property:sharp"))
def abduce(
    conclusion: Annotated[
        str, typer.Argument(help="What to explain: affordance:cutting, part:blade, cutWith(bread).")
    ],
    *,
    given: Annotated[list[str] | None, typer.Option(help="What is known: object:knife ...")] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """List the hypotheses that would explain a conclusion, the likeliest first."""
    from ...inference.rule_analysis import find_hypotheses, parse_conclusion
    from ...inference.taxonomy import Taxonomy
    from ...kb.rule import Atom

    known = frozenset(Atom.parse(each) for each in given or ())
    with common.open_for_reading(kb) as base:
        wanted, taxonomy = parse_conclusion(conclusion), Taxonomy.from_base(base)
        found = find_hypotheses(base.rules(), wanted, given=known, taxonomy=taxonomy)
    common.show(found, presentation.console.hypotheses, as_json=as_json)
    common.exit_with(bool(found))
