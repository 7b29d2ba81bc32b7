"""Norms in a conversation: laid down, lifted, asked about, and told when a command is refused.

A norm belongs to who said it. It can be lifted by that speaker, or by somebody who is trusted more.
A prohibition of the moment, "don't pass me the knife", holds for this conversation only.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import cast

from ...inference.node_rules import GRASP
from ...inference.norms import NormVerdict
from ...inference.types import Target
from ...kb.interval import CERTAIN
from ...kb.rdf.rule_mapping import rule_id
from ...kb.rule import NORMS, OBLIGED, PERMITTED, Rule
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ...ontology.errors import UnknownNameError
from ...ontology.vocabulary import Iri
from ..execution.outcome import AnswerContent, GoalResult
from ..execution.request import Request
from .conversation import Answered, Conversation, UnderstoodTurn, spoken
from .reply import Reply
from .translation import chosen_by, request_from_command, rule_from_norm

MOST_LISTED = 8


class NormDialogue:
    """What is forbidden, obliged and permitted in a conversation; `judge` applies the norms."""

    def __init__(self, conversation: Conversation, judge: Callable[[Request], NormVerdict]) -> None:
        self._base, self._conversation, self._judge = conversation.base, conversation, judge
        self._momentary: dict[str, tuple[Rule, Understanding]] = {}

    # --- Laid down and lifted -------------------------------------------------------------------

    def lay_down(self, turn: UnderstoodTurn, said: meaning.NormStatement) -> Reply:
        """Keep norms, and return the reply that says what they are."""
        conversation = self._conversation
        rules = [rule_from_norm(each, turn.speaker, turn.heard) for each in said.norms]
        contrary = [(new, old) for new in rules for old in self._contrary(new)]
        for new, old in contrary:
            if new.functor == PERMITTED and not conversation.people.may_end(turn.speaker, old):
                return conversation.spoken(turn, self._told("not_yours_to_lift", old))
        opposite = [old.id for new, old in contrary if _is_ended_by(old, new)]
        opposite += [old.id for new in rules for old in self._denials_lifted(new, turn.speaker)]
        active = {old.id for new in rules for old in self._base.rules_at_nodes([new.node])}
        key = "known_already" if all(rule.id in active for rule in rules) else "learned"
        described = tuple(map(conversation.describe, rules))
        text = conversation.say(spoken(key, rules=described, speaker=turn.speaker))
        conversation.believe(turn, rules, text, turn.understood.new_words, supersedes=opposite)
        for key, (rule, _) in list(self._momentary.items()):
            if any(rule.context == new.context and rule.features == new.features for new in rules):
                del self._momentary[key]
        return conversation.lesson_reply(turn, rules, text)

    def _contrary(self, new: Rule) -> list[Rule]:
        keys = [f"{action}.{functor}" for action in {new.context, GRASP} for functor in NORMS]
        return [
            old
            for old in self._base.rules_at_nodes(keys)
            if (old.functor == PERMITTED) is not (new.functor == PERMITTED)
            and old.features <= new.features
            and {each for each in old.contexts if each.kind != "action"} <= new.contexts
            and _is_contrary_argument(old, new)
        ]

    def _denials_lifted(self, new: Rule, speaker: str) -> Iterator[Rule]:
        """Yield the rules against holding an object by a part that is permitted from now on."""
        if new.functor == PERMITTED and new.part and new.object and len(new.contexts) == 1:
            told = self._base.rules(object=new.object, context=new.context, part=new.part)
            may_end = self._conversation.people.may_end
            yield from (each for each in told if not each.asserts and may_end(speaker, each))

    # --- Prohibitions of the moment -------------------------------------------------------------

    def forbid(self, turn: UnderstoodTurn, said: meaning.SimpleCommand) -> Reply:
        """Keep for good that something must not be done: "never give me the knife"."""
        usual, acts = self._conversation.language.usual, self._named_acts(said)
        norms = tuple(meaning.Norm("forbidden", replace(a, negated=False), usual) for a in acts)
        return self.lay_down(turn, meaning.NormStatement(norms))

    def forbid_for_now(self, turn: UnderstoodTurn, said: meaning.SimpleCommand) -> None:
        """Keep in mind that something must not be done in this conversation."""
        for act in self._named_acts(said):
            norm = meaning.Norm("forbidden", replace(act, negated=False), (1.0, 1.0))
            rule = rule_from_norm(norm, turn.speaker)
            self._momentary[rule.id] = (rule, turn.understood)

    def _named_acts(self, said: meaning.SimpleCommand) -> list[meaning.SimpleCommand]:
        target = chosen_by(said)
        if target.object:
            return [said]
        if isinstance(said, meaning.ToolCommand):  # with any tool
            return [replace(said, tool=meaning.ObjectReference(meaning.ANY_OBJECT))]
        rules = self._base.rules(affordance=target.used_for)
        used = (rule.object for rule in rules if rule.asserts)
        named = dict.fromkeys(filter(None, used)) or [meaning.ANY_OBJECT]
        return [replace(said, target=meaning.ObjectReference(name)) for name in named]

    @property
    def momentary(self) -> tuple[Rule, ...]:
        """The prohibitions of this conversation."""
        return tuple(rule for rule, _ in self._momentary.values())

    def lift(self, request: Request) -> Request:
        """Return a request without the prohibitions of the moment that are no longer heeded."""
        for lifted in request.unheeded & self._momentary.keys():
            del self._momentary[lifted]
        return replace(request, momentary=self.momentary)

    # --- Commands that are refused ---------------------------------------------------------------

    def with_reason(self, result: GoalResult) -> GoalResult:
        """Return a result whose answer says which norm forbids it, and who said it."""
        verdict = result.forbidding
        rule = verdict.forbidding if verdict else None
        if verdict is None or rule is None:
            return result
        slots = result.answer.slots
        key = "prohibited" if rule.id in self._momentary else result.answer.key
        if verdict.first:
            named = next((atom.name for atom in rule.contexts if atom.kind == "object"), None)
            slots = {**slots, "first": verdict.first.name, "thing": named or str(slots["object"])}
            key = "comes_first"
        slots = {**slots, **self._told(key, rule).slots, "property": " ".join(verdict.unseen)}
        ending = "refused" if key == "forbidden" else "asked"
        return replace(result, answer=replace(result.answer, key=key, slots=slots, ending=ending))

    def first_request(self, request: Request, result: GoalResult) -> Request | None:
        """Return the request for what must be done before another one; None for nothing."""
        if not (first := result.answer.slots.get("first")) or result.answer.ending != "asked":
            return None
        about = {"object": Target(object=str(result.answer.slots["thing"]))}
        return replace(request, action=str(first), arguments=about, part=None, assumed=frozenset())

    def _told(self, key: str, rule: Rule) -> AnswerContent:
        _, said = self._momentary.get(rule.id, (rule, None))
        text = said.text if said else self._conversation.words_of(rule)
        return AnswerContent(key, {"speaker": rule.speaker, "texts": (text,)}, "refused")

    # --- Questions -------------------------------------------------------------------------------

    def answer(self, turn: UnderstoodTurn, asked: meaning.Question) -> Answered | None:
        """Return the answer to a question about norms; None where it asks for something else."""
        if asked.ask != "forbidden":
            return self._permission(turn, asked.norm) if asked.norm else None
        rows = self._base.answer("forbidden").rows
        rules = [self._base.rule(rule_id(cast(Iri, row[-1]))) for row in rows][:MOST_LISTED]
        said = tuple(map(self._conversation.quote, (*rules, *self.momentary)))
        return spoken("about" if said else "nothing_forbidden", done=True, rules=said), tuple(rules)

    def _permission(self, turn: UnderstoodTurn, norm: meaning.Norm) -> Answered:
        tools = self._conversation.language.tool_acts
        request = request_from_command(norm.act, turn.speaker, tools)
        named = rule_from_norm(norm, turn.speaker).contexts
        contexts = {atom: CERTAIN for atom in named if atom.kind == "place"}
        try:
            verdict = self._judge(replace(request, contexts=contexts, momentary=self.momentary))
        except UnknownNameError:
            return spoken("cannot", goal=request.action), ()
        if rule := verdict.forbidding:
            told = self._told("may_not", rule)
            return replace(told, ending="done"), (rule,) if rule.utterance else ()
        return spoken("may", done=True), ()


def _is_ended_by(old: Rule, new: Rule) -> bool:
    """Whether a norm ends an earlier one: what may be used may also be touched."""
    is_wider = (old.context, new.context, new.functor) == (GRASP, "use", PERMITTED)
    is_there = old.contexts == new.contexts or (is_wider and len(old.contexts | new.contexts) == 2)
    return is_there and (old.features, old.argument) == (new.features, new.argument)


def _is_contrary_argument(old: Rule, new: Rule) -> bool:
    """Whether a permission and another norm are at odds: holding as a duty wants is not."""
    duty = next((rule for rule in (old, new) if rule.functor == OBLIGED), None)
    if duty and duty.part:
        return None not in {old.part, new.part} and old.part != new.part
    return old.argument in {None, new.argument}
