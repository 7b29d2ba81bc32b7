"""Segmentation of an utterance at its pauses, and the combination of the segments' meanings.

"Hello. That hammer, could I have it, please?" has three segments. Every segment must be understood,
and together they must have one meaning: beside the main segment there may be replies, the object
that "it" refers to, a question whether that object is seen, or the same request again.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

from ..lexicon.tokenizer import Tokens
from ..semantics.meaning import (
    Acknowledgement,
    Command,
    Meaning,
    Question,
    Retraction,
    Rule,
    Statement,
    ToolCommand,
    TopicStatement,
    is_contradictory,
    with_rules,
)

MAX_SEGMENTS = 4

_ANSWERS = frozenset({"yes", "no"})  # they outweigh all politeness around them
_CLOSING = frozenset({"thanks", "okay"})


def segmentations(tokens: Tokens) -> Iterator[tuple[Tokens, ...]]:
    """All ways to split an utterance at its pauses, those with fewer segments first."""
    places = tokens.beginnings[1:]
    if len(places) >= MAX_SEGMENTS:
        return
    for count in range(1, len(places) + 1):
        for chosen in combinations(places, count):
            starts, ends = (0, *chosen), (*chosen, len(tokens.items))
            segments = tuple(tokens.part(*span) for span in zip(starts, ends, strict=True))
            if all(segment.items for segment in segments):
                yield segments


def combine_meanings(meanings: Sequence[Meaning]) -> tuple[int, Meaning] | None:
    """Return the index of the main segment and the combined meaning, None when there is none."""
    replies = [each for each in meanings if isinstance(each, Acknowledgement)]
    if len(replies) == len(meanings):
        return _combined_reply(meanings, replies)
    places = [i for i, each in enumerate(meanings) if not isinstance(each, Acknowledgement)]
    after = meanings[places[-1] + 1 :]
    if any(isinstance(each, Acknowledgement) and each.ack not in _CLOSING for each in after):
        return None
    meaning = _combined([meanings[place] for place in places])
    return (places[-1], meaning) if meaning is not None else None


def _combined_reply(
    meanings: Sequence[Meaning], replies: Sequence[Acknowledgement]
) -> tuple[int, Meaning] | None:
    decisive = {reply for reply in replies if reply.ack in _ANSWERS}
    if len(decisive) > 1:
        return None
    thanked = next((reply for reply in replies if reply.ack == "thanks"), replies[-1])
    chosen = next(iter(decisive), thanked)
    return meanings.index(chosen), chosen


def _combined(meanings: Sequence[Meaning]) -> Meaning | None:
    first, last = meanings[0], meanings[-1]
    if all(each == last for each in meanings):
        return last
    statements = [each for each in meanings if isinstance(each, Statement)]
    if len(statements) == len(meanings):
        return _combined_statement([rule for each in statements for rule in each.rules])
    if len(meanings) != 2:
        return None
    if first == Retraction() and isinstance(last, Statement):
        return with_rules(last, revises=True)
    return last if _names_what_is_meant(first, last) else None


def _combined_statement(rules: Sequence[Rule]) -> Statement | None:
    distinct = tuple(dict.fromkeys(_self_repaired(rules)))
    if len({(rule.revises, rule.source) for rule in distinct}) > 1:
        return None
    return None if is_contradictory(distinct) else Statement(distinct)


def _self_repaired(rules: Sequence[Rule]) -> list[Rule]:
    kept: list[Rule] = []
    for rule in rules:
        repairs = rule.revises and kept and type(kept[-1]) is type(rule)
        kept.append(replace(rule, revises=kept.pop().revises) if repairs else rule)
    return kept


def _names_what_is_meant(first: Meaning, last: Meaning) -> bool:
    match first, last:
        case TopicStatement(topic=topic), Statement(rules=rules):
            return all(rule.object == topic for rule in rules)
        case Question(ask="see", object=seen), ToolCommand(patient=patient):
            return seen == patient
        case Question(ask="see", object=seen, affordance=use), Command(target=target):
            return (seen, use) in {(target.object, None), (None, target.used_for)}
        case _:
            return False
