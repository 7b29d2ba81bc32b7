"""Selection of the answer to a command: its key in `ontology/english/answers.yaml`, and slots."""

from ...inference.induction import INDUCER
from ...inference.types import Candidate, Inference, Target
from ...nlu.generation.templates import proper_name
from ...ontology.actions import Precondition
from ...sim.manipulation.motion_report import MotionReport
from .doubt import Doubt
from .outcome import AnswerContent, Decision, Slot

INTERRUPTED = "interrupted"  # the cause of a failure: somebody asked to stop
FORBIDDEN = "forbidden"  # the cause of a failure: a norm

_DONE = {  # action -> the answer without a part, with one, and with one that was taught
    "pass": ("passed", "passed_by", "passed_as_told"),
    "pickUp": ("picked_up", "picked_up_by", "picked_up_as_told"),
    "pointTo": ("pointed_at",) * 3,
    "grasp": ("grasped_somewhere", "grasped", "grasped"),
    "use": ("picked_up", "picked_up_by", "picked_up_as_told"),
}
_UNMET = {  # kind of precondition -> the answer where it is not met, and where its negation is not
    "property": ("required", "required_not"),
    "sees": ("nothing_seen", "see_one"),
    "holds": ("not_held", "grasped_somewhere"),
}
_EMPTIED = {"letGo": "released", "placeObject": "put_down", "returnObject": "put_back"}
_MOTION = {  # reason of a motion report -> the answer with a part, and without
    "unreachable": ("unreachable_part", "unreachable"),
    "no_grasp": ("no_grasp", "no_grasp_anywhere"),
    "missed": ("no_grasp", "no_grasp_anywhere"),
    "too_wide": ("too_wide_part", "too_wide"),
    "blocked": ("blocked_part", "blocked"),
    "wrong_part": ("wrong_part", "no_grasp_anywhere"),
    "slipped": ("slipped", "slipped"),
    "dropped": ("dropped", "dropped"),
    "nothing_held": ("dropped", "dropped"),
    "bumped": ("unreachable_part", "unreachable"),
    "nothing_seen": ("lost_sight_part", "lost_sight"),
    "no_gripper": ("no_hand", "no_hand"),
}


def done(action: str, decision: Decision, speaker: str, recipient: str) -> AnswerContent:
    """Return the answer to a command that was carried out."""
    slots = _chosen(action, decision)
    if decision.patient:
        return AnswerContent("done_with_tool", slots)
    if action == "pass" and recipient != speaker:
        return AnswerContent("passed_to", slots | {"recipient": recipient})
    best = decision.part.best if decision.part and not decision.named_part else None
    teacher = best.rules[-1].speaker if best and best.rules else None
    if teacher:
        slots["speaker"] = "you" if teacher == speaker else proper_name(teacher)
    plain, by_part, as_told = _DONE.get(action, ("did", "did_by", "did_by"))
    return AnswerContent(as_told if teacher else by_part if decision.chosen_part else plain, slots)


def decided(action: str, decision: Decision, speaker: str, recipient: str) -> AnswerContent:
    """Return the answer without a robot to carry out the command: what Hilt would do."""
    slots = _chosen(action, decision)
    if decision.patient:
        return AnswerContent("would_use_tool", slots)
    by_part = "_by" if decision.chosen_part else ""
    if action == "pass" and recipient not in {speaker, ""}:
        return AnswerContent(f"would_pass_to{by_part}", slots | {"recipient": recipient})
    return AnswerContent(f"would_do{by_part}", slots)


def use_slot(affordance: str, *materials: str | None) -> str | tuple[str, ...]:
    """Return a use for a slot of the form `use`: the affordance, and what it is used on."""
    return (affordance, *named) if (named := tuple(filter(None, materials))) else affordance


def not_found(target: Target, inference: Inference) -> AnswerContent:
    """Return the answer when no candidate is accepted."""
    first = inference.candidates[0] if inference.candidates else None
    if first is None or first.verdict != "unsure" or first.interval.is_vacuous:
        return _no_candidate(target, inference)
    if (wanted := _wanted(target)) is None:
        return AnswerContent("not_sure_seen", {"object": _description(target)}, "asked", "not_sure")
    if is_guess(first):
        return guessed(target, first)
    key, slot = ("not_sure_of", "conclusion") if target.affords else ("not_sure", "affordance")
    return AnswerContent(key, {"object": first.object, slot: wanted}, "asked", "not_sure")


def is_guess(candidate: Candidate) -> bool:
    """Whether a candidate rests on an induced rule, that is on similarity."""
    return any(rule.speaker == INDUCER for rule in candidate.rules)


def guessed(target: Target, best: Candidate) -> AnswerContent:
    """Return the question about an object that nobody said has the use that is asked for."""
    slots = {"object": best.object, "affordance": _wanted(target) or "that"}
    return AnswerContent("guess_use", slots, "asked", "not_sure")


def not_sure_how(action: str, object_name: str, best: Candidate) -> AnswerContent:
    """Return the question about the best part for a grasp: it is not accepted, or a guess."""
    part = best.argument.name if best.argument else "part"
    slots = {"goal": action, "object": object_name, "part": part}
    key = "guess_how" if is_guess(best) else "not_sure_how"
    return AnswerContent(key, slots, "asked", "not_sure")


def doubted(doubt: Doubt, speaker: str) -> AnswerContent:
    """Return what is said of a part that was told and that experience speaks against."""
    failures = doubt.counts.failures
    how = next(iter(failures)) if len(failures) == 1 else "failed"
    told = tuple("you" if name == speaker else name for name in doubt.teachers)
    times = {"failed": str(sum(failures.values())), "trials": str(doubt.counts.trials)}
    return AnswerContent(f"doubt_{how}", {"speakers": told, "part": doubt.part, **times})


def ask_about(doubt: Doubt) -> AnswerContent:
    """Return the question what to do about a doubt."""
    if doubt.instead is None:
        return AnswerContent("ask_all_the_same", {}, "asked", "doubted")
    counts = doubt.counts_instead
    slots = {"instead": doubt.instead, "held": str(counts.held), "tried": str(counts.trials)}
    key = "ask_instead" if counts.trials else "ask_to_try"
    return AnswerContent(key, slots, "asked", "doubted")


def motion_failed(report: MotionReport, object_name: str, part: str | None) -> AnswerContent:
    """Return the answer to a motion that failed."""
    if report.reason not in _MOTION:  # a failure of the robot's own
        return failed(report.reason.replace("_", " "), object_name, report.reason)
    barred_by = report.barred_by if report.reason == "blocked" else ()
    key = _MOTION[report.reason][0 if part else 1] + ("_by" if barred_by else "")
    slots: dict[str, Slot] = {"object": object_name, "part": part or "", "objects": barred_by}
    return AnswerContent(key, slots, "failed", report.reason)


def failed(why: str, object_name: str, cause: str) -> AnswerContent:
    """Return the answer to a step that failed for a reason without a sentence of its own."""
    return AnswerContent("failed", {"object": object_name, "reason": why}, "failed", cause)


def stopped(holding: str | None) -> AnswerContent:
    """Return the answer to a command that was interrupted, with what is still in the hand."""
    slots = {"object": holding} if holding else {}
    return AnswerContent("stopped_holding" if slots else "stopped", slots, "failed", INTERRUPTED)


def hand_emptied(primitive: str, held: str, reason: str = "") -> AnswerContent:
    """Return the answer to a primitive that was to empty the hand, with the reason if it failed."""
    if reason == INTERRUPTED:
        return stopped(held)
    if reason:
        key = reason if reason in {"dropped", "not_taken"} else "no_place"
        return AnswerContent(key, {"object": held}, "failed", reason)
    return AnswerContent(_EMPTIED[primitive], {"object": held})


def required(condition: Precondition, name: str) -> AnswerContent:
    """Return the answer when a precondition about an object of this name is not met."""
    slots = {"object": name} | ({"property": condition.property} if condition.property else {})
    key = _UNMET["property" if condition.property else condition.kind][condition.negated]
    return AnswerContent(key, slots, "failed", "required")


def taught_done(action: str, objects: tuple[str, ...], *, is_done: bool) -> AnswerContent:
    """Return the answer to a taught action that was carried out, or what Hilt would do."""
    key = ("did_taught" if is_done else "would_do_taught") + ("" if objects else "_alone")
    return AnswerContent(key, {"goal": action, "objects": objects} if objects else {"goal": action})


def unable(action: str, primitive: str, decision: Decision) -> AnswerContent:
    """Return the answer when the robot lacks the primitive of a step of the tree."""
    slots = _chosen(action, decision) | {"ability": primitive}
    key = "not_able_with" if decision.patient else "not_able"
    return AnswerContent(key, slots, "failed", "unable")


def _no_candidate(target: Target, inference: Inference) -> AnswerContent:
    wanted, slot = _wanted(target), "conclusion" if target.affords else "affordance"
    key = "nothing_affords" if target.affords else "nothing_used_for"
    slots: dict[str, Slot] = {slot: wanted or ""}
    if target.not_used_for:
        key = "nothing_not_used_for"
    elif wanted is None or target.object:
        key, slots = "nothing_seen", dict[str, Slot](object=_description(target))
    else:
        for why, candidates in (("absent", inference.absent), ("denied", inference.denied)):
            if objects := tuple(dict.fromkeys(each.object for each in candidates)):
                key, slots = f"{key}_{why}", slots | {"objects": objects}
                break
    return AnswerContent(key, slots, "failed", "not_found")


def _wanted(target: Target) -> str | tuple[str, ...] | None:
    if target.affords:
        return str(target.affords)
    use = target.used_for or target.not_used_for
    return use_slot(use, target.material) if use else None


def _description(target: Target) -> str:
    return " ".join((*sorted(target.properties), target.object or "thing"))


def _chosen(action: str, decision: Decision) -> dict[str, str]:
    name = decision.object.best.object if decision.object.best else None
    part, patient = decision.chosen_part, decision.patient
    slots = {"goal": action, "object": name, "tool": name, "part": part, "patient": patient}
    return {key: value for key, value in slots.items() if value}
