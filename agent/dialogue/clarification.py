# SPDX-License-Identifier: Apache-2.0
"""Clarification dialogues: what Hilt asks back, and what an answer to it leads to."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial

from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ..execution.outcome import SpokenAnswer
from .conversation import Conversation, DialogueTurn
from .open_question import OpenQuestion
from .reply import Reply
from .teaching import rule_from_answer


class ClarificationDialogue(Conversation):
    """A conversation in which Hilt asks back, and understands short answers."""

    @abstractmethod
    def hear(
        self,
        text: str,
        *,
        speaker: str,
        only: str | None = None,
        heard: float = 1.0,
        keep: bool = True,
        accepted: Collection[str] = (),
    ) -> Reply:
        """Understand one utterance, act on it, and return the reply."""

    @abstractmethod
    def _respond(self, turn: DialogueTurn) -> Reply:
        """Act on what was understood, and return the reply."""

    def _understood(
        self, text: str, speaker: str, accepted: Collection[str], heard: float
    ) -> Understanding:
        said = self._other.understand(text, speaker=speaker) if self._other else None
        if said is not None:
            return Understanding(text, speaker, "self", said, discourse=self._discourse)
        return self.language.understand(
            text, speaker=speaker, discourse=self._discourse, accepted=accepted, heard=heard
        )

    def _short_answer(self, text: str, speaker: str, *, heard: float, keep: bool) -> Reply | None:
        """The reply to an answer to the open question; None where the text is none."""
        open_question = self._open
        if open_question is None or open_question.asked != speaker:
            return None
        insisted = self._insists(text, speaker)
        if insisted:
            return insisted()
        for answered in self._short_answers(text, open_question):
            if answered.is_dismissal:
                self._open = None
                dismissal = Understanding(text, speaker, "self", meaning.Acknowledgement("no"))
                return self._answered(DialogueTurn(dismissal, heard, keep), "dismissed", "done")
            reply = open_question.reply_to(answered)
            if reply:
                self._open = None if self._open is open_question else self._open
                return reply
        return None

    def _short_answers(self, text: str, open_question: OpenQuestion) -> list[meaning.Answer]:
        """The short answers that a text may be, a number of one of the choices included."""
        choices, speaker = open_question.choices, open_question.asked
        number = self.language.chosen(text, len(choices)) if choices else None
        if number:
            return [meaning.Answer(number=number)]
        return self.language.short_answers(text, speaker=speaker, discourse=self._discourse)

    def _ask_back(self, turn: DialogueTurn, said: meaning.AskBack) -> Reply:
        reply = self._recorded(turn, said.question, "asked")
        choices = [each for each in said.choices if not isinstance(each, str)]
        if choices:
            self._offer(turn, said, choices)
            return reply
        text, speaker = turn.understood.text, turn.speaker
        if said.choices == (text,):  # heard with low confidence: a "yes" confirms it
            self._open = OpenQuestion(
                speaker, lambda: self.hear(text, speaker=speaker, keep=turn.keep)
            )
        elif not said.choices:
            self._open = OpenQuestion(
                speaker,
                choose=lambda named: self._with_referent(turn, named),
            )
        else:
            self._open = self._on_word(turn, said)
        return reply

    def _offer(
        self, turn: DialogueTurn, said: meaning.AskBack, choices: Sequence[meaning.Meaning]
    ) -> None:
        """Wait for the choice of a meaning."""
        heard = tuple(partial(self._take, turn, each) for each in choices)
        again = partial(self._ask_back, turn, said)
        only = heard[0] if len(heard) == 1 else again
        self._open = OpenQuestion(turn.speaker, only, choices=heard)

    def _take(self, turn: DialogueTurn, choice: meaning.Meaning) -> Reply:
        """Respond to a chosen meaning, of the sentence that has it or as one that says it."""
        if turn.understood.reading is not None:
            return self._respond(replace(turn, understood=turn.understood.chosen(choice)))
        text = self.language.generate(choice)
        return self.hear(text, speaker=turn.speaker, heard=turn.heard)

    def _with_referent(self, turn: DialogueTurn, named: meaning.Answer) -> Reply | None:
        """Understand an utterance again with what "it" refers to, or ask for the whole sentence."""
        name = named.name
        if name in {None, meaning.ANY_OBJECT}:
            return None
        self._discourse = replace(self._discourse.about(str(name)), has_failed=False)
        text = turn.understood.text
        again = self._understood(text, turn.speaker, (), turn.heard)
        if again.kind in {"ask_back", "error"}:
            return self._answered(turn, "say_again", "asked", object=str(name))
        return self.hear(text, speaker=turn.speaker, heard=turn.heard, keep=turn.keep)

    def _learn_answer(
        self, turn: DialogueTurn, asked: meaning.Question, named: meaning.Answer
    ) -> Reply | None:
        """Learn what a short answer to a question without an answer teaches."""
        rule = rule_from_answer(asked, named, self.language.usual)
        if rule is None:
            return None
        text = self.language.generate(meaning.Statement((rule,)))
        return self.hear(text, speaker=turn.speaker, heard=turn.heard)

    def _on_word(self, turn: DialogueTurn, said: meaning.AskBack) -> OpenQuestion | None:
        """Wait for the answer whether a word is a slip of the one suggested, or an object, too."""
        words, speaker = turn.understood.words, turn.speaker
        again = partial(self.hear, speaker=speaker, heard=turn.heard)
        unknown = [word for word in words if not self.language.knows(word)]
        match said.choices:
            case (str(choice),) if choice in words:
                return OpenQuestion(speaker, lambda: again(turn.understood.text, accepted=[choice]))
            case (str(choice),) if unknown:
                meant = " ".join(choice if word == unknown[0] else word for word in words)
                new = partial(again, turn.understood.text, accepted=unknown[:1])
                return OpenQuestion(speaker, lambda: again(meant), new, word=unknown[0])
            case _:
                return None

    def _insists(self, text: str, speaker: str) -> Callable[[], Reply] | None:
        """What follows when a text insists on the word that Hilt asked about; None otherwise."""
        asked = self._open
        if asked is None or asked.asked != speaker or not asked.word:
            return None
        return asked.no if self.language.insists_on(asked.word, text) else None

    def _not_understood(self, turn: DialogueTurn, said: meaning.Misunderstanding) -> Reply:
        problem = said.message
        if self._last_said.startswith(problem):
            problem = self._say(SpokenAnswer("still_not_understood"))
        example = SpokenAnswer("try_saying", {"example": said.nearest[:1]})
        step = self._say(example if said.nearest else SpokenAnswer("ask_for_help"))
        spoken = problem if problem.endswith("?") else f"{problem} {step}"
        return self._recorded(turn, spoken, "not_understood")
