"""Questions answered from the graph, each with the interval and the source it rests on."""

from bisect import bisect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import cast

from ...inference.affordance import Affordances
from ...inference.explanation import rejection_reason
from ...inference.interval_operators import relative_plausibility
from ...inference.node_rules import FIND
from ...inference.rule_analysis import Hypothesis, find_hypotheses
from ...inference.taxonomy import Taxonomy
from ...inference.types import Conclusion, Goal, Inference, Observation, Target
from ...kb.interval import CERTAIN
from ...kb.rdf.record_mapping import group_pairs
from ...kb.rdf.rule_mapping import atom_from_iri, atom_iri, rule_id
from ...kb.rule import GRASP_OBJECT, KIND_OF, USED_FOR, Atom, Rule
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics.meaning import Command, KindRelation, Question, SimpleCommand, ToolCommand
from ...ontology.vocabulary import Iri
from ..execution.outcome import AnswerContent, Decision, Slot
from ..execution.outcome_answer import use_slot
from .conversation import Answered, Conversation, spoken
from .reply import Reply
from .self_report import SELF_REPORTS
from .translation import chosen_by

_ABOUT_ANY = """SELECT ?rule {
    GRAPH graph:domain { ?part hilt:partOf ?object }
    GRAPH graph:beliefs { ?rule hilt:context ?context ; hilt:part ?part ; hilt:status ?status
        FILTER (?status = hilt:active && NOT EXISTS { ?rule hilt:feature ?feature }) } }"""
"""The rules on how to grasp any object, by a part that this object has."""

_PARTS = "SELECT ?part { GRAPH graph:domain { ?part hilt:partOf ?object } } ORDER BY ?part"

_PROPERTIES = "SELECT ?of { GRAPH graph:domain { ?it hilt:partOf? ?object ; hilt:property ?of } }"

SURE = (0.6, 0.9)  # from these certainties on Hilt says that it is fairly sure, and quite sure


def answer(question: Question, known: Conversation) -> Answered:
    """Return the answer to a question, and the rules that it rests on."""
    return _ANSWERS[question.ask](question, known)


def _uses_of(question: Question, known: Conversation) -> Answered:
    strongest = (_strongest(rules, "affordance") for rules in _by_kind(question, known))
    if not (rules := next(filter(None, map(_believed, strongest)), [])):
        return spoken("no_uses_of", object=question.object), ()
    if any(_properties(rule) for rule in rules):
        return spoken("about", done=True, rules=tuple(map(known.quote, rules))), tuple(rules)
    phrase = known.language.answers.use_phrase
    uses = tuple(known.quote(rule, phrase(rule.affordance or "", rule.material)) for rule in rules)
    return spoken("uses_of", done=True, object=question.object, uses=uses), tuple(rules)


def _objects_for(question: Question, known: Conversation) -> Answered:
    if not (rules := _believed(_functional(question, known))):
        return spoken("nothing_known_for", affordance=_use(question)), ()
    on, asked = known.language.answers.object_for, {None, question.material}
    named = ((_kind(r) if r.material in asked else on(_kind(r), r.material or "")) for r in rules)
    best = dict(reversed([*zip(named, rules, strict=True)]))  # of each the surest
    names = tuple(known.quote(best[name], name) for name in reversed(best))
    return spoken("objects_for", done=True, objects=names, affordance=_use(question)), tuple(rules)


def _best_for(question: Question, known: Conversation) -> Answered:
    rules = _functional(question, known)
    goal = Goal("find", Target(used_for=question.affordance, material=question.material))
    asked = question.among
    meant = [rule for rule in rules if rule.object and (not asked or rule.object in asked)]
    told = {_kind(rule): dict.fromkeys(rule.features, CERTAIN) for rule in meant}
    seen = [Observation(name, name, features) for name, features in told.items()]
    kinds = Taxonomy.from_base(known.base)
    inference = Affordances(known.base, taxonomy=kinds).infer(FIND, goal, seen)
    if (best := inference.best) is None:
        return spoken("nothing_known_for", affordance=_use(question)), ()
    if sum(each.certainty == best.certainty for each in inference.candidates) > 1:
        return _objects_for(question, known)
    materials = {rule.material for rule in best.rules}
    use = _use(question) if None in materials else _use(question, *sorted(filter(None, materials)))
    return spoken("best_for", done=True, object=best.object, affordance=use), best.rules


def _parts(question: Question, known: Conversation) -> Answered:
    name = question.object or ""
    found = known.base.select(_PARTS, {"object": [atom_iri(Atom("object", name))]})
    told = [rule.part for rule in known.base.rules(object=name) if rule.asserts and rule.part]
    shown = [part for word in known.base.words() for part in word.parts if word.atom.name == name]
    defined = [atom_from_iri(cast(Iri, row[0])).name for row in found]
    if not (parts := tuple(dict.fromkeys([*defined, *shown, *told]))):
        return spoken("no_parts", done=True, object=name), ()
    key = "has_part" if question.part in parts else "lacks_part" if question.part else "parts"
    return spoken(key, done=True, object=name, parts=parts, part=question.part), ()


def _how(question: Question, known: Conversation) -> Answered:
    of_kinds = ([r for r in rules if r.kind == "action"] for rules in _by_kind(question, known))
    rules = next(filter(None, of_kinds), [])
    if not rules and question.object and question.context:
        action, named = Atom("action", question.context), Atom("object", question.object)
        asked = {"context": [atom_iri(action)], "object": [atom_iri(named)]}
        found = known.base.select(_ABOUT_ANY, asked)
        rules = [known.base.rule(rule_id(cast(Iri, row[0]))) for row in found]
    if not rules and question.context == "grasp":  # "where do you hold it?": whatever for
        return _how(Question("how", question.object, question.affordance), known)
    grasps = _strongest(rules, "part")
    if taught := {each.name: each for each in known.base.actions()}.get(question.context or ""):
        said = spoken("source", done=True, speaker=taught.speaker, texts=taught.said)
        return said, tuple(grasps[:1])
    goal = question.context or "grasp"
    if not grasps and not known.language.utterance_parser.procedures.is_act(goal):
        act = known.language.answers.act_on(goal, *filter(None, [question.object]))
        return spoken("how_to_do", action=act), ()
    if not grasps:
        key = "no_how_with" if question.context in known.language.builder.tool_acts else "no_how"
        return spoken(key, goal=goal, object=question.object), ()
    return _told("how", grasps[0], known)


def _by_kind(question: Question, known: Conversation) -> Iterator[Sequence[Rule]]:
    named = Atom("object", question.object) if question.object else None
    kinds = Taxonomy.from_base(known.base).above(named) if named else ()
    use, context = question.affordance, question.context
    for name in [kind.name for kind, _ in kinds] or [None]:
        yield known.base.rules(object=name, affordance=use, context=context)


def _is_used_for(question: Question, known: Conversation) -> Answered:
    found = (_on_material(rules, question, known) for rules in _by_kind(question, known))
    rules: Sequence[Rule] = next(filter(None, found), ())
    if not rules:
        slots = {"object": question.object, "affordance": _use(question)}
        if not (others := known.base.rules(object=question.object, affordance=question.affordance)):
            return spoken("is_not_used_for", done=True, **slots), ()
        said = tuple(known.quote(rule) for rule in others)
        return spoken("is_used_otherwise", done=True, rules=said, **slots), tuple(others)
    if not rules[0].trust:
        slots = {"rule": known.describe(rules[0]), "speaker": rules[0].speaker}
        return spoken("hardly_sure", done=True, **slots), (rules[0],)
    return _told("is_used_for" if rules[0].asserts else "is_denied", rules[0], known)


def _is_kind_of(question: Question, known: Conversation) -> Answered:
    name, kind = question.object or "", question.kind_of or ""
    taxonomy = Taxonomy.from_base(known.base)
    above = taxonomy.names_above("object", name)
    between = {each for each in above if kind in taxonomy.names_above("object", each)}
    pairs = between or {name, kind}
    rules = known.base.rules_at_nodes([KIND_OF])
    told = [r for r in rules if {r.object, r.argument and r.argument.name} <= pairs]
    if not between and not told:
        return spoken("is_of_no_kind", object=name, kind=kind), ()
    if not between:
        return _told("is_denied", told[0], known)
    itself = known.language.answers.kind_phrase(KindRelation(kind, name, (1.0, 1.0)))
    said = tuple(known.quote(rule) for rule in told if rule.asserts) or (itself,)
    return spoken("is_of_kind", done=True, rules=said), tuple(told)


def _about(question: Question, known: Conversation) -> Answered:
    if question.object is None:
        return _objects_for(question, known)
    rules, noted = known.base.rules(object=question.object), known.noted[question.object]
    slots = {"object": question.object, "rules": tuple(map(known.quote, rules))}
    slots["properties"] = tuple(atom.name for atom, held in noted.items() if held.lower > 0)
    if not rules and not slots["properties"]:
        return spoken("nothing_about", object=question.object), ()
    key = ("about_both" if rules else "about_state") if slots["properties"] else "about"
    return spoken(key, done=True, **slots), tuple(rules)


def _state(question: Question, known: Conversation) -> Answered:
    name, prop = question.object, question.property or ""
    if name is None:
        things = {*known.visible(), *known.noted}
        names = tuple(sorted(each for each in things if _is_like(each, prop, known)))
        return spoken("all_so" if names else "none_so", done=True, objects=names), ()
    if (is_so := _is_like(name, prop, known)) is None:
        return spoken("is_it_so", object=name, property=prop), ()
    return spoken("yes_is" if is_so else "no_is", done=True, object=name, properties=prop), ()


def _is_like(name: str, prop: str, known: Conversation) -> bool | None:
    if (told := known.noted[name].get(Atom("property", prop))) is not None:
        return told.lower > 0
    found = known.base.select(_PROPERTIES, {"object": [atom_iri(Atom("object", name))]})
    return prop in {atom_from_iri(cast(Iri, row[0])).name for row in found} or None


def _confidence(question: Question, known: Conversation) -> Answered:
    if known.retracted and question == Question("confidence"):
        said = tuple(known.describe(rule) for rule in known.retracted)
        return spoken("no_longer_sure", done=True, rules=said), ()
    if not (rules := _meant(question, known)) and known.reason:
        return _source(question, known)
    if not rules and known.unanswered and question == Question("confidence"):
        return spoken("unsure_as_said", said=known.unanswered), ()
    if not rules:
        return spoken("unsure"), ()
    rule = rules[0]
    sure = max(rule.support.lower, 1 - rule.support.upper)
    key = ("hardly_sure", "fairly_sure", "quite_sure")[bisect(SURE, sure)]
    return spoken(key, done=True, rule=known.describe(rule), speaker=rule.speaker), (rule,)


def _source(question: Question, known: Conversation) -> Answered:
    rules, said_in = _meant(question, known), known.reason
    if not rules and said_in:
        return spoken("source", done=True, speaker=said_in.speaker, texts=said_in.text), ()
    if not rules or rules[0].utterance is None:
        return spoken("no_source"), ()
    rule = rules[0]
    asked = rules if question == Question("source") else rules[:1]  # "who told you that?": of all
    told = (each for each in asked if each.utterance and each.speaker == rule.speaker)
    said = tuple(dict.fromkeys(known.base.utterance(each.utterance or 0).text for each in told))
    if (reporter := known.people.reporter_of(rule)) == rule.speaker:
        return spoken("source", done=True, speaker=reporter, texts=said), (rule,)
    people = {"source": rule.speaker, "speaker": reporter}
    return spoken("source_of_report", done=True, texts=said, **people), (rule,)


def _what_if(question: Question, known: Conversation) -> Answered:
    argument = Atom("affordance", question.affordance or "")
    given = frozenset([Atom("material", question.material)] if question.material else ())
    rules = _functional(question, known)
    if not (found := find_hypotheses(rules, Conclusion(USED_FOR, argument), given=given)):
        return spoken("nothing_known_for", affordance=_use(question)), ()
    things = tuple(dict.fromkeys(_thing(each, known) for each in found))
    key = "what_if_one" if len(things) == 1 else "what_if"
    said = spoken(key, done=True, affordance=_use(question), things=things)
    return said, tuple(rule for each in found for rule in each.rules)


def _thing(hypothesis: Hypothesis, known: Conversation) -> str:
    atoms, words = sorted(hypothesis.features | hypothesis.contexts), known.language.answers
    named = group_pairs((atom.kind, atom.name) for atom in atoms)
    thing = " ".join([*named["property"], *(named["object"] or ["thing"])])
    for material in named["material"]:
        thing = words.object_for(thing, material)
    parts = "".join(f" with {words.noun_phrase(part)}" for part in named["part"])
    return thing + parts + "".join(f" in a {place}" for place in named["place"])


def _which_context(question: Question, known: Conversation) -> Answered:
    given = frozenset({Atom("object", question.object or "")})
    wanted = Conclusion(GRASP_OBJECT, Atom("part", question.part or ""))
    kinds, asked = Taxonomy.from_base(known.base), question.context
    found = find_hypotheses(known.base.rules(), wanted, given=given, taxonomy=kinds)
    fitting = [h for h in found if not asked or {asked, None} & {r.context for r in h.rules}]
    rules = tuple(rule for each in fitting for rule in each.rules)
    if not rules:
        return spoken("not_explained", object=question.object, part=question.part), ()
    said = tuple(dict.fromkeys(known.describe(rule) for rule in rules))
    return spoken("explained", done=True, rules=said), rules


def _see(question: Question, known: Conversation) -> Answered:
    names = known.visible()
    if question.property and question.object in names:
        return _state(question, known)
    if question.object:
        key = "see_one" if question.object in names else "nothing_seen"
        return spoken(key, done=True, object=question.object), ()
    return (spoken("see", done=True, objects=names) if names else spoken("see_nothing")), ()


def _trust(question: Question, known: Conversation) -> Answered:
    if question.speaker is None:
        return spoken("trusts_whom", done=True, speakers=tuple(known.base.speakers())), ()
    speaker = known.person(question.speaker)
    key = "trusts" if known.people.trusts(speaker) else "trusts_not"
    if speaker not in known.base.trust_by_speaker():
        key = "knows_nobody"
    return spoken(key, done=True, speaker=speaker), ()


# --- Why, and why not ----------------------------------------------------------------------


def why(question: Question, known: Conversation) -> Answered:
    """Return the sentences that a choice rests on, or the rules that were mentioned last."""
    if known.reason and not question.part:
        return _as_said(known.reason), ()
    is_open = bool(known.unanswered) and question == Question("why")
    rules, last = () if is_open else tuple(_reasons(question, known)), known.last_done
    if not rules and question.part and (question.context or last is None):
        rules = tuple(_grasps(rule for rule in _meant(question, known) if rule.asserts))
    if rules:
        is_alike = rules[-1].status == "induced"
        told = {"texts": known.words_of(rules[-1])} if is_alike else _sources(rules, known)
        return spoken("because_alike" if is_alike else "because_told", done=True, **told), rules
    if last is None or is_open:
        return spoken("no_source" if is_open else "nothing_done"), ()
    if wrong := _not_so(question, known.decision):
        return spoken(wrong, object=question.object, part=question.part), ()
    if question.object or question.part or (known.decision and known.decision.object.best):
        # What the command itself names needs no rule.
        return _as_said(last), ()
    return _because_of_decision(known, last), ()


def _because_of_decision(known: Conversation, last: Reply) -> AnswerContent:
    if reason := _reason(known.decision, None):
        return spoken("because", done=True, reason=reason)
    if last.is_done:
        return spoken("not_known")
    return spoken("because_not_done", done=True, said=last.said)


def why_not(question: Question, known: Conversation) -> Answered:
    """Return the reasons against another object, or another part."""
    if known.reason and not question.part:
        return _as_said(known.reason), ()
    if not question.part and not question.object:
        is_failed = known.last_done is not None and not known.last_done.is_done
        return why(question, known) if is_failed else (spoken("not_told"), ())
    best = known.decision and known.decision.object.best
    is_of_deed = question.object in {None, best and best.object}
    if question.part and is_of_deed and (known.last_done or _grasps(known.topic)):
        return _why_not_part(question.part, known)
    if known.last_done is None:
        return spoken("nothing_done"), ()
    return _why_not_thing(question.object or "thing", known.last_done, known)


def _as_said(said: Understanding | Reply) -> AnswerContent:
    return spoken("because_told", done=True, speakers=(said.speaker,), texts=(said.text,))


def _why_not_thing(name: str, last: Reply, known: Conversation) -> Answered:
    best = known.decision and known.decision.object.best
    denials = _denials(known.decision and known.decision.object, name)
    reason, wanted, meant = _reason(known.decision, name), None, last.understanding.meaning
    if isinstance(meant, SimpleCommand):
        target = chosen_by(meant)
        patient = meant.patient if isinstance(meant, ToolCommand) else None
        use, material = target.used_for, target.material or patient
        wanted = Question("is_used_for", name, use, material=material) if use else None
    if best and best.object == name:
        said = spoken("is_so", done=True, object=name)
    elif denials:
        return spoken("why_not_said", done=True, object=name, **_sources(denials, known)), denials
    elif reason:
        said = spoken("why_not", done=True, object=name, reason=reason)
    elif name not in known.visible():
        said = spoken("why_not_seen", done=True, object=name)
    elif wanted and not _functional(wanted, known):
        said = spoken("why_not_told", done=True, object=name, affordance=_use(wanted))
    else:
        named = meant.target.object if isinstance(meant, Command) else None
        key = "why_not_named" if named else "why_not_asked"
        said = spoken(key, done=True, object=name, wanted=named)
    return said, ()


def _why_not_part(part: str, known: Conversation) -> Answered:
    if (decision := known.decision) is not None and decision.chosen_part == part:
        return spoken("is_so_part", done=True, part=part), ()
    spoken_of = _grasps(known.topic)
    denied = tuple(rule for rule in spoken_of if rule.part == part and not rule.asserts)
    others = tuple(rule for rule in spoken_of if rule.part != part and rule.asserts)
    best = decision and decision.object.best
    told = known.base.rules(object=best.object, part=part) if best else []
    never = tuple(rule for rule in told if not rule.asserts)
    rules = denied or _denials(decision and decision.part, part) or never or others
    if rules:
        return spoken("why_not_part", done=True, part=part, **_sources(rules, known)), rules
    return spoken("why_not_part_told", done=True, part=part), ()


def _grasps(rules: Iterable[Rule]) -> tuple[Rule, ...]:
    return tuple(rule for rule in rules if rule.kind == "action" and rule.utterance)


def _denials(made: Inference | None, name: str) -> tuple[Rule, ...]:
    denied = made.denied if made else ()
    about = (c for c in denied if name in {c.name, c.object, c.argument and c.argument.name})
    return tuple(rule for each in about for rule in each.rules if not rule.asserts)


def _sources(rules: Sequence[Rule], known: Conversation) -> dict[str, tuple[str, ...]]:
    texts = tuple(dict.fromkeys(map(known.words_of, rules)))
    speakers = dict.fromkeys(known.people.reporter_of(rule) for rule in rules)
    return {"speakers": tuple(speakers), "texts": texts}


def _reasons(question: Question, known: Conversation) -> Sequence[Rule]:
    decision = known.decision
    if not question.object and not question.part:
        return [rule for rule in known.topic if rule.utterance]
    spoken_of = [rule for rule in _grasps(known.topic) if rule.part == question.part]
    if spoken_of and not question.object:
        return spoken_of
    if decision is None or _not_so(question, decision):
        return ()
    rules = [rule for rule in decision.rules if rule.utterance]
    if question.part:
        return [rule for rule in rules if rule.part == question.part]
    return rules if any(rule.part is None for rule in rules) else ()


def _not_so(question: Question, decision: Decision | None) -> str:
    best = decision and decision.object.best
    if question.object and best and question.object != best.object:
        return "is_not_so"
    is_other = decision and question.part not in {None, decision.chosen_part}
    return "is_not_so_part" if is_other else ""


def _reason(decision: Decision | None, name: str | None) -> str | None:
    if decision is None:
        return None
    if tried := next((each for each in decision.rejected if each.object == name), None):
        return tried.reason
    found = next((each for each in decision.object.candidates if name in {None, each.object}), None)
    return rejection_reason(decision.object, found) if found else None


# --- Helpers -------------------------------------------------------------------------------


def _told(key: str, rule: Rule, known: Conversation) -> Answered:
    return spoken(key, done=True, rule=known.quote(rule)), (rule,)


def _use(question: Question, *materials: str) -> Slot | None:
    use = question.affordance
    return use_slot(use, *(materials or (question.material,))) if use else None


def _properties(rule: Rule) -> list[str]:
    return sorted(each.name for each in rule.features if each.kind != "object")


def _kind(rule: Rule) -> str:
    return " ".join([*_properties(rule), rule.object or "thing"])


def _believed(rules: Iterable[Rule]) -> list[Rule]:
    return [rule for rule in rules if rule.asserts and rule.trust]


def _functional(question: Question, known: Conversation) -> list[Rule]:
    rules = known.base.rules(object=question.object, affordance=question.affordance)
    return _on_material(rules, question, known)


def _on_material(rules: Iterable[Rule], question: Question, known: Conversation) -> list[Rule]:
    material = question.material
    kinds = Taxonomy.from_base(known.base).names_above("object", material) if material else ()
    applying = _by_strength(rule for rule in rules if rule.applies_to(kinds))
    return sorted(applying, key=lambda rule: bool(kinds) and rule.material is None)


def _meant(question: Question, known: Conversation) -> list[Rule]:
    named = {name: getattr(question, name) for name in ("object", "affordance", "context")}
    if not any(named.values()):
        latest = sorted(known.base.rules(), key=lambda rule: -(rule.utterance or 0))[:1]
        return list(known.topic) or ([] if known.last_said else latest)
    fitting = [rule for rule in known.base.rules(**named) if question.part in {None, rule.part}]
    return _on_material(fitting, question, known) if question.affordance else _by_strength(fitting)


def _by_strength(rules: Iterable[Rule]) -> list[Rule]:
    return sorted(rules, key=lambda rule: -relative_plausibility(rule.support))


def _strongest(rules: Iterable[Rule], argument: str) -> list[Rule]:
    best: dict[tuple[str, str | None], Rule] = {}
    for rule in _by_strength(rules):
        if concluded := getattr(rule, argument):
            best.setdefault((concluded, rule.material), rule)
    return list(best.values())


_ANSWERS: Mapping[str, Callable[[Question, Conversation], Answered]] = {
    **SELF_REPORTS,
    "about": _about,
    "best_for": _best_for,
    "confidence": _confidence,
    "how": _how,
    "is_kind_of": _is_kind_of,
    "is_used_for": _is_used_for,
    "objects_for": _objects_for,
    "parts": _parts,
    "see": _see,
    "source": _source,
    "state": _state,
    "trust": _trust,
    "uses_of": _uses_of,
    "what_if": _what_if,
    "which_context": _which_context,
    "why": why,
    "why_not": why_not,
}
