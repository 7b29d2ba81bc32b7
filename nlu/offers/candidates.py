"""Candidates: the meanings that the names of an utterance allow, in every shape that fits them."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import islice, permutations, product

from ..semantics.meaning import Json
from .meaning_shapes import MeaningShape
from .mentions import Mention, Mentions, Span

MAX_FILLINGS = 12
"""The greatest number of ways in which the names of an utterance may fill one shape."""

Asides = tuple[Span, ...]


@dataclass(frozen=True)
class CandidateMeaning:
    """A shape, and for each of its slots the value; the mentions are those used, by slot."""

    shape: MeaningShape
    values: Mapping[str, object]
    used: Mapping[str, tuple[Mention, ...]]

    @cached_property
    def meaning(self) -> Json:
        """The meaning as a JSON object of the meaning schema."""
        return self.shape.filled(self.values)

    def asides(self, mentions: Mentions) -> Asides:
        """The spans of an utterance that say nothing of this meaning."""
        return mentions.asides(m for used in self.used.values() for m in used)


def candidates(
    mentions: Mentions, shapes: Iterable[MeaningShape], tool_acts: Mapping[str, str]
) -> Iterator[CandidateMeaning]:
    """Yield the ways in which the names of an utterance fill the shapes."""
    for shape in shapes:
        if mentions.fewest > len(shape.slots):
            continue
        given = _given(shape, mentions)
        if given is None or any(
            len(slots) > len(mentions.by_role.get(role, ())) for role, slots in shape.roles.items()
        ):
            continue
        for names in islice(_fillings(shape, mentions), MAX_FILLINGS):
            values = {**given, **names}
            if "?tool" in shape.slots:
                goal = shape.filled({**dict.fromkeys(shape.slots, ""), **values})["goal"]
                if goal not in tool_acts:
                    continue
                values["?tool"] = tool_acts[str(goal)]
            used = {
                slot: mentions.by_role[slot[1:].rstrip("23456789")][name]
                for slot, name in names.items()
            }
            said = {value for value in values.values() if isinstance(value, str)}
            required = mentions.required_beside(used.values())
            if _apart(used) and not any(map(said.isdisjoint, required)):
                yield CandidateMeaning(shape, values, used)


def _given(shape: MeaningShape, mentions: Mentions) -> dict[str, object] | None:
    values: dict[str, object] = {}
    for slot in shape.slots:
        if slot == "?it":
            values[slot] = mentions.it
        elif slot == "?degree":
            intervals = dict.fromkeys(interval for _, _, interval in mentions.degrees)
            values[slot] = list(next(iter(intervals))) if len(intervals) == 1 else None
        elif slot.startswith("?last."):
            retracted = shape.template.get("retract")
            said = retracted if isinstance(retracted, dict) else shape.template
            if mentions.last is None or mentions.last.rule != said.get("rule"):
                return None
            value = getattr(mentions.last, slot[len("?last.") :])
            values[slot] = list(value) if isinstance(value, tuple) else value
    return values if all(value for value in values.values()) else None


def _fillings(shape: MeaningShape, mentions: Mentions) -> Iterator[dict[str, str]]:
    by_role = [
        [
            dict(zip(slots, names, strict=True))
            for names in islice(permutations(mentions.by_role[role], len(slots)), MAX_FILLINGS)
        ]
        for role, slots in shape.roles.items()
    ]
    for chosen in product(*by_role):
        yield {slot: name for names in chosen for slot, name in names.items()}


def _apart(used: Mapping[str, tuple[Mention, ...]]) -> bool:
    spans = [[(each.start, each.end) for each in mentions] for mentions in used.values()]
    return any(len(set(chosen)) == len(spans) for chosen in product(*spans))
