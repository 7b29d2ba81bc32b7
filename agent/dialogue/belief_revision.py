"""Belief revision: statements are believed, retracted rules are no longer, topics are opened.

The interval of a rule has three sources: the word of confidence in the sentence, the confidence of
the speech recogniser, and the trust in the speaker. The first two are in the stored interval
(Shafer's discounting); trust is applied when the rule is used, since it may change.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain

from ...inference.taxonomy import Taxonomy
from ...kb.interval import VACUOUS
from ...kb.rule import Atom, Rule
from ...nlu.lexicon.vocabulary import NewWord
from ...nlu.semantics import meaning
from ..execution.outcome import AnswerContent
from .conversation import Conversation, UnderstoodTurn
from .reply import Reply
from .translation import Lesson, rule_from_meaning

_BARE = (meaning.Retraction(), meaning.Retraction(is_of_told=True))
"""What takes back a rule without naming it."""


class BeliefRevision:
    """Changes what Hilt believes by what is said in a conversation."""

    def __init__(self, conversation: Conversation) -> None:
        self._base, self._conversation = conversation.base, conversation

    def learn_kinds(self, turn: UnderstoodTurn, said: meaning.KindStatement) -> Reply:
        """Believe of which kinds things are, unless they would be kinds of themselves."""
        above, conversation = Taxonomy.from_base(self._base).names_above, self._conversation
        told = [each for each in said.rules if not each.denies]
        circles = (each for each in told if each.object in above("object", each.kind_of))
        turned = (replace(each, object=each.kind_of, kind_of=each.object) for each in circles)
        if known := tuple(map(conversation.language.answers.kind_phrase, turned)):
            return conversation.answered(turn, "kind_circle", "failed", rules=known)
        return self.learn(turn, said)

    def learn(self, turn: UnderstoodTurn, said: Lesson) -> Reply:
        """Believe what a speaker states, and return the reply that says what that is."""
        base, conversation = self._base, self._conversation
        source = base.match_speaker(said.source) if said.source else None
        # What somebody told the speaker is discounted by the trust in the speaker now, and by the
        # trust in that person when it is used.
        trust = conversation.people.trust_in(turn.speaker) if source else 1.0
        author, weight = source or turn.speaker, turn.heard * trust
        rules = tuple(rule_from_meaning(each, author, weight) for each in said.rules)
        same = {old.id: old for rule in rules for old in base.rules_with_premises_of(rule)}
        before = sorted(same.values(), key=lambda rule: (rule.utterance or 0, rule.id))
        revising = (new for new, each in zip(rules, said.rules, strict=True) if each.revises)
        corrected = (_corrected(new, before, conversation.topic) for new in revising)
        replaced = list(dict.fromkeys(chain.from_iterable(corrected)))
        is_known = not replaced and {rule.id for rule in rules} <= {rule.id for rule in before}
        key = "known_already" if is_known else self._key(turn, source, is_revised=bool(replaced))
        described = tuple(map(conversation.describe, rules))
        answers = [AnswerContent(key, {"rules": described, "speaker": author})]
        words = (*turn.understood.new_words, *self._new_names(said, turn))
        if words:
            new = tuple(word.word for word in words)
            answers.append(AnswerContent("learned_words", {"words": new}))
        reasons = conversation.language.reasons(turn.understood.text)
        if grounds := _reason_rules(rules, reasons):
            answers.append(AnswerContent("learned_reason", {"reasons": reasons}))
        spoken = " ".join(map(conversation.say, answers))
        old, kind = [rule.id for rule in replaced], turn.understood.kind
        known = (*grounds, *rules)
        conversation.believe(turn, known, spoken, words, supersedes=old, kind=kind, source=source)
        return conversation.lesson_reply(turn, rules, spoken)

    def _rules_to_retract(
        self, said: meaning.Retraction, speaker: str, topic: Sequence[Rule]
    ) -> Sequence[Rule]:
        """Return the rules that a speaker retracts, or those of others if the speaker has none.

        They are those about the object that is named, or the one rule that is named, or the last
        one to hold something by the named part, else the last one of the `topic`, else of all.
        """
        if said.about:
            named = None if said.about == meaning.ANY_OBJECT else said.about
            rules = self._base.rules(object=named)
            return [rule for rule in rules if rule.speaker == speaker] or rules
        if said.part:
            return self._base.rules(part=said.part, speaker=speaker)[-1:]
        if said.rule is None and topic:
            return topic[-1:]
        told = sorted(self._base.rules(speaker=speaker), key=lambda rule: rule.utterance or 0)
        if said.rule is not None:
            wanted = rule_from_meaning(said.rule, speaker)
            same = (rule for rule in told if rule.argument == wanted.argument)
            return [rule for rule in same if _can_replace(rule, wanted)][-1:]
        return told[-1:]

    def _key(self, turn: UnderstoodTurn, source: str | None, *, is_revised: bool) -> str:
        trust = self._conversation.people.trust_in(source or turn.speaker)
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
        is_bare = said == meaning.Retraction() and not is_just_told
        language, text = conversation.language, turn.understood.text
        answers = language.short_answers(text, conversation.discourse) if is_bare else ()
        if any(each.is_dismissal for each in answers):
            return conversation.answered(turn, "dismissed", "done")
        is_of_told = said.is_of_told or conversation.topic_from == "deed"
        topic = () if is_of_told and not is_just_told else conversation.topic
        rules = self._rules_to_retract(said, turn.speaker, topic)
        noted = conversation.noted.pop(said.about or "", None)
        own = [rule for rule in rules if conversation.people.may_end(turn.speaker, rule)]
        if rules and not own:
            return conversation.answered(turn, "not_yours", "failed", speaker=rules[0].speaker)
        if not own:
            nothing = ("dismissed", "done") if noted else ("nothing_to_forget", "failed")
            return conversation.answered(turn, *nothing)
        if said in _BARE and not topic:
            conversation.wait_for(turn, lambda: self._retract(turn, own))
            described = conversation.describe(own[-1])
            return conversation.answered(turn, "forget_what", "asked", rule=described)
        return self._retract(turn, own)

    def open_topic(self, turn: UnderstoodTurn, said: meaning.TopicStatement) -> Reply:
        """Ask about what the speaker wants to speak of, which may be a new thing."""
        conversation = self._conversation
        conversation.note(said.topic, said.props, is_so=not said.denied)
        conversation.noted_in[said.topic] = turn.understood
        key = ("noted_not" if said.denied else "noted") if said.props else "topic"
        slots = {"object": said.topic, "properties": said.props}
        spoken = conversation.say(AnswerContent(key, slots))
        conversation.believe(turn, (), spoken, turn.understood.new_words, kind="topic")
        conversation.wait_for(turn)
        return conversation.reply(turn, spoken, "asked" if said.props else "done")

    def _new_names(self, said: Lesson, turn: UnderstoodTurn) -> Iterator[NewWord]:
        known = {meaning.ANY_OBJECT, *(word.word for word in turn.understood.new_words)}
        for name in dict.fromkeys(rule.object for rule in said.rules):
            if name not in known and not self._conversation.language.lexicon.name_categories(name):
                yield NewWord(name, "object", name)

    def _retract(self, turn: UnderstoodTurn, rules: Sequence[Rule]) -> Reply:
        conversation = self._conversation
        phrases, ids = tuple(map(conversation.describe, rules)), [rule.id for rule in rules]
        spoken = conversation.say(AnswerContent("forgotten", {"rules": phrases}))
        conversation.believe(turn, (), spoken, retracts=ids, kind="correction")
        conversation.topic, conversation.retracted = (), tuple(rules)
        return replace(conversation.reply(turn, spoken), rules=conversation.retracted)


def _reason_rules(rules: Sequence[Rule], reasons: Sequence[str]) -> list[Rule]:
    """Return what says on which properties the use in a rule rests; nothing for several rules."""
    if not reasons or len(rules) != 1 or not rules[0].affordance or not rules[0].asserts:
        return []
    features = frozenset(Atom("property", name) for name in reasons)
    return [replace(rules[0], features=features, interval=VACUOUS)]


def _corrected(new: Rule, before: Sequence[Rule], topic: Sequence[Rule]) -> Sequence[Rule]:
    """Return the rules that a rule corrects, among earlier ones and the topic."""
    same = [old for old in before if _can_replace(old, new) and old.id != new.id]
    last = topic[-1] if topic else None
    if same or last is None or last.speaker != new.speaker or last.functor != new.functor:
        return same
    if last.asserts and not new.asserts:  # "no, never for metal" leaves what it is used for
        return same
    uses = [(rule.argument, rule.material) for rule in (last, new)]
    changed = (last.features != new.features) + (uses[0] != uses[1])
    return [last] if changed == 1 and last.context == new.context else []


def _can_replace(one: Rule, other: Rule) -> bool:
    """Return whether one rule can correct the other: about the same object, in the same context."""
    if (one.features, one.contexts, one.functor) != (other.features, other.contexts, other.functor):
        return False
    return one.kind == "action" or one.argument == other.argument
