"""Interpretation of predicate forms as meanings: rules, commands, questions, corrections, replies.

A form must express exactly one meaning that Hilt has; otherwise it is rejected with a reason. No
part of a form is ever dropped to make it fit.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..lexicon.vocabulary import NewWord
from . import meaning as meanings
from .discourse import SOMETHING, Discourse
from .fragments import FragmentValues, complete, question_on
from .meaning import ANY_OBJECT, ObjectReference, Question
from .predicates import PredicateForm, UninterpretableError, UnlearnableError, load_predicates

GOALS = ("pass", "pickUp", "pointTo", "grasp", "use", "putDown", "putBack", "release")

_UNLEARNABLE = {"noPast": "no_past", "noRule": "not_a_rule"}  # each with its answer
_CHOICES = {"noneOf": "none", "anyOf": "any", "unsure": "unknown"}
_EXPLAINED = frozenset({"holding", "graspObject", *GOALS})
_NAMELESS = frozenset({"self", "speaker", "someone", "it", "both", "butNot"})

KIND_FORMS = frozenset({"kindOf", "isA"})
"""The forms of "a knife is a kind of tool" and of "a knife is a tool"."""


@dataclass(frozen=True)
class Interpreter:
    """Maps predicate forms to meanings, with the interval of each degree of confidence."""

    intervals: Mapping[str, meanings.Confidence]
    tool_acts: Mapping[str, str]  # done with a tool, each with the affordance of the tool
    acts: frozenset[str]  # further acts on one object that were learned
    new_acts: frozenset[str] = frozenset()  # the acts that new words of an utterance name
    is_general: bool = False  # whether commands may be about any object, as in norms

    def with_words(self, words: Sequence[NewWord]) -> "Interpreter":
        """Return this interpreter with the acts that new words name."""
        acts = frozenset(word.word for word in words if word.role == "context")
        return replace(self, new_acts=acts) if acts else self

    def meaning(self, intention: PredicateForm, discourse: Discourse) -> meanings.Meaning:  # noqa: PLR0911
        """Return the meaning of an intention, such as `want(sam,pass(self,knife))`.

        A fragment refers to the last rule, question or command of the discourse. What Hilt can
        neither believe nor do nor answer is an `UninterpretableError`.
        """
        content = intention.arguments[-1]
        match intention.name:
            case "wantAmend":
                return self._fragment(content, discourse)
            case "wantBelieve" if content.name in load_predicates().fragments:
                return self._fragment(content, discourse)
            case "wantBelieve" if content.name in _UNLEARNABLE:
                raise UnlearnableError(_UNLEARNABLE[content.name])
            case "wantBelieve" if content.name in {"topic", "shown"}:
                return _spoken_of(content)
            case "wantBelieve" if content.name == "stateOf":
                return _state(content)
            case "wantBelieve" if content.name == "supposing":  # it may be said of now only
                return meanings.AskBack(choices=(self._statement(content.arguments[0]),))
            case "wantBelieve":
                return self._statement(content)
            case "want" if content.name == "and" and all(each.name != "not" for each in content):
                return meanings.Plan(tuple(map(self.command, content.arguments)))
            case "want":
                return self.command(content)
            case "wantKnow":
                return self._question(content)
            case "wantRevise":
                return self._correction(content, discourse)
            case _:
                return meanings.Acknowledgement(content.name)

    def _statement(self, form: PredicateForm) -> meanings.Statement | meanings.KindStatement:
        if form.name == "and" and form.arguments[0].name == "graspObject":
            order, rule = form.arguments
            part, target = self._part_of_object(order.arguments[1])
            usual = self.intervals["high"]
            held = meanings.ActionRule(target.object or "", "grasp", part, usual, target.props)
            is_denied = meanings.is_contradictory((held, *self._rules(rule)))
            key = "contradiction" if is_denied else "one_thing_at_a_time"
            raise UninterpretableError(key, asks=is_denied)
        said = self._stated(form)
        if len({rule.source for rule in said.rules}) > 1:
            raise UninterpretableError("whose_words", asks=True)
        if isinstance(said, meanings.Statement) and meanings.is_contradictory(said.rules):
            raise UninterpretableError("contradiction", asks=True)
        return said

    def _stated(self, form: PredicateForm) -> meanings.Statement | meanings.KindStatement:
        said = dict.fromkeys(self._rules(form))
        kinds = tuple(each for each in said if isinstance(each, meanings.KindRelation))
        rules = tuple(each for each in said if not isinstance(each, meanings.KindRelation))
        if kinds and rules:
            raise UninterpretableError("not_a_rule")
        return meanings.KindStatement(kinds) if kinds else meanings.Statement(rules)

    def _rules(self, form: PredicateForm) -> Iterator[meanings.Rule | meanings.KindRelation]:
        if form.name == "and":
            for part in form.arguments:
                yield from self._rules(part)
        elif form.name == "says":
            person, content = form.arguments
            for rule in self._rules(content):
                if rule.source:
                    raise UninterpretableError("whose_words", asks=True)
                yield replace(rule, source=name_of(person))
        elif form.name in KIND_FORMS:
            thing, kind, degree = form.arguments
            named = [part for part in thing if part.name == "having" or not part.arguments]
            for each in named if thing.name == "both" else (thing,):
                (name, props), above = kind_and_properties(each), _kind(kind)
                if props or ANY_OBJECT in {name, above} or name == above:
                    raise UninterpretableError("of_which_object", asks=True)
                yield meanings.KindRelation(above, name, self.intervals[degree.name])
        elif form.name != "implies":
            raise UninterpretableError("not_a_rule")
        elif form.arguments[1].name == "graspObject":
            yield self._action_rule(form)
        else:
            yield self._functional_rule(form)

    def _correction(self, form: PredicateForm, discourse: Discourse) -> meanings.Meaning:  # noqa: PLR0911 - a case per form
        if form.name == "retractAbout":
            return meanings.Retraction(about=kind_and_properties(form.arguments[0])[0])
        if form.name == "retractPart":
            return meanings.Retraction(part=part_and_owner(form.arguments[0])[0])
        if form.name in {"retract", "retractTold"} and not form.arguments:
            return meanings.Retraction(is_of_told=form.name == "retractTold")
        if form.name == "retract":
            return meanings.Retraction(self._one_rule(form.arguments[0]))
        if form.name == "correct" and form.arguments[0].name == "stateOf":
            return _state(form.arguments[0])
        if form.name == "correct" and form.arguments[0].name in {"implies", "and", *KIND_FORMS}:
            return meanings.with_rules(self._stated(form.arguments[0]), revises=True)
        return self._fragment(form, discourse)

    def _fragment(self, form: PredicateForm, discourse: Discourse) -> meanings.Meaning:
        asks = form.name == "asked"
        said = form.arguments[0] if asks else form
        around = list[str]()
        while said.name in {"too", "requested"}:
            around.append(said.name)
            said = said.arguments[0]
        is_too = "too" in around
        slot, mode = load_predicates().fragments.get(said.name, ("part", "instead"))
        mode = "too" if is_too and mode not in {"also", "same"} else mode
        value, *degree = said.arguments
        fragment = FragmentValues(mode, self.intervals["high"], asks, "requested" in around)
        fragment = self._filled(fragment, slot, value)
        if slot in {"held", "act", "used"}:
            second = "use" if slot == "used" else "part"
            fragment = self._filled(fragment, second, degree.pop())
        if degree:
            fragment = replace(fragment, confidence=self.intervals[degree[0].name])
        return complete(fragment, discourse)

    def _filled(self, fragment: FragmentValues, slot: str, value: PredicateForm) -> FragmentValues:
        match slot:
            case "target" | "held" | "used":
                fragment = replace(fragment, target=self._reference(value))
            case "use":
                affordance, material = _use(value)
                fragment = replace(fragment, use=affordance, material=material)
            case "material":
                fragment = replace(fragment, material=_kind(value))
            case "tool":
                fragment = replace(fragment, tool=self._reference(value))
            case "part":
                part, owner = part_and_owner(value)
                part_of = kind_and_properties(owner)[0] if owner else None
                fragment = replace(fragment, part=part, part_of=part_of)
            case "context" | "act":
                if not self.is_act_on_object(value.name):
                    raise UninterpretableError("no_act")
                target = self._reference(value.arguments[1])
                fragment = replace(fragment, context=value.name, target=target)
            case "recipient":
                fragment = replace(fragment, recipient=name_of(value))
            case "degree":
                fragment = replace(fragment, confidence=self.intervals[value.name])
            case _:  # the whole
                pass
        return fragment

    def command(self, form: PredicateForm) -> meanings.SimpleCommand:
        """Return the command of a form such as `pass(self,knife)`; else `UninterpretableError`."""
        if form.name == "not":
            return replace(self.command(form.arguments[0]), negated=True)
        if form.name == "holding":
            command = self.command(form.arguments[0])
            part, owner = part_and_owner(form.arguments[1])
            if not isinstance(command, meanings.Command) or command.part is not None:
                raise UninterpretableError("one_thing_at_a_time")
            if owner and self._reference(owner) != command.target:
                raise UninterpretableError("one_thing_at_a_time")
            return replace(command, part=part)
        if form.name == "graspObject":
            part, target = self._part_of_object(form.arguments[1])
            return meanings.Command("grasp", target, part=part)
        if form.name in self.tool_acts:
            return self._tool_command(form)
        most = 3 if form.name == "pass" else 2
        if not self.is_act_on_object(form.name) or not 2 <= len(form.arguments) <= most:
            raise UninterpretableError("no_act" if self.is_general else "one_thing_at_a_time")
        target = self._reference(form.arguments[1])
        if target == ObjectReference(ANY_OBJECT, other=True):
            raise UninterpretableError("which_thing", asks=True)
        recipient = name_of(form.arguments[2]) if len(form.arguments) > 2 else None
        return meanings.Command(form.said, target, recipient=recipient)

    def is_act_on_object(self, name: str) -> bool:
        """Return whether a name is that of an act on one object."""
        said = name.replace("_", " ")
        return name in GOALS or said in self.acts or said in self.new_acts

    def _reference(self, form: PredicateForm) -> ObjectReference:
        said: dict[str, list[PredicateForm]] = {"having": [], "used": [], "other": []}
        while form.name in {"having", "usedFor", "notUsedFor", "other"}:
            said["used" if form.name.endswith("For") else form.name].append(form)
            form = form.arguments[0]
        used_for, other = said["used"], bool(said["other"])
        props = tuple(sorted({name_of(each.arguments[1]) for each in said["having"]}))
        if len(used_for) > 1 or (used_for and form.name not in SOMETHING):
            raise UninterpretableError("object_or_use")
        if used_for:
            affordance, material = _use(used_for[0].arguments[1])
            uses = (affordance, None) if used_for[0].name == "usedFor" else (None, affordance)
            return ObjectReference(None, *uses, props, material, other)
        if form.name in SOMETHING and not (props or other or self.is_general):
            raise UninterpretableError("which_thing", asks=True)
        return ObjectReference(object=kind_and_properties(form)[0], props=props, other=other)

    def _part_of_object(self, form: PredicateForm) -> tuple[str, ObjectReference]:
        if form.name != "partOf":
            raise UninterpretableError("no_part_named")
        return name_of(form.arguments[0]), self._reference(form.arguments[1])

    def _tool_command(self, form: PredicateForm) -> meanings.ToolCommand:
        patient, props = kind_and_properties(form.arguments[1])
        if (props or patient == ANY_OBJECT) and not self.is_general:
            raise UninterpretableError("on_what", asks=True, goal=form.name)
        if props:
            raise UninterpretableError("one_thing_at_a_time")
        if len(form.arguments) < 3 or form.arguments[2].name in SOMETHING:
            tool = ObjectReference(used_for=self.tool_acts[form.name])
        else:
            tool = self._reference(form.arguments[2])
        if patient == tool.object:  # "poke the leather with it"
            raise UninterpretableError("which_thing", asks=True)
        return meanings.ToolCommand(form.name, patient, tool)

    def _one_rule(
        self, form: PredicateForm, problem: str = "one_rule_at_a_time"
    ) -> meanings.Rule | meanings.KindRelation:
        rule, *others = self._rules(form)
        if others:
            raise UninterpretableError(problem)
        return rule

    def _functional_rule(self, form: PredicateForm) -> meanings.FunctionalRule:
        noun, use, degree = form.arguments
        confidence = self.intervals[degree.name]
        if use.name in {"usedFor", "notUsedFor"}:
            if use.name == "notUsedFor" or use.arguments[0].name not in SOMETHING:
                raise UninterpretableError("say_the_use")
            use = use.arguments[1]
        name, props = kind_and_properties(noun)
        if name == ANY_OBJECT and not props:
            raise UninterpretableError("of_which_object", asks=True)
        affordance, material = _use(use)
        return meanings.FunctionalRule(name, affordance, confidence, props, material=material)

    def _action_rule(self, form: PredicateForm) -> meanings.ActionRule:
        context, act, degree = form.arguments
        part, owner = act.arguments[1].arguments
        if not self.is_act_on_object(context.name) and context.name not in self.tool_acts:
            raise UninterpretableError("no_act")
        name, props = kind_and_properties(owner)
        if context.name in self.tool_acts and context.arguments[1:] == (owner,):
            # It is the tool that is held, not what it is used on.
            raise UninterpretableError("not_a_rule")
        confidence = self.intervals[degree.name]
        return meanings.ActionRule(name, context.said, name_of(part), confidence, props)

    def _question(self, form: PredicateForm) -> Question:  # noqa: PLR0911, PLR0912 - a case per question
        table = load_predicates()
        ask, kind = table.asks.get(form.name, form.name), table.named.get(form.name)
        match form.name, form.arguments:
            case (name, ()) if name in table.bare:
                return Question(ask)
            case "best", (use, PredicateForm(name="both", arguments=things)):
                return replace(_question_on_use(ask, use), among=tuple(map(_kind, things)))
            case (_, (thing, *_)) if kind:
                return self._question_naming(ask, kind, thing)
            case "isTrue" | "which", (PredicateForm(name="stateOf", arguments=(thing, *_)),):
                name, props = kind_and_properties(thing)
                if len(props) != 1:
                    raise UninterpretableError("one_thing_at_a_time")
                return Question("state", None if name == ANY_OBJECT else name, property=props[0])
            case "hasPart", (thing, part):
                return Question(ask, object=_kind(thing), part=part_and_owner(part)[0])
            case "howSure", (PredicateForm(arguments=()) as thing, *_):
                return Question(ask, object=_kind(thing))
            case "isTrue", (PredicateForm(name="kindOf" | "isA", arguments=(thing, above, _)), *_):
                return Question("is_kind_of", object=_kind(thing), kind_of=_kind(above))
            case "isTrue" | "howSure", (rule, *_):
                return self._question_on_rule(ask, rule)
            case "source", (PredicateForm(name="implies" | "and") as rule, *_):
                return self._question_on_rule(ask, rule)
            case "source", (PredicateForm(name="holding" | "graspObject") as act, *_):
                return self._question_on_act(ask, act)
            case "source", (thing, *_):
                return Question(ask, object=_kind(thing))
            case "which", (
                PredicateForm(name="usedFor" | "implies", arguments=(thing, use, *_)),
                *_,
            ) if thing.name in SOMETHING and use.name != "graspObject":
                return _question_on_use("objects_for", use)
            case "how", (PredicateForm(name="implies", arguments=(act, *_)) | act, *_):
                return self._question_on_act(ask, act)
            case "why" | "whyNot", (PredicateForm(name="implies") as rule, *_):
                return self._question_on_rule(ask, rule)
            case "why" | "whyNot", (PredicateForm("grasp", (_, thing, *_)), *_):
                # "Why did you take the knife?" asks for the choice of the object, not of the part.
                return Question(ask, object=_kind(thing))
            case "why" | "whyNot", (act, *_):
                is_act = act.name in _EXPLAINED or act.name in self.tool_acts
                return self._question_on_act(ask, act) if is_act else Question(ask, _kind(act))
            case "whichContext", (act, part, *_):
                asked = self._question_on_act(ask, act)
                # "Held by the blade" asks for any context, "passed by the blade" for passing only.
                context = None if act.name == "grasp" else act.name
                return replace(asked, context=context, part=part_and_owner(part)[0])
            case _:
                raise UninterpretableError("unanswerable")

    def _question_naming(self, ask: str, kind: str, thing: PredicateForm) -> Question:
        match kind:
            case "object":
                return Question(ask, object=_kind(thing))
            case "use":
                return _question_on_use(ask, thing)
            case "part":
                return Question(ask, part=part_and_owner(thing)[0])
            case "speaker":
                return Question(ask, speaker=name_of(thing))
            case _:
                return _question_on_target(ask, self._reference(thing))

    def _question_on_rule(self, ask: str, form: PredicateForm) -> Question:
        rule = self._one_rule(form, "one_thing_at_a_time")
        if isinstance(rule, meanings.KindRelation):
            raise UninterpretableError("not_a_rule")
        return question_on(rule, ask)

    def _question_on_act(self, ask: str, act: PredicateForm) -> Question:
        part = None
        if act.name == "holding":
            part = part_and_owner(act.arguments[1])[0]
            act = act.arguments[0]
        if act.name == "graspObject":
            place = act.arguments[1]
            return Question(ask, object=_kind(place.arguments[1]), part=part_and_owner(place)[0])
        if act.name in self.tool_acts:
            # The last argument is the tool, or what it is used on where no tool is named.
            return Question(ask, _kind(act.arguments[-1]), context=act.said, part=part)
        target = self._reference(act.arguments[1])
        if target.object == ANY_OBJECT:
            raise UninterpretableError("which_thing", asks=True)
        return replace(_question_on_target(ask, target), context=act.said, part=part)


def _state(form: PredicateForm) -> meanings.TopicStatement:
    thing, *denial = form.arguments
    return meanings.TopicStatement(*kind_and_properties(thing), denied=bool(denial))


def _use(form: PredicateForm) -> tuple[str, str | None]:
    material = None
    if form.name == "of":
        form, patient = form.arguments
        kind, props = kind_and_properties(patient)
        material = None if kind == ANY_OBJECT else " ".join((*props, kind))
        if kind == ANY_OBJECT and props:
            raise UninterpretableError("one_thing_at_a_time")
    if form.arguments:
        raise UninterpretableError("one_use_at_a_time")
    return name_of(form), material


def _question_on_use(ask: str, use: PredicateForm) -> Question:
    affordance, material = _use(use)
    return Question(ask, affordance=affordance, material=material)


def _question_on_target(ask: str, target: ObjectReference) -> Question:
    prop = " ".join(target.props) or None
    return Question(ask, target.object, target.used_for, material=target.material, property=prop)


def short_answer(form: PredicateForm) -> meanings.Answer:
    """Return what an answer names or chooses: `chosen(knife)`, `chosenUse(cutting)`, `noneOf`.

    It raises `UninterpretableError` where what it names has no name.
    """
    if form.name in _CHOICES:
        return meanings.Answer(choice=_CHOICES[form.name])
    if form.name == "chosenUse":
        use, material = _use(form.arguments[0])
        return meanings.Answer(use, is_use=True, material=material)
    return meanings.Answer(*kind_and_properties(form.arguments[0]))


def _kind(form: PredicateForm) -> str:
    kind, properties = kind_and_properties(form)
    if properties or kind == ANY_OBJECT:
        raise UninterpretableError("one_thing_at_a_time")
    return kind


def _spoken_of(form: PredicateForm) -> meanings.TopicStatement | meanings.PartNaming:
    (thing,) = form.arguments
    if form.name == "topic" or thing.name != "partOf":
        return meanings.TopicStatement(_kind(thing), shown=form.name == "shown")
    part, owner = thing.arguments
    if owner.name == "other":
        return meanings.PartNaming(name_of(part), other=True)
    name, props = kind_and_properties(owner)
    return meanings.PartNaming(name_of(part), props, object=None if name == ANY_OBJECT else name)


def kind_and_properties(form: PredicateForm) -> tuple[str, tuple[str, ...]]:
    """Return the kind of object that a form names, or `ANY_OBJECT`, and its properties.

    It raises `UninterpretableError` for a form that names no object.
    """
    props: set[str] = set()
    while form.name == "having":
        props.add(name_of(form.arguments[1]))
        form = form.arguments[0]
    if form.name in SOMETHING:
        return ANY_OBJECT, tuple(sorted(props))
    return name_of(form), tuple(sorted(props))


def name_of(form: PredicateForm) -> str:
    """Return the name in a form as people spell it; `UninterpretableError` where it has none."""
    if form.arguments or form.name in _NAMELESS or form.name in SOMETHING:
        raise UninterpretableError("one_thing_at_a_time")
    return form.said


def part_and_owner(place: PredicateForm) -> tuple[str, PredicateForm | None]:
    """Return the part by which something is held, and the object that it is said to be part of."""
    if place.name == "graspObject":
        place = place.arguments[1]
    if place.name != "partOf":
        return name_of(place), None
    return name_of(place.arguments[0]), place.arguments[1]
