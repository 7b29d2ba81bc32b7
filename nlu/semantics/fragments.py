"""Fragments: what is said instead of a sentence completes the last rule, question or command.

"And a mug?", "the same for spoons", "by the handle, I mean", "to Kim", "what about passing it?":
each names a value for one slot of the last meaning, and takes all else from it. A fragment is
refused when that meaning has no such slot.
"""

from dataclasses import dataclass, replace

from . import meaning as meanings
from .discourse import Discourse
from .meaning import ActionRule, FunctionalRule, ObjectReference, Question
from .predicates import UninterpretableError

_OF_OBJECTS = {"objects_for", "best_for"}
_OF_USES = {"uses_of", "about", "how", "see"}


@dataclass(frozen=True)
class FragmentValues:
    """The values that a fragment names: for one slot, and perhaps a degree of confidence."""

    mode: str  # that of its predicate, as `predicates.yaml` says
    default: meanings.Confidence  # the confidence of a rule without a degree
    asks: bool = False  # whether it is a question
    is_request: bool = False  # whether it says "please"
    is_other: bool = False  # whether its target was only named as the other one of two
    target: ObjectReference | None = None
    use: str | None = None
    material: str | None = None
    part: str | None = None
    part_of: str | None = None
    context: str | None = None
    recipient: str | None = None
    tool: ObjectReference | None = None
    confidence: meanings.Confidence | None = None

    @property
    def adds(self) -> bool:
        """Whether it leaves what was said before as it is."""
        return self.mode in {"also", "same", "too"}


def complete(fragment: FragmentValues, discourse: Discourse) -> meanings.Meaning:
    """Return the meaning of a fragment; `UninterpretableError` if no turn is completed by it."""
    found = _complete(fragment, discourse.accessible)
    is_added = isinstance(found, meanings.Statement) and fragment.mode != "instead"
    # What is added to a rule that nobody has confirmed is asked about, too.
    return meanings.AskBack(choices=(found,)) if is_added and discourse.is_offered else found


def _complete(fragment: FragmentValues, discourse: Discourse) -> meanings.Meaning:  # noqa: PLR0911, PLR0912
    if fragment.mode == "keep":
        return _kept(fragment, discourse)
    if fragment.mode == "like":
        return _alike(fragment, discourse)
    if fragment.mode == "ask" and not fragment.asks:
        if not isinstance(discourse.last, meanings.Command):
            raise UninterpretableError("not_a_rule")
        return _as_command(fragment, discourse.last, discourse)
    if fragment.mode == "again":
        if discourse.command is None:
            raise UninterpretableError("nothing_to_repeat", asks=True)
        return discourse.command
    other = _other_of_pair(discourse)
    if other and isinstance(discourse.last, Question) and _is_other(fragment):
        fragment = replace(fragment, target=ObjectReference(other), asks=True, is_other=True)
    completed, rule = _completed(fragment, discourse), discourse.rule
    if discourse.asks_why and fragment.asks and isinstance(rule, ActionRule):
        completed = Question("how", object=rule.object, context=rule.context)
    kinds = (Question, FunctionalRule) if fragment.asks else (Question,)
    if fragment.tool and isinstance(completed, kinds) and completed.affordance:
        fragment = replace(fragment, target=fragment.tool)
    if fragment.target and fragment.use and not isinstance(completed, FunctionalRule):
        raise _nothing()
    if fragment.material and not fragment.use:
        is_use = isinstance(completed, (FunctionalRule, Question))
        if not is_use or not (completed.material or fragment.confidence):
            raise _nothing()
        fragment = replace(fragment, use=completed.affordance)
    wished = fragment.target if fragment.is_request and not fragment.asks else None
    match completed:
        case FunctionalRule() | ActionRule() | Question() if wished:  # "now the hammer, please"
            return meanings.Command("pass", wished)
        case FunctionalRule() | ActionRule() as rule:
            return _as_rule(fragment, rule)
        case Question() as question:
            return _as_question(fragment, question)
        case meanings.Norm(act=meanings.Command() as act) as norm if fragment.adds:
            return _as_norm(fragment, norm, act)
        case meanings.Command() as command if fragment.target or not fragment.asks:
            return _as_command(fragment, command, discourse)
        case meanings.ToolCommand() as command if not fragment.asks and (
            fragment.target or fragment.tool
        ):
            patient = _kind(fragment.target)[0] if fragment.target else command.patient
            return replace(command, patient=patient, tool=fragment.tool or command.tool)
        case meanings.Command() | meanings.ToolCommand():
            raise UninterpretableError("as_question", asks=True)
        case None if fragment.mode == "ask" and fragment.target:
            return Question("about", object=_kind(fragment.target)[0])
        case _:
            raise _nothing()


def _alike(fragment: FragmentValues, discourse: Discourse) -> meanings.Meaning:
    """Return the last rule, which is on the thing of a fragment, for the thing asked about."""
    rule, asked = discourse.rule, discourse.last
    if not isinstance(asked, Question) or asked.object is None or fragment.target is None:
        raise _nothing()
    is_of_kind = isinstance(rule, FunctionalRule if asked.context is None else ActionRule)
    is_named = fragment.target.object != meanings.ANY_OBJECT  # "the same as a pan"
    if rule is None or not is_of_kind or rule.object == asked.object:
        raise _nothing()
    if is_named and rule.object != _kind(fragment.target)[0]:
        raise _nothing()
    if isinstance(rule, ActionRule) and asked.context:
        rule = replace(rule, context=asked.context)
    rule = replace(rule, confidence=fragment.confidence or rule.confidence)
    return _offered(replace(rule, object=asked.object, props=(), revises=False))


def _is_other(fragment: FragmentValues) -> bool:
    target = fragment.target
    return bool(target and target.object and target == ObjectReference(target.object, other=True))


def _other_of_pair(discourse: Discourse) -> str | None:
    pair = discourse.pair
    others = [each for each in pair if each != discourse.object and not each.arguments]
    return others[0].said if len(pair) == 2 and len(others) == 1 else None


def _completed(
    fragment: FragmentValues, discourse: Discourse
) -> meanings.Rule | Question | meanings.SimpleCommand | meanings.Norm | None:
    rule, last = discourse.rule, discourse.last
    is_why = isinstance(last, Question) and last.ask == "why" and fragment.asks
    if isinstance(last, Question) and discourse.command and (_is_other(fragment) or is_why):
        last = discourse.command  # "why that one?", "no, the other one"
    if fragment.context and fragment.part:  # how the object of the last rule is held
        return rule if rule == last and isinstance(rule, ActionRule) else None
    if fragment.mode == "same" and not fragment.asks:
        is_rule = rule and not isinstance(last, (meanings.SimpleCommand, meanings.Norm))
        return rule if is_rule else last
    asked = {last.object, last.context} if isinstance(last, Question) and fragment.part else {None}
    told = {None, getattr(rule, "object", None), getattr(rule, "context", None)}
    if rule is None or fragment.adds or fragment.asks or not asked <= told:  # asks of another
        return last if last is not None else rule
    if fragment.confidence and not (fragment.target or fragment.use or fragment.part):
        return last if isinstance(last, Question) and last.ask == "is_used_for" else rule
    if fragment.mode == "instead" and (fragment.part or fragment.use):
        # A correction is about the rule that was applied, unless the command named the part itself.
        is_kind = type(rule) is (ActionRule if fragment.part else FunctionalRule)
        is_rule = not isinstance(last, meanings.Command) or (
            is_kind and last.part is None and last.target.object in {None, rule.object}
        )
        return rule if is_rule else last
    return last


def _kept(fragment: FragmentValues, discourse: Discourse) -> meanings.Meaning:
    sure, act, thing = fragment.confidence, fragment.context, fragment.target
    match discourse.last:
        case meanings.Command(part=str(part), negated=False) as last if discourse.object:
            name, props = last.target.object or discourse.object.said, last.target.props
            if thing and (act, thing.object) != (last.goal, name):
                raise UninterpretableError("nothing_to_keep")
            return _offered(ActionRule(name, last.goal, part, sure or fragment.default, props))
        case FunctionalRule() | ActionRule() as rule if act is None:
            return meanings.Statement((replace(rule, revises=False),))
        case _:
            raise UninterpretableError("nothing_to_keep")


def _as_rule(fragment: FragmentValues, rule: meanings.Rule) -> meanings.Meaning:
    if fragment.asks and fragment.context and fragment.target:
        return Question("how", object=_kind(fragment.target)[0], context=fragment.context)
    if fragment.mode == "fill" and fragment.use:
        raise _nothing()  # it may add to the rule or correct it
    is_contrast = fragment.mode == "instead" and fragment.target and fragment.confidence
    if is_contrast and not rule.denies:  # "no, a knife is" is as sure as what it corrects
        fragment = replace(fragment, confidence=None)
    changed = _changed(fragment, rule)
    if fragment.asks:
        return question_on(changed)
    if rule.denies and fragment.part and not fragment.adds and not fragment.confidence:
        # Another part is held then, but only "by the handle" may also deny it.
        instead = replace(changed, confidence=fragment.default)
        return meanings.Statement((instead,)) if fragment.part_of else _offered(instead)
    is_same = replace(changed, confidence=rule.confidence) == rule
    adds = fragment.adds or (is_contrast and rule.denies)  # "a spoon is not, a hammer is"
    return meanings.Statement((replace(changed, revises=is_same or not adds),))


def _changed(fragment: FragmentValues, rule: meanings.Rule) -> meanings.Rule:
    if fragment.confidence:
        rule = replace(rule, confidence=fragment.confidence)
    if fragment.target:
        name, props = _kind(fragment.target)
        rule = replace(rule, object=name, props=props)
        if fragment.context is None and fragment.part is None and fragment.use is None:
            return rule
    match rule:
        case FunctionalRule() if fragment.use:
            return replace(rule, affordance=fragment.use, material=fragment.material)
        case ActionRule() if fragment.part:
            if fragment.part_of not in {None, rule.object}:
                second = str(fragment.part_of)
                raise UninterpretableError("two_objects", first=rule.object, second=second)
            return replace(rule, part=fragment.part, context=fragment.context or rule.context)
        case ActionRule() if fragment.context:
            return replace(rule, context=fragment.context)
        case ActionRule() if fragment.use and fragment.adds:
            raise UninterpretableError("not_a_rule")
        case _ if fragment.confidence and not (fragment.use or fragment.part or fragment.context):
            return rule
        case _:
            raise _nothing()


def question_on(rule: meanings.Rule, ask: str = "is_used_for") -> Question:
    """Return a question on a rule; whether something is held so is answered as how it is held."""
    if isinstance(rule, FunctionalRule):
        return Question(ask, rule.object, rule.affordance, material=rule.material)
    ask = "how" if ask == "is_used_for" else ask
    return Question(ask, object=rule.object, context=rule.context, part=rule.part)


def _as_question(  # noqa: PLR0911 - a case per slot
    fragment: FragmentValues, question: Question
) -> Question | meanings.AskBack:
    if fragment.recipient:
        raise _nothing()
    about, use, material = question.object, question.affordance, question.material
    if fragment.confidence and not (fragment.part and question.context):
        return _offered(_as_answer(fragment, question, fragment.confidence))
    if fragment.target:
        name, props = _kind(fragment.target)
        if (fragment.mode == "too" or fragment.tool) and not fragment.asks and use:
            return _offered(FunctionalRule(name, use, fragment.default, props, material=material))
        if props or fragment.part:
            raise UninterpretableError("one_thing_at_a_time")
        if fragment.context:
            return Question("how", object=name, context=fragment.context)
        if fragment.asks and question.ask in _OF_OBJECTS and fragment.is_other:
            return Question("uses_of", object=name)
        ask = "is_used_for" if question.ask in _OF_OBJECTS else question.ask
        prop = question.property if ask == "state" else None
        return replace(question, ask=ask, object=name, part=None, property=prop)
    if fragment.use:
        if question.ask not in _OF_USES and use is None:
            raise _nothing()
        ask = "is_used_for" if question.ask in _OF_USES and about else question.ask
        question = replace(question, ask=ask, context=None, part=None)
        return replace(question, affordance=fragment.use, material=fragment.material)
    if about is None or question.context is None or fragment.part is None:
        raise _nothing()
    if fragment.asks:
        return replace(question, part=fragment.part)
    sure = fragment.confidence or fragment.default
    return _offered(ActionRule(about, question.context, fragment.part, sure))


def _as_answer(
    fragment: FragmentValues, question: Question, sure: meanings.Confidence
) -> FunctionalRule:
    about, props = _kind(fragment.target) if fragment.target else (question.object, ())
    use, material = fragment.use or question.affordance, question.material
    if about is None or use is None or fragment.part:
        raise _nothing()
    material = fragment.material if fragment.use else material
    return FunctionalRule(about, use, sure, props, material=material)


def _offered(rule: meanings.Rule) -> meanings.AskBack:
    return meanings.AskBack(choices=(meanings.Statement((rule,)),))


def _as_command(  # noqa: PLR0911 - a case per slot
    fragment: FragmentValues, command: meanings.Command, discourse: Discourse
) -> meanings.Command | Question | meanings.AskBack:
    anew, target = replace(command, part=None, negated=False), fragment.target or fragment.tool
    if fragment.asks and target:
        if command.target.object is None:  # Hilt chose the object, and is asked for its reason
            return Question("why_not", object=_kind(target)[0])
        return meanings.AskBack(choices=(replace(anew, target=target),))
    other = _other_of_pair(discourse)
    if (
        fragment.mode in {"also", "other"}
        and _is_other(fragment)
        and other
        and command.target.object in {each.said for each in discourse.pair}
    ):
        return meanings.AskBack(choices=(replace(anew, target=ObjectReference(other)),))
    if fragment.context and command.part:  # "when you pick it up, I mean"
        name, props = _kind(command.target)
        return _offered(ActionRule(name, fragment.context, command.part, fragment.default, props))
    if fragment.context:
        command = replace(command, goal=fragment.context, recipient=None)
    if target:
        is_described = fragment.mode == "other" and command.target.object is None
        if target.object == meanings.ANY_OBJECT or is_described:
            props = target.props or command.target.props
            target = replace(command.target, props=props, other=target.other)
        is_not = fragment.confidence is not None and fragment.confidence[1] < meanings.LIKELY
        if fragment.confidence and not is_not:
            raise _nothing()
        return replace(command, target=target, part=fragment.part, negated=is_not)
    if fragment.part and fragment.confidence:  # "not by the handle"
        name, props = _kind(command.target)
        return _offered(ActionRule(name, command.goal, fragment.part, fragment.confidence, props))
    if fragment.part and fragment.part_of in {None, command.target.object}:
        return replace(command, part=fragment.part)
    if fragment.recipient and command.goal == "pass":
        is_speaker = fragment.recipient == "me"
        return replace(command, recipient=None if is_speaker else fragment.recipient)
    if fragment.use and command.target.used_for:
        target = replace(command.target, used_for=fragment.use, material=fragment.material)
        return replace(command, target=replace(target, other=False))
    raise _nothing()


def _as_norm(said: FragmentValues, norm: meanings.Norm, act: meanings.Command) -> meanings.Meaning:
    is_denied = said.confidence is not None and said.confidence[1] < meanings.LIKELY
    is_other = said.confidence and not (is_denied and norm.norm == "forbidden")
    if is_other or not (said.target or said.recipient):
        raise _nothing()
    target, recipient = said.target or act.target, said.recipient or act.recipient
    norm = replace(norm, act=replace(act, target=target, recipient=recipient))
    if said.asks:
        return Question("may", norm=replace(norm, norm="permitted"))
    return meanings.NormStatement((norm,))


def _kind(target: ObjectReference) -> tuple[str, tuple[str, ...]]:
    if target.object is None or target.other:
        raise UninterpretableError("one_thing_at_a_time")
    return target.object, target.props


def _nothing() -> UninterpretableError:
    return UninterpretableError("nothing_to_correct", asks=True)
