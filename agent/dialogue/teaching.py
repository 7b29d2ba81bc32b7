"""What a statement teaches: its rules, the rules that they replace, and its new words.

The interval of a rule has three sources: the word of confidence in the sentence, the confidence of
the speech recogniser, and the trust in the speaker. The first two are in the stored interval
(Shafer's discounting); trust is applied when the rule is used, since it may change.
"""

from collections.abc import Sequence
from dataclasses import replace

from ...kb.history import IMPORT
from ...kb.interval import VACUOUS
from ...kb.knowledge_base import KnowledgeBase
from ...kb.learned import LearnedWord
from ...kb.rule import Atom, Rule
from ...nlu.lexicon.vocabulary import NewWord
from ...nlu.semantics import meaning
from .translation import Lesson, rule_from_meaning

KINDS = {"context": "action"}  # role of a new word -> kind of what it denotes
ROLES = {kind: role for role, kind in KINDS.items()}


def told_rules(base: KnowledgeBase, said: Lesson, speaker: str, heard: float) -> tuple[Rule, ...]:
    """Return the rules that a statement asserts, discounted by the confidence of the recogniser.

    What somebody told the speaker is discounted by the trust in the speaker now, and by the trust
    in that person when it is used.
    """
    source = base.match_speaker(said.source) if said.source else speaker
    weight = heard * trust_in(base, speaker) if said.source else heard
    return tuple(rule_from_meaning(each, source, weight) for each in said.rules)


def replaced_rules(
    said: Lesson, rules: Sequence[Rule], before: Sequence[Rule], topic: Sequence[Rule]
) -> list[Rule]:
    """Return the rules that those of a statement correct, among earlier ones and the topic."""
    corrected = (new for new, each in zip(rules, said.rules, strict=True) if each.revises)
    return list(dict.fromkeys(old for new in corrected for old in _corrected(new, before, topic)))


def reason_rules(rules: Sequence[Rule], reasons: Sequence[str]) -> list[Rule]:
    """Return what says on which properties the use in a rule rests; nothing for several rules.

    It is a rule about anything with these properties that neither asserts nor denies the use.
    """
    uses = [rule for rule in rules if rule.affordance and rule.asserts]
    if not reasons or len(rules) != 1 or not uses:
        return []
    features = frozenset(Atom("property", name) for name in reasons)
    return [replace(uses[0], features=features, interval=VACUOUS)]


def trust_in(base: KnowledgeBase, speaker: str) -> float:
    """Return the lower bound of the trust in a speaker, 0 where nobody has set it."""
    trust = base.trust(speaker)
    return trust.lower if trust else 0.0


def reporter_of(base: KnowledgeBase, rule: Rule) -> str:
    """Return who told Hilt a rule: its speaker, or who reported what its speaker said."""
    if rule.utterance is None:
        return rule.speaker
    said = base.utterance(rule.utterance)
    return rule.speaker if said.kind == IMPORT else said.speaker


def may_end(base: KnowledgeBase, speaker: str, rule: Rule) -> bool:
    """Return whether a speaker said or reported a rule, or of a norm is trusted more."""
    is_trusted_more = trust_in(base, speaker) > trust_in(base, rule.speaker)
    is_own = speaker in {rule.speaker, reporter_of(base, rule)}
    return is_own or (rule.kind == "norm" and is_trusted_more)


def _corrected(new: Rule, before: Sequence[Rule], topic: Sequence[Rule]) -> list[Rule]:
    same = [old for old in before if can_replace(old, new) and old.id != new.id]
    last = topic[-1] if topic else None
    if same or last is None or last.speaker != new.speaker or last.functor != new.functor:
        return same
    if last.asserts and not new.asserts:  # "no, never for metal" leaves what it is used for
        return same
    uses = [(rule.argument, rule.material) for rule in (last, new)]
    changed = (last.features != new.features) + (uses[0] != uses[1])
    return [last] if changed == 1 and last.context == new.context else []


def earlier_rules(base: KnowledgeBase, rules: Sequence[Rule]) -> list[Rule]:
    """Return the rules of a base with the premises of some rules, in the order of teaching."""
    found = {old.id: old for rule in rules for old in base.rules_with_premises_of(rule)}
    return sorted(found.values(), key=lambda rule: (rule.utterance or 0, rule.id))


def can_replace(one: Rule, other: Rule) -> bool:
    """Return whether one rule can correct the other: about the same object, in the same context.

    A rule about another part of the same grasp can; one about another use of the object cannot.
    """
    if (one.features, one.contexts, one.functor) != (other.features, other.contexts, other.functor):
        return False
    return one.kind == "action" or one.argument == other.argument


def rule_from_answer(
    asked: meaning.Question, named: meaning.Answer, confidence: meaning.Confidence
) -> meaning.Rule | None:
    """Return the rule that a short answer to a question of Hilt teaches.

    None where it names nothing that the question asks for.
    """
    name = None if named.name == meaning.ANY_OBJECT else named.name
    if name is None or named.is_use != (asked.affordance is None and asked.context is None):
        return None
    if asked.affordance:
        return meaning.FunctionalRule(
            name, asked.affordance, confidence, named.props, material=asked.material
        )
    if asked.object and asked.context:
        return meaning.ActionRule(asked.object, asked.context, name, confidence)
    return meaning.FunctionalRule(asked.object, name, confidence) if asked.object else None


def rules_to_retract(
    base: KnowledgeBase, said: meaning.Retraction, speaker: str, topic: Sequence[Rule] = ()
) -> Sequence[Rule]:
    """Return the rules that a speaker retracts, or those of others if the speaker has none.

    They are those about the object that is named, or the one rule that is named, or the last one to
    hold something by the part that is named, else the last one of the `topic`, else of all.
    """
    if said.about:
        rules = base.rules(object=None if said.about == meaning.ANY_OBJECT else said.about)
        return [rule for rule in rules if rule.speaker == speaker] or rules
    if said.part:
        return base.rules(part=said.part, speaker=speaker)[-1:]
    if said.rule is None and topic:
        return topic[-1:]
    told = sorted(base.rules(speaker=speaker), key=lambda rule: rule.utterance or 0)
    if said.rule is not None:
        wanted = rule_from_meaning(said.rule, speaker)
        same = (rule for rule in told if rule.argument == wanted.argument)
        told = [rule for rule in same if can_replace(rule, wanted)]
    return told[-1:]


def word_to_keep(word: NewWord, speaker: str) -> LearnedWord:
    """Return a new word as the base stores it."""
    return LearnedWord(Atom(KINDS.get(word.role, word.role), word.word), word.said, speaker)


def word_from_base(word: LearnedWord) -> NewWord:
    """Return a stored word as the language takes it."""
    return NewWord(word.atom.name, ROLES.get(word.atom.kind, word.atom.kind), word.said)


def word_for_person(name: str) -> NewWord:
    """Return the name of a speaker as a word, for "do you trust kim?"."""
    return NewWord(name.lower(), "person", name)
