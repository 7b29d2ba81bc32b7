"""Phrase memory: turns of phrase whose meaning somebody confirmed, with slots for names.

A phrase is what Hilt did not understand, with a slot instead of each name. When somebody says it
again, with the same or with other names, it means the same of these names. It is a memory for what
one robot's people say, and is asked only about what the grammar does not understand.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from ..lexicon.tokenizer import BREAK
from ..semantics.meaning import ANY_OBJECT, Json
from .meaning_shapes import MeaningShape, role_of, shape_from, shape_of
from .mentions import Mentions

LEAST_FIXED = 3  # the least number of words of a phrase that are no names

_ROLES = {
    "<new>": "object",
    "<new-ing>": "affordance",
    **{f"<{role}>": role for role in ("object", "part", "property", "material", "person")},
    "<affordance>": "affordance",
    "<degree>": "degree",
}

_FIXED = frozenset({"act", "tool"})  # an act, and the use that it needs a tool for

Key = tuple[str, ...]


@dataclass(frozen=True)
class PhrasePattern:
    """A turn of phrase: its words, with a slot of the shape for each name, and its meaning."""

    pattern: tuple[str, ...]
    shape: MeaningShape

    @property
    def key(self) -> Key:
        """The pattern with the roles of its slots, by which an utterance is compared with it."""
        return tuple(f"?{role_of(x)}" if x.startswith("?") else x for x in self.pattern)


def meaning_by_phrase(phrases: Mapping[Key, PhrasePattern], mentions: Mentions) -> Json | None:
    """Return what an utterance that is one of some phrases means, None for any other."""
    gaps = dict(_gaps(mentions))
    key = tuple(f"?{gaps[n]}" if n in gaps else word for n, word in _words(mentions))
    phrase = phrases.get(key)
    if phrase is None:
        return None
    slots = (each for each in phrase.pattern if each.startswith("?"))
    values = {slot: _value(mentions, *gap) for slot, gap in zip(slots, gaps.items(), strict=True)}
    return None if None in values.values() else phrase.shape.filled(values)


def phrase_from(
    mentions: Mentions, meaning: Json, tool_acts: Mapping[str, str], unknown: Iterable[str]
) -> PhrasePattern | None:
    """Return the phrase by which an utterance has a meaning; None where it is not to be learned.

    A phrase has enough words of its own, all of them known, so that no later name is taken for one
    of them; and each of its names is in its meaning once, and no name of the meaning elsewhere.
    """
    shape = shape_of(meaning, mentions, tool_acts)
    if shape.constants - {ANY_OBJECT}:
        return None  # a name that was not said
    values = shape.values_in(meaning)
    fixed_values = {slot: v if role_of(slot) in _FIXED else slot for slot, v in values.items()}
    shape = shape_from(shape.filled(fixed_values))
    gaps = dict(_gaps(mentions))
    slot_of = {(role_of(slot), str(values[slot])): slot for slot in shape.slots}
    slots = [slot_of.get((gap[1], str(_value(mentions, *gap))), "") for gap in gaps.items()]
    if sorted(slots) != sorted(shape.slots):
        return None  # a name that is not in the meaning, or twice
    said = iter(slots)
    pattern = tuple(next(said) if n in gaps else word for n, word in _words(mentions))
    fixed = [word for word in pattern if not word.startswith("?") and word.isalpha()]
    if len(fixed) < LEAST_FIXED or not set(fixed).isdisjoint(unknown):
        return None
    phrase = PhrasePattern(pattern, shape)
    return phrase if meaning_by_phrase({phrase.key: phrase}, mentions) == meaning else None


def _gaps(mentions: Mentions) -> Iterator[tuple[int, str]]:
    for place, label in enumerate(mentions.labels):
        if label in _ROLES:
            yield place, _ROLES[label]


def _words(mentions: Mentions) -> Iterator[tuple[int, str]]:
    for place, label in enumerate(mentions.labels):
        if label and label != BREAK:
            yield place, mentions.tokens.words[place] if label.startswith("<act") else label


def _value(mentions: Mentions, place: int, role: str) -> object:
    if role == "degree":
        return next(list(each) for start, _, each in mentions.degrees if start == place)
    found = (each.name for each in mentions.names if (each.start, each.role) == (place, role))
    return next(found, None)
