"""Belief revision: statements are believed, retracted rules are no longer, topics are opened."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ...inference.taxonomy import Taxonomy
from ...kb.rule import Rule
from ...nlu.lexicon.vocabulary import NewWord
from ...nlu.semantics import meaning
from ..execution.outcome import AnswerContent
from . import teaching
from .conversation import Conversation, UnderstoodTurn
from .reply import Reply
from .translation import Lesson

_BARE = (meaning.Retraction(), meaning.Retraction(is_of_told=True))
"""What takes back a rule without naming it."""


class BeliefRevision:
    """Changes what Hilt believes by what is said in a conversation."""

    def __init__(self, conversation: Conversation) -> None:
        self._base, self._conversation = conversation.base, conversation

    def learn_kinds(self, turn: UnderstoodTurn, said: meaning.KindStatement) -> Reply:
        """Believe of which kinds things are, unless they would be kinds of themselves."""
        taxonomy = Taxonomy.from_base(self._base)
        words = self._conversation.language.answers
        known = tuple(
            words.kind_phrase(replace(each, object=each.kind_of, kind_of=each.object))
            for each in said.rules
            if not each.denies and each.object in taxonomy.names_above("object", each.kind_of)
        )
        if known:
            return self._conversation.answered(turn, "kind_circle", "failed", rules=known)
        return self.learn(turn, said)

    def learn(self, turn: UnderstoodTurn, said: Lesson) -> Reply:
        """Believe what a speaker states, and return the reply that says what that is."""
        base, conversation = self._base, self._conversation
        source = base.match_speaker(said.source) if said.source else None
        rules = teaching.told_rules(base, said, turn.speaker, turn.heard)
        before = teaching.earlier_rules(base, rules)
        replaced = teaching.replaced_rules(said, rules, before, conversation.topic)
        is_known = not replaced and {rule.id for rule in rules} <= {rule.id for rule in before}
        key = "known_already" if is_known else self._key(turn, source, is_revised=bool(replaced))
        described = tuple(map(conversation.describe, rules))
        answers = [AnswerContent(key, {"rules": described, "speaker": source or turn.speaker})]
        words = (*turn.understood.new_words, *self._new_names(said, turn))
        if words:
            slots = {"words": tuple(word.word for word in words)}
            answers.append(AnswerContent("learned_words", slots))
        reasons = conversation.language.reasons(turn.understood.text)
        grounds = teaching.reason_rules(rules, reasons)
        if grounds:
            answers.append(AnswerContent("learned_reason", {"reasons": reasons}))
        spoken = " ".join(map(conversation.say, answers))
        conversation.believe(
            turn,
            (*grounds, *rules),
            spoken,
            words,
            supersedes=[rule.id for rule in replaced],
            kind=turn.understood.kind,
            source=source,
        )
        return conversation.lesson_reply(turn, rules, spoken)

    def _key(self, turn: UnderstoodTurn, source: str | None, *, is_revised: bool) -> str:
        trust = teaching.trust_in(self._base, source or turn.speaker)
        if source:
            return "learned_report" if trust else "learned_unknown_report"
        if trust < 1.0:
            return "learned_doubtfully"
        if turn.heard < 1.0:
            return "learned_unclearly"
        return "revised" if is_revised else "learned"

    def forget(self, turn: UnderstoodTurn, said: meaning.Retraction) -> Reply:
        """Retract what the speaker takes back, or ask whether it is meant; return the reply."""
        conversation = self._conversation
        is_just_told = bool(conversation.topic) and conversation.topic_from == "lesson"
        if said == meaning.Retraction() and not is_just_told and self._is_dismissal(turn):
            return conversation.answered(turn, "dismissed", "done")
        is_of_told = said.is_of_told or conversation.topic_from == "deed"
        topic = () if is_of_told and not is_just_told else conversation.topic
        rules = teaching.rules_to_retract(self._base, said, turn.speaker, topic)
        own = [rule for rule in rules if teaching.may_end(self._base, turn.speaker, rule)]
        if rules and not own:
            return conversation.answered(turn, "not_yours", "failed", speaker=rules[0].speaker)
        if not own:
            return conversation.answered(turn, "nothing_to_forget", "failed")
        if said in _BARE and not topic:
            conversation.wait_for(turn, lambda: self._retract(turn, own))
            described = conversation.describe(own[-1])
            return conversation.answered(turn, "forget_what", "asked", rule=described)
        return self._retract(turn, own)

    def open_topic(self, turn: UnderstoodTurn, said: meaning.TopicStatement) -> Reply:
        """Ask about what the speaker wants to speak of, which may be a new thing."""
        conversation = self._conversation
        spoken = conversation.say(AnswerContent("topic", {"object": said.topic}))
        conversation.believe(turn, (), spoken, turn.understood.new_words, kind="topic")
        conversation.wait_for(turn)
        return conversation.reply(turn, spoken)

    def _is_dismissal(self, turn: UnderstoodTurn) -> bool:
        conversation, text = self._conversation, turn.understood.text
        answers = conversation.language.short_answers(
            text, speaker=turn.speaker, discourse=conversation.discourse
        )
        return any(each.is_dismissal for each in answers)

    def _new_names(self, said: Lesson, turn: UnderstoodTurn) -> Iterator[NewWord]:
        known = {meaning.ANY_OBJECT, *(word.word for word in turn.understood.new_words)}
        for name in dict.fromkeys(rule.object for rule in said.rules):
            if name not in known and not self._conversation.language.lexicon.name_categories(name):
                yield NewWord(name, "object", name)

    def _retract(self, turn: UnderstoodTurn, rules: Sequence[Rule]) -> Reply:
        conversation = self._conversation
        phrases = tuple(map(conversation.describe, rules))
        spoken = conversation.say(AnswerContent("forgotten", {"rules": phrases}))
        retracts = [rule.id for rule in rules]
        conversation.believe(turn, (), spoken, retracts=retracts, kind="correction")
        conversation.topic, conversation.retracted = (), tuple(rules)
        return replace(conversation.reply(turn, spoken), rules=conversation.retracted)
