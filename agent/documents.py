"""JSON documents that the commands print with `--json` and the service answers with."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from ..inference.explanation import counterfactuals
from ..kb.formats.graphml import graph_of
from ..kb.views import find_rule, last_taught_rules, rule_changes
from ..ontology.errors import HiltError
from .execution.outcome import Json

if TYPE_CHECKING:
    from ..kb.episodes import Episode
    from ..kb.interval import Interval
    from ..kb.knowledge_base import KnowledgeBase
    from ..kb.rule import Rule
    from ..kb.sparql.named_queries import NamedQuery
    from ..sim.body import Body
    from .agent import Agent


class Explanation:
    """A command that is decided and not carried out, and what would change the decision."""

    def __init__(self, agent: "Agent", text: str, speaker: str) -> None:
        self.reply = agent.hear(text, speaker=speaker, only="do", keep=False)
        nodes = self.reply.decision.inferences if self.reply.decision else ()
        chosen = agent.affordances.settings
        found = [change for node in nodes for change in counterfactuals(node, chosen)]
        self.changes = sorted(found, key=lambda change: change.size)

    def as_json(self) -> Json:
        """As `hilt explain --json` prints it."""
        reply, decision = self.reply, self.reply.decision
        return {
            "utterance": reply.text,
            "said": reply.said,
            "outcome": reply.ending,
            "norms": [each.as_json() for each in reply.result.verdicts] if reply.result else [],
            "proofs": decision.proofs_as_json() if decision else [],
            "changes": [each.as_json() for each in self.changes],
        }


def episode_as_json(episode: "Episode") -> Json:
    """One entry of `hilt episodes --json`."""
    time = episode.time and episode.time.isoformat()
    known = {"id": episode.id, "time": time, "speaker": episode.speaker}
    return {**known, **json.loads(episode.document)}


def graph_as_json(rules: "Iterable[Rule]") -> Json:
    """The rules as nodes and edges, as `hilt graph --json` prints them."""
    found = graph_of(rules)
    return {
        "nodes": [{"id": node, **data} for node, data in found.nodes(data=True)],
        "edges": [{"from": a, "to": b, **data} for a, b, data in found.edges(data=True)],
    }


def question_as_json(named: "NamedQuery") -> Json:
    """One entry of `hilt query --list --json`."""
    parameters = [asdict(each) for each in named.parameters.values()]
    return {"name": named.name, "question": named.question, "parameters": parameters}


def trust_as_json(trust: "Mapping[str, Interval]") -> Json:
    """As `hilt trust --json` prints it."""
    return {name: {"lower": each.lower, "upper": each.upper} for name, each in trust.items()}


def things_as_json(body: "Body") -> list[dict[str, Any]]:
    """What stands where, as `hilt scene show --json` prints it: metres, and what holds it."""
    world = body.world
    return [
        {
            "name": name,
            "object": kind.name,
            "at": [round(float(x), 3) + 0.0 for x in world.pose(name)[:3, 3]],
            "within": world.supports.get(name),
        }
        for name, kind in world.kinds.items()
    ]


def rules_to_forget(base: "KnowledgeBase", name: str, speaker: str) -> "list[Rule]":
    """The active rules that a name means, or the "last" ones of a speaker.

    UnknownNameError if there are none; HiltError if they do not hold any more.
    """
    found = last_taught_rules(base, speaker) if name == "last" else [find_rule(base, name)]
    if over := [rule for rule in found if rule.status != "active"]:
        raise HiltError(f"{over[0].id} is {over[0].status} already.")
    return found


def forget_rules(base: "KnowledgeBase", rules: "Sequence[Rule]", said: str, speaker: str) -> str:
    """Retract rules, and return the answer, which the history keeps."""
    from .presentation.console import rule_text

    answer = f"Forgot {'; '.join(map(rule_text, rules))}."
    ids = [rule.id for rule in rules]
    base.believe(said, "", speaker, [], retracts=ids, kind="correction", answer=answer)
    return answer


def forgotten_as_json(base: "KnowledgeBase", said: str, before: int) -> Json:
    """As `hilt forget --json` prints it: the rules retracted after an utterance."""
    done = rule_changes(base, since=before)
    return {"said": said, "retracted": [rule.as_json() for one in done for rule in one.retracted]}
