"""Questions about Hilt itself: what it is, holds, did, and was told by whom."""

from collections.abc import Callable, Collection, Mapping
from functools import partial

from ...kb.rdf.record_mapping import group_pairs
from ...kb.rule import Rule
from ...nlu.semantics.meaning import Question, SimpleCommand
from .conversation import Answered, Conversation, spoken

MOST_LISTED = 5  # so many rules are told one by one; of more only some objects are named
MOST_NAMED, MOST_READ = 3, 20
"""So many objects are named, which so many of the rules are about."""

_TAUGHT = frozenset({"statement", "correction"})
_ASKED = frozenset({"command", "control", "question"})


def _fixed(key: str, _: Question, __: Conversation) -> Answered:
    return spoken(key, done=True), ()


def _capabilities(_: Question, known: Conversation) -> Answered:
    taught = tuple(each.name for each in known.base.actions())
    key = "capabilities_taught" if taught else "capabilities"
    return spoken(key, done=True, actions=taught), ()


def _identity(question: Question, known: Conversation) -> Answered:
    if question.speaker is None:
        return spoken("identity", done=True), ()
    speaker = known.person(question.speaker)
    if speaker in {known.listener, known.people.called(known.listener)}:
        return spoken("identity_of", done=True, speaker=speaker), ()
    if speaker not in known.base.trust_by_speaker():
        return spoken("knows_nobody", done=True, speaker=speaker), ()
    return _told(question, known)


def _holding(question: Question, known: Conversation) -> Answered:
    held, key = known.holding(), "grasped_somewhere"
    if question.object and question.object != held:
        held, key = question.object, "not_held"
    return spoken(key if held else "nothing_held", done=True, object=held), ()


def _last_done(_: Question, known: Conversation) -> Answered:
    last, decision = known.last_done, known.decision
    if known.control_done:
        return known.control_done, ()
    if last is None or last.result is None:
        return spoken("nothing_done"), ()
    if not last.is_done or not last.result.world.executed or not last.chosen or not decision:
        return spoken("did_nothing", done=True, said=last.said), ()
    key = "did_by" if decision.chosen_part else "did"
    names = {"object": last.chosen.object, "part": decision.chosen_part}
    if decision.patient:
        key, names = "done_with_tool", {"tool": last.chosen.object, "patient": decision.patient}
    meant = last.understanding.meaning
    meant = getattr(meant, "steps", (meant,))[-1]  # of a plan the last step
    goal = meant.goal if isinstance(meant, SimpleCommand) else "use"
    return spoken(key, done=True, goal=goal, **names), decision.rules


def _repeated(_: Question, known: Conversation) -> Answered:
    key = "repeated" if known.last_said else "nothing_said"
    return spoken(key, done=True, said=known.last_said), ()


def _told(question: Question, known: Conversation) -> Answered:
    speaker = known.base.match_speaker(question.speaker) if question.speaker else None
    key, slots = ("told", {"speaker": speaker}) if speaker else ("known", {})
    count, rules = known.base.count_and_rules(MOST_READ, speaker=speaker)
    if not rules:
        return spoken("told_nothing" if speaker else "nothing_known", done=True, **slots), ()
    if count <= MOST_LISTED:
        said = tuple(map(known.describe, rules))
        return spoken(key, done=True, rules=said, **slots), tuple(rules)
    objects = tuple(dict.fromkeys(rule.object or "thing" for rule in rules))[:MOST_NAMED]
    return spoken(f"{key}_many", done=True, number=str(count), objects=objects, **slots), ()


def _told_at_an_end(question: Question, known: Conversation, *, newest_first: bool) -> Answered:
    speaker = known.base.match_speaker(question.speaker or "")
    for each in known.base.history(newest_first=newest_first):
        is_note = each.kind == "topic" and each.predicate.startswith("stateOf")
        is_told = is_note or (each.kind in _TAUGHT and each.asserts)
        if each.speaker == speaker and each.accepted and is_told:
            active = [r for r in map(known.base.rule, each.asserts) if r.status == "active"]
            rules = tuple(rule for rule in active if rule.speaker == speaker)
            key = "source" if active or is_note else "told_but_retracted"
            return spoken(key, done=True, speaker=speaker, texts=each.text), rules
    return spoken("told_nothing", done=True, speaker=speaker), ()


def _last_said(_: Question, known: Conversation, *, kinds: Collection[str]) -> Answered:
    for each in known.base.history(newest_first=True):
        is_looking_back = each.predicate in {"lastAsked", "lastSpokenOf"}
        if each.speaker == known.listener and each.kind in kinds and not is_looking_back:
            return spoken("you_said", done=True, texts=each.text), ()
    return spoken("you_said_nothing", done=True), ()


def _exceptions(question: Question, known: Conversation) -> Answered:
    others = known.base.rules(object=question.object) if question.object else known.base.rules()
    rules = others if question.object else known.topic or others
    alike = group_pairs((other.argument, other) for other in others)
    pairs = ((other, rule) for rule in rules for other in alike[rule.argument])
    found = tuple(dict.fromkeys(other for other, rule in pairs if _is_exception(other, rule)))
    said = tuple(map(known.describe, found))
    return spoken("exceptions" if found else "no_exceptions", done=True, rules=said), found


def _is_exception(other: Rule, rule: Rule) -> bool:
    is_special = other.features >= rule.features and other.contexts >= rule.contexts
    return rule.object in {None, other.object} and is_special and other.asserts != rule.asserts


SELF_REPORTS: Mapping[str, Callable[[Question, Conversation], Answered]] = {
    "capabilities": _capabilities,
    "exceptions": _exceptions,
    "first_told": partial(_told_at_an_end, newest_first=False),
    "hearing": partial(_fixed, "hearing"),
    "holding": _holding,
    "identity": _identity,
    "known": _told,
    "last_asked": partial(_last_said, kinds=_ASKED),
    "last_done": _last_done,
    "last_spoken_of": partial(_last_said, kinds=_ASKED | _TAUGHT),
    "last_told": partial(_told_at_an_end, newest_first=True),
    "repeated": _repeated,
    "told": _told,
    "wellbeing": partial(_fixed, "wellbeing"),
}
"""How each question about Hilt itself is answered."""
