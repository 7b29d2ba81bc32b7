"""Lessons of actions: what a definition teaches, and what Hilt asks about steps it does not know.

A definition is stored as a whole or not at all: while one of its steps is unknown, it waits for the
answer to the question how that is done, which is a definition, too.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace

from ...inference.taxonomy import Taxonomy
from ...inference.types import Target
from ...kb.learned import TAUGHT_ACTIONS, TaughtAction
from ...kb.rule import Atom
from ...nlu.lexicon.vocabulary import NewWord
from ...nlu.offers.meaning_shapes import meaning_from_json
from ...nlu.semantics import meaning
from ...ontology.actions import Actions
from ..execution.outcome import AnswerContent
from ..execution.request import Request
from .conversation import Conversation, UnderstoodTurn
from .reply import Reply
from .translation import tree_from_definition


class ActionLessons:
    """Learns, lists and forgets actions that people teach, beside those that Hilt comes with."""

    def __init__(self, conversation: Conversation, actions: Actions) -> None:
        self._base, self._conversation, self._own = conversation.base, conversation, actions
        self.actions = actions
        self.read()

    def read(self) -> None:
        """Read the taught actions again."""
        found = {each.name: _definition_of(each) for each in self._base.actions()}
        definitions = {name: each for name, each in found.items() if name not in self._own.trees}
        uses = self._conversation.language.tool_acts
        trees = {name: tree_from_definition(each, uses) for name, each in definitions.items()}
        self.actions = replace(self._own, trees={**self._own.trees, **trees})
        frames = {n: d.all_links for n, d in definitions.items() if len(d.parameters) != 1}
        words = [NewWord(name, "context", name) for name in definitions]
        language = self._conversation.language.with_words(words)
        self._conversation.language = replace(language, frames=frames)

    def learn(self, turn: UnderstoodTurn, said: meaning.ActionDefinition) -> Reply:
        """Learn an action, or ask how its first unknown step is done."""
        conversation = self._conversation
        tree = tree_from_definition(said, conversation.language.tool_acts)
        actions = replace(self._own, trees={**self.actions.trees, said.action: tree})
        if said.action in actions.used_by(said.action):
            return conversation.answered(turn, "calls_itself", "refused", goal=said.action)
        acts = (*said.steps, *(step for each in said.if_fails for step in each.steps))
        if unknown := next((each for each in acts if each.goal not in actions.trees), None):
            return self._ask(turn, said, unknown)
        spoken = " ".join(map(conversation.say, self._echo(said)))
        nodes = tuple(each for each in actions.nodes if each.split("/")[0] == said.action)
        name, definition, text = Atom("action", said.action), said.as_json(), turn.understood.text
        taught = TaughtAction(name, json.dumps(definition), text, turn.speaker, nodes=nodes)
        conversation.believe(turn, (), spoken, turn.understood.new_words, actions=[taught])
        self.read()
        return conversation.reply(turn, spoken)

    def lacks_objects(self, request: Request) -> bool:
        """Whether a request names too few or too many objects for a taught action."""
        act = self.actions.trees.get(request.action)
        return bool(act and act.objects is not None and {*act.parameters} != {*request.arguments})

    def other_kind(self, request: Request, taxonomy: Taxonomy) -> Mapping[str, str] | None:
        """Return the slots of the question about an object of another kind than was told of."""
        tree = self.actions.trees.get(request.action)
        for parameter, kind in (tree.objects or {}).items() if tree else ():
            argument = request.arguments.get(parameter)
            name = argument.object if isinstance(argument, Target) else None
            if name and kind not in {meaning.ANY_OBJECT, *taxonomy.names_above("object", name)}:
                return {"goal": request.action, "other": kind, "object": name}
        return None

    def ask_how(self, turn: UnderstoodTurn, step: meaning.Act) -> Reply | None:
        """Ask how a command is carried out that is no known action; None if it is known."""
        return None if step.goal in self.actions.trees else self._ask(turn, None, step)

    def forget(self, turn: UnderstoodTurn, said: meaning.Retraction) -> Reply:
        """Forget a taught action, if it is the speaker's own; return the reply."""
        conversation, name = self._conversation, said.action or ""
        taught = {each.name: each for each in self._base.actions()}.get(name)
        if taught is None:
            return conversation.answered(turn, "cannot", "failed", goal=name)
        if taught.speaker != turn.speaker:
            return conversation.answered(turn, "not_yours", "failed", speaker=taught.speaker)
        spoken = conversation.say(AnswerContent("forgotten_action", {"goal": name}))
        self._base.forget(TAUGHT_ACTIONS, name, turn.understood.text, turn.speaker, answer=spoken)
        self.read()
        return conversation.reply(turn, spoken)

    def _ask(
        self, turn: UnderstoodTurn, said: meaning.ActionDefinition | None, unknown: meaning.Act
    ) -> Reply:
        conversation = self._conversation
        if isinstance(unknown, meaning.ToolCommand):
            names = [unknown.patient]
        else:
            is_taught = isinstance(unknown, meaning.ActionCommand)
            targets = unknown.objects if is_taught else (unknown.target,)
            names = [each.object or "thing" for each in targets]
        # What one does with any object of the kind: "rinse a mug".
        act = conversation.language.answers.act_on(unknown.goal, *names)

        def told(text: str) -> Reply | None:
            for each in (text, f"to {act}, {text}"):
                found = conversation.understand(each, turn.speaker, heard=turn.heard)
                meant = found.meaning
                if isinstance(meant, meaning.ActionDefinition) and meant.action == unknown.goal:
                    conversation.open_question = None
                    taught = self.learn(replace(turn, understood=replace(found, text=text)), meant)
                    if said is None or unknown.goal not in self.actions.trees:
                        return taught
                    after = self.learn(turn, said)
                    return replace(after, said=f"{taught.said} {after.said}")
            return None

        reply = conversation.answered(turn, "how_to_do", "asked", action=act)
        conversation.wait_for(turn, tell=told)
        return reply

    def _echo(self, said: meaning.ActionDefinition) -> Iterator[AnswerContent]:
        language = self._conversation.language
        frame = language.answers.act_on(said.action, *said.parameters, links=said.all_links)
        steps = tuple(map(language.generate, map(_about_a_thing, said.steps)))
        yield AnswerContent("learned_action", {"action": frame, "steps": steps})
        for each in said.only_if:
            if each.property:
                key = "required_not" if each.negated else "required"
                yield AnswerContent(key, {"object": each.object, "property": each.property})
        if said.if_fails:
            yield AnswerContent("learned_reaction")


def _definition_of(taught: TaughtAction) -> meaning.ActionDefinition:
    found = meaning_from_json(json.loads(taught.meaning))
    if not isinstance(found, meaning.ActionDefinition):
        raise TypeError(f"The meaning of {taught.name} is no action.")
    return found


def _about_a_thing(act: meaning.Act) -> meaning.Act:
    match act:
        case meaning.Command(target=meaning.ObjectReference(object=meaning.ANY_OBJECT, props=())):
            return replace(act, target=meaning.ObjectReference("thing"))
        case _:
            return act
