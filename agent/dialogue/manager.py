"""The dialogue manager: asserts statements, carries out commands, answers questions.

Paper, section 3.2: the rules of a statement are asserted if its speaker is trusted, and are
acknowledged only when they are stored. A command becomes a goal. What is unclear or uncertain is
asked back, and the "yes" or "no" that follows is understood. The history keeps every utterance,
also one that is refused or not understood.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from ...inference.norms import NormVerdict
from ...inference.types import Target
from ...kb.interval import Interval
from ...kb.rule import Atom
from ...nlu.offers.courtesies import answer_to
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ...ontology.actions import Actions
from ...ontology.errors import UnknownNameError
from ..execution.action_tree_executor import GoalManager
from ..execution.outcome import AnswerContent, GoalResult, Slot, WorldOutcome
from ..execution.outcome_answer import use_slot
from ..execution.request import Request
from .action_lessons import ActionLessons
from .belief_revision import BeliefRevision
from .clarification import ClarificationDialogue, PartAgreements
from .conversation import OPEN, SENTENCE_END, Conversation, UnderstoodTurn
from .hearing import Alternative, SoundsLike, SpokenUtterance, meanings_heard, weigh
from .norm_dialogue import NormDialogue
from .questions import answer
from .reply import OpenQuestion, Reply, joined
from .showing import Eyes, Showing
from .translation import chosen_by, declined, request_from_command, use_of

KINDS = {  # what a command of the CLI listens to -> kinds of meaning
    "tell": ("statement", "correction", "topic"),
    "do": ("command", "control"),
    "ask": ("question",),
}


class DialogueManager:
    """One conversation, with any number of speakers.

    Args:
        goals: returns the goal manager, which is made when the first command comes.
        record_episode: called with every command that was carried out and its reply, and whether
            it is to be kept.
        judge: returns what the norms say of a request.
        sounds_like: finds what may have been said where a hearing is not understood.
        eyes: returns the learned eyes, to which things can be shown.
    """

    def __init__(
        self,
        conversation: Conversation,
        goals: Callable[[], GoalManager],
        record_episode: Callable[[Request, Reply, bool], None],
        *,
        judge: Callable[[Request], NormVerdict],
        actions: Actions,
        sounds_like: SoundsLike,
        eyes: Eyes,
    ) -> None:
        self.conversation, self._sounds_like = conversation, sounds_like
        self._goals, self._record_episode = goals, record_episode
        self._beliefs = BeliefRevision(conversation)
        self.showing = Showing(conversation, self._beliefs, eyes)
        self.lessons = ActionLessons(conversation, actions)
        self._clarification = ClarificationDialogue(conversation, self.hear, self._respond)
        self._agreements = PartAgreements(lambda: goals().affordances)
        self._norms = NormDialogue(conversation, judge)
        #: what holds now beside the current action: places and roles, with their intervals
        self.contexts: dict[Atom, Interval] = {}
        self._accepted: frozenset[str] = frozenset()  # words that were said to be new
        self._interrupted: Callable[[], Reply] | None = None  # the command to continue
        self._excluded: frozenset[str] = frozenset()  # chosen before, when another one is wanted
        self._last: tuple[UnderstoodTurn, Request] | None = None  # the last command
        self._just_stopped: AnswerContent | None = None  # until a control has confirmed it
        # Meaning -> who responds, and the answer where only trusted speakers may say it.
        self._listeners: dict[type, tuple[Callable[[UnderstoodTurn, Any], Reply], str]] = {
            meaning.Statement: (self._beliefs.learn, "not_trusted"),
            meaning.KindStatement: (self._beliefs.learn_kinds, "not_trusted"),
            meaning.NormStatement: (self._norms.lay_down, "not_trusted"),
            meaning.Retraction: (self._forget, ""),
            meaning.ActionDefinition: (self.lessons.learn, "not_trusted"),
            meaning.ActionCommand: (self._do_plan, "not_obeyed"),
            meaning.Plan: (self._do_plan, "not_obeyed"),
            meaning.TopicStatement: (self.showing.open_topic, "not_trusted"),
            meaning.PartNaming: (self.showing.name_part, "not_trusted"),
            meaning.TrustStatement: (self._vouch, "not_trusted"),
            meaning.Command: (self._carry_out_command, "not_obeyed"),
            meaning.ToolCommand: (self._carry_out_command, "not_obeyed"),
            meaning.Question: (self._answer, ""),
            meaning.Acknowledgement: (self._acknowledge, ""),
            meaning.Control: (self._obey, "not_obeyed"),
            meaning.AskBack: (self._clarification.ask_back, ""),
            meaning.Misunderstanding: (self._clarification.not_understood, ""),
        }

    def hear(
        self,
        text: str,
        *,
        speaker: str,
        only: str | None = None,
        heard: float = 1.0,
        alternatives: Sequence[Alternative] = (),
        keep: bool = True,
        accepted: Collection[str] = (),
    ) -> Reply:
        """Understand one utterance, act on it, and return the reply.

        The arguments are those of `Agent.hear`, and `accepted` as in `Language.understand`.
        StoreError if what was said could not be stored; then nothing was believed.
        """
        if self.conversation.notice_others():
            self.lessons.read()
        speaker = self.conversation.people.speaker(self.conversation.base.match_speaker(speaker))
        self.conversation.listener = speaker
        if alternatives:
            scores = weigh(text, heard, alternatives)
            pending = self.conversation.open_question
            pending = pending if pending and pending.asked == speaker else None
            meant = meanings_heard(text, scores, self.conversation, pending)
            hear = partial(self.hear, speaker=speaker, only=only, keep=keep)
            parts = (meant, self.conversation, pending, hear, self._sounds_like, keep)
            return SpokenUtterance(*parts).reply()
        if reply := self._clarification.short_answer(text, speaker, heard=heard, keep=keep):
            self.conversation.last_said = reply.said
            return reply
        if (introduction := self.conversation.language.introduction(text)) and introduction.rest:
            hello = self.conversation.people.meet(speaker, introduction.name)
            said = partial(self.hear, introduction.rest, only=only, heard=heard, keep=keep)
            speaker = self.conversation.people.speaker(speaker)
            reply = said(speaker=speaker, accepted=accepted)
            return replace(reply, said=f"{self.conversation.say(hello)} {reply.said}")
        self._accepted |= {*accepted}
        found = self.conversation.understand(text, speaker, heard=heard, accepted=self._accepted)
        found = self._clarification.settled(found)
        kinds = (*KINDS[only], "acknowledgement") if only else ()
        hear = partial(self.hear, speaker=speaker, only=only, heard=heard, keep=keep)
        answer = partial(self._clarification.short_answer, heard=heard, keep=keep)
        if replies := self._hear_sentences(found, kinds, hear, answer):
            return joined(text, replies)
        turn = UnderstoodTurn(found, heard, keep)
        if only and found.kind not in (*kinds, *OPEN):
            return self.conversation.answered(turn, f"only_{only}", "not_understood")
        if found.kind not in {"acknowledgement", "control"}:
            self.conversation.open_question = None
        return self._respond(turn)

    def _hear_sentences(
        self,
        found: Understanding,
        kinds: Collection[str],
        hear: Callable[[str], Reply],
        answer: Callable[[str, str], Reply | None],
    ) -> list[Reply]:
        """Return the replies to the sentences of an utterance, if it is heard one by one."""
        if found.kind in OPEN:
            first, *rest = SENTENCE_END.split(found.text.strip(), 1)
            said = self.conversation.understand(first, found.speaker, heard=1.0) if rest else found
            if self._clarification.settled(said) is not said:
                return [hear(first), hear(*rest)]
            if rest and (reply := answer(first, found.speaker)):
                return [reply, hear(*rest)]
        several = self.conversation.sentences(found, kinds)
        return [hear(each.text) for each in several] if several[1:] else []

    def hear_aside(
        self, text: str, said: meaning.Control, *, speaker: str, heard: float, keep: bool
    ) -> Reply:
        """Confirm a "wait" or "go on" while another thread carries out a command."""
        speaker = self.conversation.base.match_speaker(speaker)
        turn = UnderstoodTurn(Understanding(text, speaker, "self", said), heard, keep)
        return self.conversation.answered(turn, "waiting" if said.is_halt else "going_on", "done")

    def _respond(self, turn: UnderstoodTurn) -> Reply:
        self.conversation.discourse = turn.understood.discourse
        said = turn.understood.meaning
        if turn.understood.kind in {"statement", "correction", "command", "topic"}:
            self.conversation.reason, self.conversation.unanswered = None, ""
        respond, refusal = self._listeners[type(said)]
        is_halt = isinstance(said, meaning.Control) and said.is_halt  # everybody may stop the arm
        if not refusal or is_halt or self.conversation.people.trusts(turn.speaker):
            reply = respond(turn, said)
        else:
            reply = self.conversation.answered(turn, refusal, "refused", speaker=turn.speaker)
        self.conversation.last_said = reply.said
        return reply

    def _forget(self, turn: UnderstoodTurn, said: meaning.Retraction) -> Reply:
        return (self.lessons if said.action else self._beliefs).forget(turn, said)

    def _vouch(self, turn: UnderstoodTurn, said: meaning.TrustStatement) -> Reply:
        conversation, degree = self.conversation, float(not said.distrusted)
        answers = [conversation.vouch(turn.speaker, name, degree) for name in said.people]
        refused = [each for each in answers if each.ending == "refused"]
        spoken = " ".join(map(conversation.say, answers))
        return conversation.recorded(turn, spoken, "refused" if refused else "done")

    # --- Commands -----------------------------------------------------------------------------

    def _carry_out_command(self, turn: UnderstoodTurn, said: meaning.SimpleCommand) -> Reply:
        if said.negated:
            if (reading := turn.understood.reading) and "lasting" in reading.features.main:
                return self._norms.forbid(turn, said)
            self._norms.forbid_for_now(turn, said)
            self.conversation.reason = turn.understood
            return self.conversation.spoken(turn, declined(said))
        if turn.understood.unknown:
            return self._ask_what_that_is(turn, use_of(said))
        request = request_from_command(said, turn.speaker, self.conversation.language.tool_acts)
        last = self.conversation.last_done
        before = {last.chosen.name} if last and last.chosen else set[str]()
        self._excluded = self._excluded | before if chosen_by(said).other else frozenset()
        return self._start(turn, [replace(request, excluded=self._excluded)])

    def _do_plan(self, turn: UnderstoodTurn, said: meaning.Plan | meaning.ActionCommand) -> Reply:
        steps = said.steps if isinstance(said, meaning.Plan) else (said,)
        unknown = next(filter(None, (self.lessons.ask_how(turn, each) for each in steps)), None)
        acts = self.conversation.language.tool_acts
        requests = [request_from_command(each, turn.speaker, acts) for each in steps]
        return unknown or self._start(turn, requests)

    def _start(self, turn: UnderstoodTurn, requests: Sequence[Request]) -> Reply:
        conversation = self.conversation
        held = ({**self.contexts, **conversation.noted[each.name("object")]} for each in requests)
        first, *rest = (replace(r, contexts=c) for r, c in zip(requests, held, strict=True))
        for each in requests:
            if self.lessons.lacks_objects(each):
                return conversation.answered(turn, "on_what", "asked", goal=each.action)
            if other := self.lessons.other_kind(each, self._goals().affordances.taxonomy):
                conversation.wait_for(turn, lambda: self._carry_out(turn, first, rest))
                return conversation.answered(turn, "taught_for", "asked", **other)
        return self._carry_out(turn, first, rest)

    def _ask_what_that_is(self, turn: UnderstoodTurn, asked: meaning.Question) -> Reply:
        reading = turn.understood.reading
        new_uses = [word.word for word in reading.new_words] if reading else []
        key, slots = "unknown_thing", dict[str, Slot](words=turn.understood.unknown)
        if asked.affordance and asked.affordance in new_uses:
            key, slots = "unknown_use", {"affordance": use_slot(asked.affordance, asked.material)}
        reply = self.conversation.answered(turn, key, "asked", **slots)
        self._clarification.wait_to_learn(turn, asked)
        return reply

    def attempt(self, request: Request, before: GoalResult | None = None) -> tuple[GoalResult, str]:
        """Carry out a request; return its result and the spoken answer."""
        try:
            goals = self._goals()
            goals.actions = self.lessons.actions
            result = goals.achieve(self._norms.lift(request))
        except UnknownNameError:
            answered = AnswerContent("cannot", {"goal": request.action}, "failed")
            result = GoalResult(answered, None, (), WorldOutcome())
        result = self._norms.with_reason(result)
        result = result.after(before) if before else result
        return result, " ".join(map(self.conversation.say, (*result.setbacks, result.answer)))

    def _carry_out(
        self,
        turn: UnderstoodTurn,
        request: Request,
        rest: Sequence[Request] = (),
        before: GoalResult | None = None,
    ) -> Reply:
        conversation = self.conversation
        request = self._agreements.applied_to(request)
        result, spoken = self.attempt(request, before)
        if result.answer.ending == "done" and self._names_several(turn):
            spoken = f"{conversation.say(AnswerContent('one_only'))} {spoken}"
        spoken = self._asking_for_use(turn, result, spoken)
        self._last = (turn, request)
        reply = replace(conversation.reply(turn, spoken, result.answer.ending), result=result)
        has_more = rest and reply.is_done
        if not has_more:
            conversation.record(reply, turn)
        self._record_episode(request, reply, turn.keep)
        if has_more:
            return self._carry_out(turn, rest[0], rest[1:], result)
        conversation.last_done, conversation.control_done = reply, None
        again = partial(self._carry_out, turn, request, rest, before)
        self._interrupted = again if reply.is_interrupted else None
        self._just_stopped = result.answer if reply.is_interrupted else None
        conversation.topic = ()
        conversation.set_topic(reply.decision.rules if reply.decision else ())
        conversation.topic_from, conversation.unanswered = "deed", ""
        wanted, chosen = request.arguments.get("object"), reply.chosen
        if chosen and isinstance(wanted, Target) and wanted.object is None:
            conversation.discourse = conversation.discourse.about(chosen.object)
        if result.doubt:
            again = partial(self._carry_out, turn, request)
            question = self._agreements.question(result.doubt, request, turn.speaker, again)
            conversation.open_question = question
            return reply
        if (verdict := result.forbidding) and verdict.forbidding:
            conversation.set_topic((verdict.forbidding,))
        if first := self._norms.first_request(request, result):
            conversation.wait_for(turn, lambda: self._carry_out(turn, first, (request, *rest)))
        elif reply.ending == "asked":
            self._wait_for_answer(turn, request, result, rest)
        return reply

    def _names_several(self, turn: UnderstoodTurn) -> bool:
        said = turn.understood.meaning
        name = (chosen_by(said).object or "") if isinstance(said, meaning.SimpleCommand) else ""
        several = self.conversation.language.inflection.form(name, "plural")
        return several != name and f" {several} " in f" {' '.join(turn.understood.words)} "

    def _wait_for_answer(
        self, turn: UnderstoodTurn, request: Request, result: GoalResult, rest: Sequence[Request]
    ) -> None:
        carry_out = partial(self._carry_out, turn)
        is_so, is_not = (request.told(result, is_so=each) for each in (True, False))
        settled = is_so or request.confirmed(result)

        def choose(named: meaning.Answer) -> Reply:
            name = None if named.name == meaning.ANY_OBJECT else named.name
            return carry_out(request.choosing(name, named.props, result), rest)

        if settled:
            self.conversation.wait_for(
                turn,
                yes=lambda: carry_out(settled, rest),
                no=(lambda: carry_out(is_not, rest)) if is_not else None,
                choose=None if is_so else choose,
                needs_yes=is_so is not None,
            )

    def _asking_for_use(self, turn: UnderstoodTurn, result: GoalResult, spoken: str) -> str:
        said, conversation = turn.understood.meaning, self.conversation
        conversation.open_question = None
        if result.answer.key != "nothing_used_for" or not isinstance(said, meaning.SimpleCommand):
            return spoken
        asked = use_of(said)
        self._clarification.wait_to_learn(turn, asked)
        slots = {"affordance": use_slot(asked.affordance or "", asked.material)}
        return f"{spoken} {conversation.say(AnswerContent('tell_use', slots))}"

    # --- Controls -----------------------------------------------------------------------------

    def _obey(self, turn: UnderstoodTurn, said: meaning.Control) -> Reply:
        conversation = self.conversation
        pending, conversation.open_question = conversation.open_question, None
        conversation.reason = None if said.control == "continue" else turn.understood
        stopped, self._just_stopped = self._just_stopped, None
        if said.control == "stop" and stopped:
            return conversation.spoken(turn, replace(stopped, ending="done"))
        if said.is_halt:
            key = "waiting" if said.control == "wait" else "idle"
            return conversation.answered(turn, key, "done")
        if said.control == "continue":
            return self._continue(turn, pending)
        if conversation.last_done is None:  # there is no need of a body yet
            return conversation.answered(turn, "nothing_held", "failed")
        emptied = self._goals().empty_hand(said.control, said.object)
        if emptied.ending == "done":
            conversation.control_done = emptied
        return conversation.spoken(turn, emptied)

    def _continue(self, turn: UnderstoodTurn, pending: OpenQuestion | None) -> Reply:
        if pending and pending.yes and pending.asked == turn.speaker:
            return pending.yes()
        if self._interrupted:
            return self._interrupted()
        if self._last and self._last[0].speaker == turn.speaker:
            self.conversation.wait_for(turn, partial(self._carry_out, *self._last))
            return self.conversation.answered(turn, "continue_what", "asked")
        return self.conversation.answered(turn, "nothing_to_continue", "failed")

    # --- Questions, acknowledgements, and what is asked back -----------------------------------

    def _answer(self, turn: UnderstoodTurn, said: meaning.Question) -> Reply:
        conversation = self.conversation
        found, rules = self._norms.answer(turn, said) or answer(said, conversation)
        if not rules and (said.object or said.affordance):
            conversation.topic = ()
        if said.ask not in {"why", "why_not", "source", "confidence", "repeated"}:
            is_noted = found.ending == "done" and not rules and said.ask in {"state", "about"}
            conversation.reason = conversation.noted_in.get(said.object or "") if is_noted else None
        if found.ending == "failed":
            conversation.topic, conversation.unanswered = (), conversation.say(found)
            self._clarification.wait_to_learn(turn, said)
        if said.object and said.property:
            said_so = meaning.TopicStatement(said.object, (said.property,))
            yes = partial(self._beliefs.open_topic, turn, said_so)
            no = partial(self._beliefs.open_topic, turn, replace(said_so, denied=True))
            conversation.wait_for(turn, yes, no=no, needs_yes=True)
        if found.key in {"is_not_used_for", "is_used_otherwise"}:
            use, sure = said.affordance or "", conversation.language.usual
            rule = meaning.FunctionalRule(said.object or "", use, sure, material=said.material)
            yes = partial(self._clarification.learn_rule, turn, rule)
            no = partial(conversation.answered, turn, "dismissed", "done")
            conversation.wait_for(turn, yes, no=no, needs_yes=True, is_lesson=True)
            conversation.unanswered = conversation.say(found)
        conversation.set_topic(rules)
        named = {rule.object for rule in rules if rule.object}
        if said.object is None and len(named) == 1:  # the answer named it
            conversation.discourse = conversation.discourse.about(*named)
        is_view = found.key in {"see", "see_nothing"}
        spoken = self.showing.say_seen(found) if is_view else conversation.say(found)
        if spoken == conversation.last_said:
            spoken = conversation.say(AnswerContent("as_said", {"said": spoken}))
        return replace(conversation.recorded(turn, spoken, found.ending), rules=rules)

    def _acknowledge(self, turn: UnderstoodTurn, said: meaning.Acknowledgement) -> Reply:
        conversation, pending = self.conversation, self.conversation.open_question
        pending = pending if pending and pending.asked == turn.speaker else None
        if pending:  # what was asked about can be referred to again
            conversation.open_question = None
            conversation.discourse = replace(conversation.discourse, has_failed=False)
            agreed = {"yes"} if pending.needs_yes else {"yes", "okay"}
            follow = pending.yes if said.ack in agreed else pending.no if said.ack == "no" else None
            if follow:
                return follow()
        elif said.ack == "no":
            return conversation.answered(turn, "dismissed", "done")
        if said.name:
            return conversation.spoken(turn, conversation.people.meet(turn.speaker, said.name))
        return conversation.answered(turn, answer_to(said.ack), "done")
