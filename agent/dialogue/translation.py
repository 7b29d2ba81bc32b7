"""Translation between meanings and the rules, requests, words and action trees of the agent.

`nlu` knows no rules and `kb` no sentences; only this module imports both.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from ...inference.types import Target
from ...kb.interval import Interval
from ...kb.learned import LearnedWord
from ...kb.rule import KIND_OF, Atom, Rule, functional, grasping, kind_rule, norm
from ...nlu.language import Language
from ...nlu.lexicon.vocabulary import NewWord
from ...nlu.semantics import meaning
from ...nlu.semantics.interpretation import GOALS
from ...ontology import actions
from ..execution.outcome import AnswerContent
from ..execution.request import Argument, Request

Names = Mapping[str, str]
Lesson = meaning.Statement | meaning.KindStatement

PARAMETERS = ("object", "second", "third", "fourth")
"""The names of the parameters of taught actions, in order."""

KINDS = {"context": "action"}  # role of a new word -> kind of what it denotes
ROLES = {kind: role for role, kind in KINDS.items()}


def rule_from_meaning(
    said: meaning.Rule | meaning.KindRelation, speaker: str, heard: float = 1.0
) -> Rule:
    """Return the rule that a statement asserts, discounted by the confidence of the recogniser."""
    interval = Interval(*said.confidence).discounted(heard)
    if isinstance(said, meaning.KindRelation):
        return kind_rule(said.object, said.kind_of, interval=interval, speaker=speaker)
    given: dict[str, Any] = {"interval": interval, "properties": said.props, "speaker": speaker}
    if isinstance(said, meaning.FunctionalRule):
        return functional(said.object, said.affordance, material=said.material, **given)
    return grasping(said.object, said.part, said.context, **given)


def rule_from_answer(
    asked: meaning.Question, named: meaning.Answer, confidence: meaning.Confidence
) -> meaning.Rule | None:
    """Return the rule that a short answer teaches; None if it names nothing that is asked for."""
    name, sure = None if named.name == meaning.ANY_OBJECT else named.name, confidence
    if name is None or named.is_use != (asked.affordance is None and asked.context is None):
        return None
    if asked.affordance:
        on = asked.material
        return meaning.FunctionalRule(name, asked.affordance, sure, named.props, material=on)
    if asked.object and asked.context:
        return meaning.ActionRule(asked.object, asked.context, name, sure)
    if asked.object is None or asked.ask in {"why", "why_not"}:
        return None
    return meaning.FunctionalRule(asked.object, name, sure, material=named.material)


def meaning_from_rule(rule: Rule) -> meaning.Rule | meaning.KindRelation | meaning.Norm | None:
    """Return the meaning that asserts a rule; None when no sentence can express it."""
    name, sure = rule.object or meaning.ANY_OBJECT, (rule.interval.lower, rule.interval.upper)
    props = tuple(sorted(atom.name for atom in rule.features if atom.kind == "property"))
    if rule.kind == "norm":
        return _norm_from_rule(rule, meaning.ObjectReference(name, props=props), sure)
    if rule.functor == KIND_OF and rule.argument:
        return meaning.KindRelation(rule.argument.name, name, sure)
    kinds = sorted(atom.kind for atom in rule.features if atom.kind != "property")
    said = {"functional": "material", "action": "action"}.get(rule.kind)
    if kinds not in ([], ["object"]) or any(atom.kind != said for atom in rule.contexts):
        return None  # these atoms have no words
    if rule.kind == "functional" and rule.affordance:
        return meaning.FunctionalRule(name, rule.affordance, sure, props, material=rule.material)
    if rule.kind == "action" and rule.part and rule.context:
        return meaning.ActionRule(name, rule.context, rule.part, sure, props)
    return None


def _norm_from_rule(
    rule: Rule, target: meaning.ObjectReference, sure: meaning.Confidence
) -> meaning.Norm | None:
    if len(names := {atom.kind: atom.name for atom in rule.contexts}) != len(rule.contexts):
        return None
    goal, recipient = names["action"], names.get("role")
    act: meaning.SimpleCommand = meaning.Command(goal, target, rule.part, recipient)
    if rule.material:
        act = meaning.ToolCommand(goal, rule.material, target)
    before = None
    if rule.argument and rule.argument.kind == "action":
        thing = meaning.ObjectReference(names.get("object", target.object), props=())
        before = meaning.Command(rule.argument.name, thing)
    return meaning.Norm(rule.functor, act, sure, names.get("place"), before)


def rule_from_norm(said: meaning.Norm, speaker: str, heard: float = 1.0) -> Rule:
    """Return the rule that lays down a norm, discounted by the confidence of the recogniser."""
    act, before, target, argument = said.act, said.before, chosen_by(said.act), None
    names = {"place": said.place, "object": None}
    if isinstance(act, meaning.ToolCommand):
        names["material"] = None if act.patient == meaning.ANY_OBJECT else act.patient
    else:
        names["role"] = act.recipient
        argument = Atom("part", act.part) if act.part else None
    if before:
        argument, thing = Atom("action", before.goal), before.target.object
        names["object"] = thing if thing not in {None, meaning.ANY_OBJECT, target.object} else None
    return norm(
        said.norm,
        act.goal,
        target.object or meaning.ANY_OBJECT,
        argument,
        interval=Interval(*said.confidence).discounted(heard),
        contexts=[Atom(kind, name) for kind, name in names.items() if name],
        properties=target.props,
        speaker=speaker,
    )


def request_from_command(act: meaning.Act, speaker: str, tool_acts: Names | None = None) -> Request:
    """Return the request that a command, `act`, makes.

    A language fills in the use of a tool that nobody named (`tool_acts`); it counts as assumed.
    """
    if isinstance(act, meaning.ToolCommand):
        tool, patient = _target(act.tool), Target(object=act.patient)
        is_assumed = tool == Target(used_for=(tool_acts or {}).get(act.goal, ""))
        if tool.object is None and tool.material is None:
            tool = replace(tool, material=act.patient)
        arguments: dict[str, Argument] = {"patient": patient, "tool": tool}
        assumed = frozenset({"tool"} if is_assumed else ())
        return Request(act.goal, arguments, speaker, assumed=assumed)
    if isinstance(act, meaning.ActionCommand):
        targets = zip(PARAMETERS, map(_target, act.objects), strict=False)
        return Request(act.goal, dict(targets), speaker)
    arguments = {"object": _target(act.target)}
    if act.recipient:
        arguments["recipient"] = act.recipient
    return Request(act.goal, arguments, speaker, part=act.part)


def chosen_by(said: meaning.SimpleCommand) -> meaning.ObjectReference:
    """Return what a command lets Hilt choose: its tool, or else its object."""
    return said.tool if isinstance(said, meaning.ToolCommand) else said.target


def use_of(said: meaning.SimpleCommand) -> meaning.Question:
    """Return the question what has the use that a command asks for, if it asks for one."""
    target = chosen_by(said)
    use = target.used_for or target.not_used_for
    return meaning.Question("objects_for", affordance=use, material=target.material)


def declined(said: meaning.SimpleCommand) -> AnswerContent:
    """Return the answer to a command not to do something."""
    is_tool = isinstance(said, meaning.ToolCommand)
    name = said.patient if is_tool else said.target.object or said.target.used_for or "thing"
    return AnswerContent("will_not", {"goal": said.goal, "object": name}, "refused")


def action_words(known: actions.Actions, language: Language) -> Iterator[NewWord]:
    """Yield the words that name actions and that the language does not have yet.

    An action on a patient is done with a tool: "stir" comes with "used for stirring". Only a name
    that is one lower-case word can be said.
    """
    sayable = {*GOALS, *language.acts, *language.tool_acts}
    for name, tree in known.trees.items():
        if name in sayable or not name.islower() or not name.isalpha():
            continue
        is_use = "patient" in tree.parameters
        word = language.inflection.form(name, "ing") if is_use else name
        yield NewWord(word, "affordance" if is_use else "context", word)


def word_to_keep(word: NewWord, speaker: str) -> LearnedWord:
    """Return a new word as the base stores it."""
    return LearnedWord(Atom(KINDS.get(word.role, word.role), word.word), word.said, speaker)


def word_from_base(word: LearnedWord) -> NewWord:
    """Return a stored word as the language takes it."""
    return NewWord(word.atom.name, ROLES.get(word.atom.kind, word.atom.kind), word.said)


def word_for_person(name: str) -> NewWord:
    """Return the name of a speaker as a word, for "do you trust kim?"."""
    return NewWord(name.lower(), "person", name)


def _target(said: meaning.ObjectReference) -> Target:
    name = None if said.object == meaning.ANY_OBJECT else said.object
    return Target(name, said.used_for, said.not_used_for, frozenset(said.props), said.material)


def tree_from_definition(said: meaning.ActionDefinition, tool_acts: Names) -> actions.ActionTree:
    """Return the action tree of a definition; `tool_acts`: act -> the use its tool must have."""
    kinds = dict(zip(said.parameters, PARAMETERS, strict=False))
    return actions.ActionTree(
        said.action,
        tuple(kinds.values()),
        {},
        tuple(_step(each, kinds, tool_acts) for each in said.steps),
        tuple(_precondition(each, kinds) for each in said.only_if),
        tuple(_branch(each, kinds, tool_acts) for each in said.if_fails),
        objects={name: kind for kind, name in kinds.items()},
    )


def _step(act: meaning.Act, kinds: Names, tool_acts: Names) -> actions.Step:
    match act:
        case meaning.ToolCommand(goal, patient, tool):
            arguments = {"patient": _argument(meaning.ObjectReference(patient), kinds)}
            if tool != meaning.ObjectReference(used_for=tool_acts.get(goal, "")):
                arguments["tool"] = _argument(tool, kinds)
            return actions.Step(goal, arguments)
        case meaning.ActionCommand(goal, objects):
            given = (_argument(each, kinds) for each in objects)
            return actions.Step(goal, dict(zip(PARAMETERS, given, strict=False)))
        case _:
            arguments = {"object": _argument(act.target, kinds)}
            recipient = {"recipient": f"{actions.FIXED}{act.recipient}"} if act.recipient else {}
            return actions.Step(act.goal, arguments | recipient, act.part)


def _argument(said: meaning.ObjectReference, kinds: Names) -> str | actions.DescribedObject:
    if said.object and said.object in kinds and not said.props:
        return kinds[said.object]
    return _target(said)


def _precondition(said: meaning.ActionCondition, kinds: Names) -> actions.Precondition:
    parameter = kinds.get(said.object, f"{actions.FIXED}{said.object}")
    return actions.Precondition(said.state, parameter, said.property, said.negated)


def _branch(said: meaning.FailureReaction, kinds: Names, tool_acts: Names) -> actions.FailureBranch:
    following = PARAMETERS[0] if said.other else None
    steps = tuple(_step(each, kinds, tool_acts) for each in said.steps)
    return actions.FailureBranch(frozenset(said.after), following, said.again, steps)
