"""Nothing that is forbidden is done, whatever is asked for in whatever order."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.execution.outcome import GoalResult
from hilt.agent.execution.request import Request
from hilt.inference.types import Target
from hilt.kb.interval import Interval
from hilt.kb.rule import Atom, Rule, norm

SEQUENCES, COMMANDS = 1000, 3
ACTIONS = ("pass", "pickUp", "pointTo", "grasp")
THINGS = ("knife", "mug", "hammer")
PARTS = {"knife": ("blade", "handle"), "mug": ("handle", "rim"), "hammer": ("handle", "head")}
PEOPLE, PLACES = ("child", "anna"), ("kitchen", "garden")
SURE = Interval(0.95, 1.0)


# --- The reference --------------------------------------------------------------------------


@dataclass(frozen=True)
class Deed:
    """What was done: with which object, by which part, for whom, and where."""

    action: str
    thing: str
    part: str | None
    person: str | None
    place: str | None


def concerns(rule: Rule, deed: Deed) -> bool:
    """Whether a norm speaks of a deed; every deed but pointing is a grasp, too."""
    actions = {deed.action} if deed.action == "pointTo" else {deed.action, "grasp"}
    facts = {("object", deed.thing), ("role", deed.person), ("place", deed.place)}
    facts |= {("action", each) for each in actions}
    return all((atom.kind, atom.name) in facts for atom in rule.features | rule.contexts)


def opposes(rule: Rule, deed: Deed) -> bool:
    """Whether a norm that speaks of a deed opposes it."""
    if rule.functor == "permitted" or not concerns(rule, deed):
        return False
    if rule.functor == "obliged":
        return deed.action != "pointTo" and deed.part != rule.part
    return rule.part is None or deed.part == rule.part


def lifts(permission: Rule, rule: Rule, deed: Deed) -> bool:
    """Whether a permission that speaks of a deed prevails over a norm that opposes it."""
    if permission.functor != "permitted" or not concerns(permission, deed):
        return False
    if permission.part not in {None, deed.part}:
        return False
    one, other = premises(permission, deed), premises(rule, deed)
    if one > other or other > one:
        return one > other
    return (permission.utterance or 0) > (rule.utterance or 0)


def premises(rule: Rule, deed: Deed) -> frozenset[object]:
    """What a norm is about; to do something with a thing is more special than to hold it."""
    kinds = {"grasp", deed.action} if rule.context == deed.action else {rule.context}
    atoms = (atom for atom in rule.features | rule.contexts if atom.kind != "action")
    return frozenset([*atoms, *kinds, *([rule.argument] if rule.argument else [])])


def is_forbidden(deed: Deed, rules: Sequence[Rule]) -> bool:
    """Whether a deed is opposed by a norm that no permission lifts."""
    return any(
        opposes(rule, deed) and not any(lifts(other, rule, deed) for other in rules)
        for rule in rules
    )


# --- Random norms and commands ---------------------------------------------------------------

BEGIN = {
    "forbidden": ("never", "I forbid you to", "you are not allowed to"),
    "permitted": ("you may", "you are allowed to"),
    "obliged": ("you must", "always"),
}
DOING = {"pass": "pass", "pickUp": "pick up", "pointTo": "point to", "grasp": "touch"}


def some_norm(chance: random.Random) -> Rule:
    """A norm on one of the actions."""
    functor, thing = chance.choice(["forbidden", "forbidden", "permitted", "obliged"]), ""
    thing = chance.choice([*THINGS, "*"])
    parts = PARTS.get(thing, ("handle",))
    part = chance.choice(parts) if functor == "obliged" or chance.random() < 0.3 else None
    contexts = [Atom("role", chance.choice(PEOPLE))] if chance.random() < 0.3 else []
    contexts += [Atom("place", chance.choice(PLACES))] if chance.random() < 0.3 else []
    argument = Atom("part", part) if part else None
    action = "pass" if contexts and contexts[0].kind == "role" else chance.choice(ACTIONS)
    return norm(functor, action, thing, argument, interval=SURE, contexts=contexts)


def sentence(rule: Rule, chance: random.Random) -> str:
    """One of the ways to say a norm."""
    context = {atom.kind: atom.name for atom in rule.contexts}
    thing = "anything" if rule.object in {None, "*"} else f"the {rule.object}"
    person = {"child": " to a child", "anna": " to Anna"}.get(context.get("role", ""), "")
    only = "only " if rule.functor == "obliged" else ""
    part = f" {only}by the {rule.part}" if rule.part else ""
    place = f" in the {context['place']}" if "place" in context else ""
    is_holding = rule.functor == "forbidden" and part and not person and not place
    begin = "I forbid you to" if is_holding else chance.choice(BEGIN[rule.functor])
    return f"{begin} {DOING[context['action']]} {thing}{person}{part}{place}"


def heard(agent: Agent, text: str, rule: Rule) -> Rule:
    """The norm that the agent has learned from a sentence: the one that was meant."""
    (learned,) = agent.hear(text).rules
    said = (learned.functor, learned.features, learned.contexts, learned.argument)
    assert said == (rule.functor, rule.features, rule.contexts, rule.argument), text
    return agent.base.rule(learned.id)


def some_request(chance: random.Random) -> Request:
    """A command on one of the things, at a place or anywhere."""
    action, thing = chance.choice(ACTIONS), chance.choice(THINGS)
    arguments: dict[str, Target | str] = {"object": Target(object=thing)}
    if action == "pass":
        arguments["recipient"] = chance.choice([*PEOPLE, "sam"])
    place = chance.choice([*PLACES, ""])
    contexts = {Atom("place", place): Interval(1.0, 1.0)} if place else {}
    is_named = action != "pointTo" and chance.random() < 0.4
    part = chance.choice(PARTS[thing]) if is_named else None
    return Request(action, arguments, "sam", part=part, contexts=contexts)


def deed_of(request: Request, result: GoalResult) -> Deed:
    """What was done for a request."""
    assert result.decision is not None and result.decision.object.best is not None
    person = request.arguments.get("recipient")
    return Deed(
        request.action,
        result.decision.object.best.object,
        result.decision.chosen_part,
        str(person) if person else None,
        next((atom.name for atom in request.contexts), None),
    )


@pytest.fixture
def agent():
    """A robot that decides, with the three things in view."""
    scene = f"objects:{','.join(THINGS)}"
    with Agent.open("memory:", AgentConfig(scene=scene, simulate=False)) as mind:
        yield mind


def test_nothing_forbidden_is_done_in_random_sequences(agent: Agent):
    """After norms in words, each deed is one that the reference allows; what is free is done."""
    chance = random.Random(14)  # noqa: S311 - no secret
    done = refused = 0
    for _ in range(SEQUENCES):
        told = [some_norm(chance) for _ in range(chance.randint(2, 5))]
        rules = [heard(agent, sentence(rule, chance), rule) for rule in told]
        for _ in range(COMMANDS):
            request = some_request(chance)
            result = agent.goals.achieve(request)
            if result.answer.ending == "done":
                deed = deed_of(request, result)
                assert not is_forbidden(deed, rules), (deed, rules)
                done += 1
            else:
                thing, whole = request.name("object"), request.arguments.get("recipient")
                place = next((atom.name for atom in request.contexts), None)
                person = str(whole) if whole else None
                asked = Deed(request.action, thing, request.part, person, place)
                assert any(concerns(rule, asked) for rule in rules), (asked, rules)
                refused += 1
        agent.base.believe("Forget it.", "", "sam", [], retracts=[rule.id for rule in rules])

    assert min(done, refused) > SEQUENCES // 4
