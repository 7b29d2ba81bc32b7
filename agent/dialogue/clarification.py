"""Clarification dialogues: what Hilt asks back, and what an answer to it leads to."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from ...inference.affordance import Affordances
from ...inference.experience import OutcomeCounts, contradiction
from ...kb.interval import CERTAIN
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ..execution.doubt import Doubt
from ..execution.outcome import AnswerContent
from ..execution.request import Request
from .conversation import Conversation, UnderstoodTurn
from .reply import OpenQuestion, Reply
from .translation import rule_from_answer


@dataclass(frozen=True)
class ClarificationDialogue:
    """What Hilt asks back in a conversation, and its understanding of short answers.

    `hear` is `DialogueManager.hear`, for what is heard again or what a short answer stands for.
    """

    conversation: Conversation
    hear: Callable[..., Reply]
    respond: Callable[[UnderstoodTurn], Reply]

    def short_answer(self, text: str, speaker: str, *, heard: float, keep: bool) -> Reply | None:
        """Return the reply to an answer to the open question; None where the text is none."""
        conversation, language = self.conversation, self.conversation.language
        open_question = conversation.open_question
        if open_question is None or open_question.asked != speaker:
            return None
        word, is_new = open_question.word, open_question.no
        if word and is_new and language.insists_on(word, text):
            return is_new()
        if open_question.tell and (told := open_question.tell(text)):
            return told
        choices = open_question.choices
        number = language.chosen(text, len(choices)) if choices else None
        short = [meaning.Answer(number=number)] if number else None
        for answered in short or language.short_answers(text, conversation.discourse):
            if answered.is_dismissal:
                conversation.open_question = None
                dismissal = Understanding(text, speaker, "self", meaning.Acknowledgement("no"))
                turn = UnderstoodTurn(dismissal, heard, keep)
                return conversation.answered(turn, "dismissed", "done")
            if reply := open_question.reply_to(answered):
                if conversation.open_question is open_question:
                    conversation.open_question = None
                return reply
        return None

    def ask_back(self, turn: UnderstoodTurn, said: meaning.AskBack) -> Reply:
        """Ask what a turn leaves open, and wait for the answer; return the reply that asks."""
        act = next(iter(said.choices), None)
        if not said.question and isinstance(act, meaning.ActionCommand):  # that nobody has taught
            return self.respond(replace(turn, understood=replace(turn.understood, meaning=act)))
        reply = self.conversation.recorded(turn, said.question, "asked")
        text, speaker, wait_for = turn.understood.text, turn.speaker, self.conversation.wait_for
        if choices := [each for each in said.choices if not isinstance(each, str)]:
            heard = tuple(partial(self._take, turn, each) for each in choices)
            only = heard[0] if len(heard) == 1 else partial(self.ask_back, turn, said)
            wait_for(turn, only, choices=heard)
        elif said.choices == (text,):  # heard with low confidence: a "yes" confirms it
            wait_for(turn, lambda: self.hear(text, speaker=speaker, keep=turn.keep))
        elif not said.choices:
            wait_for(turn, choose=partial(self._with_referent, turn))
        else:
            self.conversation.open_question = self._on_word(turn, said)
        return reply

    def _take(self, turn: UnderstoodTurn, choice: meaning.Meaning) -> Reply:
        if turn.understood.reading is not None:
            return self.respond(replace(turn, understood=turn.understood.chosen(choice)))
        text = self.conversation.language.generate(choice)
        reply = self.hear(text, speaker=turn.speaker, heard=turn.heard)
        self.conversation.learn_phrase(turn, choice)
        return reply

    def _with_referent(self, turn: UnderstoodTurn, named: meaning.Answer) -> Reply | None:
        conversation, name, text = self.conversation, named.name, turn.understood.text
        if named.is_use or name in {None, meaning.ANY_OBJECT}:
            return None
        before = conversation.discourse
        for referring in (before.with_person(str(name)), before.about(str(name))):
            conversation.discourse = replace(referring, has_failed=False)
            again = conversation.understand(text, turn.speaker, heard=turn.heard)
            if again.kind not in {"ask_back", "error"}:
                return self.hear(text, speaker=turn.speaker, heard=turn.heard, keep=turn.keep)
        return conversation.answered(turn, "say_again", "asked", object=str(name))

    def wait_to_learn(self, turn: UnderstoodTurn, asked: meaning.Question) -> None:
        """Wait for a short answer that teaches what a question asks that Hilt could not answer."""

        def learn(named: meaning.Answer) -> Reply | None:
            rule = rule_from_answer(asked, named, self.conversation.language.usual)
            return self.learn_rule(turn, rule) if rule else None

        self.conversation.wait_for(turn, choose=learn, is_lesson=True)

    def settled(self, found: Understanding) -> Understanding:
        """Return a turn as Hilt understands it that has just asked to be told something.

        "Sometimes for cutting" is an answer then, and need not be asked about.
        """
        pending, reading = self.conversation.open_question, found.reading
        is_lesson = pending and pending.is_lesson and pending.asked == found.speaker
        is_fragment = reading and reading.speech_act.name == "FRAGMENT"
        match found.meaning:
            case meaning.AskBack(choices=(meaning.Statement() as told,)) if is_lesson:
                return found.chosen(told) if is_fragment else found
            case _:
                return found

    def learn_rule(self, turn: UnderstoodTurn, rule: meaning.Rule) -> Reply:
        """Learn the rule that an answer to a question of Hilt stands for; return the reply."""
        text = self.conversation.language.generate(meaning.Statement((rule,)))
        return self.hear(text, speaker=turn.speaker, heard=turn.heard)

    def _on_word(self, turn: UnderstoodTurn, said: meaning.AskBack) -> OpenQuestion | None:
        text, words, speaker = turn.understood.text, turn.understood.words, turn.speaker
        again = partial(self.hear, speaker=speaker, heard=turn.heard)
        unknown = [word for word in words if word not in self.conversation.language.lexicon]
        match said.choices:
            case (str(choice),) if choice in words:
                return OpenQuestion(speaker, partial(again, text, accepted=[choice]))
            case (str(choice),) if unknown:
                meant = " ".join(choice if word == unknown[0] else word for word in words)
                yes, no = partial(again, meant), partial(again, text, accepted=unknown[:1])
                return OpenQuestion(
                    speaker,
                    yes,
                    no,
                    choose=lambda named: yes() if named.name == choice else None,
                    word=unknown[0],
                )
            case _:
                return None

    def not_understood(self, turn: UnderstoodTurn, said: meaning.Misunderstanding) -> Reply:
        """Return the reply that says what is wrong with a turn, and what could be said instead."""
        conversation, problem = self.conversation, said.message
        example = AnswerContent("try_saying", {"example": said.nearest[:1]})
        step = conversation.say(example if said.nearest else AnswerContent("ask_for_help"))
        spoken = problem if problem.endswith("?") else f"{problem} {step}"
        conversation.unanswered = step
        return conversation.recorded(turn, spoken, "not_understood")


class PartAgreements:
    """The parts to grasp by that were agreed on, where experience speaks against what was told.

    Hilt asks, and follows the answer from then on in the conversation, until what happens
    afterwards contradicts it, too. What was told, and the trust in who told it, are not changed.
    """

    def __init__(self, affordances: Callable[[], Affordances]) -> None:
        self._affordances = affordances
        # By goal and kind of object: the part, the action it is for, and the outcomes till then.
        self._agreed: dict[tuple[str, str], tuple[str, str, OutcomeCounts]] = {}

    def applied_to(self, request: Request) -> Request:
        """Return a request with the parts that were agreed on for its goal and that still stand."""
        standing: dict[str, str] = {}
        for (goal, kind), (part, context, counts) in self._agreed.items():
            if goal == request.action:
                affordances = self._affordances()
                since = affordances.outcomes(kind, part, context).since(counts).interval
                if contradiction(CERTAIN, since) <= affordances.settings.contradiction:
                    standing[kind] = part
        return replace(request, agreed=standing)

    def question(
        self, doubt: Doubt, request: Request, asked: str, carry_out: Callable[[], Reply]
    ) -> OpenQuestion:
        """Return the question about a doubt; an answer lets the request be carried out again."""

        def take(part: str) -> Reply:
            counts = self._affordances().outcomes(doubt.object, part, doubt.context)
            self._agreed[request.action, doubt.object] = (part, doubt.context, counts)
            return carry_out()

        return OpenQuestion(
            asked,
            yes=lambda: take(doubt.instead or doubt.part),
            no=(lambda: take(doubt.part)) if doubt.instead else None,
            choose=lambda named: take(named.name) if named.name else None,
        )
