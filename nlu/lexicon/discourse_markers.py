"""Discourse markers, which add no meaning, adverbs out of place, and control phrases.

"Knives are, you know, really for cutting, aren't they?" is "knives are for cutting?". Only phrases
that the language data lists are ever removed, and only if the utterance cannot be parsed with them.
Controls ("stop", "please wait", "put it down") are obeyed before any parsing. An utterance is a
control only as a whole, so "stop using the knife" and "never drop it" are none.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, fields, replace
from itertools import combinations, pairwise

from ...ontology.yaml_reader import YamlNode
from ..grammar import word_patterns
from ..grammar.word_patterns import Phrase, Steps, WordLists, places_of
from .tokenizer import BREAK, Tokens


@dataclass(frozen=True)
class DiscourseMarkers:
    """The phrases that may be removed from an utterance."""

    anywhere: frozenset[Phrase] = frozenset()  #: phrases that add nothing in any position
    #: phrases that add nothing between two pauses, breaks or ends
    apart: frozenset[Phrase] = frozenset()
    #: question tags, which make a question of a sentence
    question_tags: frozenset[Phrase] = frozenset()
    #: tags with a question mark that ask for nothing, such as "okay?"
    statement_tags: frozenset[Phrase] = frozenset()
    #: the beginning and the tag of a request, a break between them: "you could not ..., could you?"
    request_tags: frozenset[Phrase] = frozenset()
    emphasis: frozenset[Phrase] = frozenset()  #: words that only stress an adverb between pauses
    clauses: Steps = ()  #: patterns of reasons that add nothing before a pause or the end

    def with_phrases(self, kind: str, field: YamlNode) -> "DiscourseMarkers":
        """Return these phrases and further ones; `DataError` for a wrong kind or pattern."""
        kinds = sorted(each.name for each in fields(self))
        if kind not in kinds:
            raise field.fail(f'expected one of {kinds}, found "{kind}".')
        known = getattr(self, kind)
        if kind == "clauses":
            return replace(self, clauses=known + word_patterns.read_patterns(field))
        return replace(self, **{kind: known | word_patterns.read_phrases(field)})

    def remove_tag(self, tokens: Tokens) -> Tokens:
        """Remove the tag at the end: "..., isn't it?", "..., okay?"."""
        place = self._tag(tokens, self.question_tags | self.statement_tags)
        if place is None:
            return tokens
        return replace(tokens.part(0, place), asks=tokens.words[place:] in self.question_tags)

    def request_before_tag(self, tokens: Tokens) -> Tokens | None:
        """Return the request before a tag that only urges: "..., will you?"; None without one."""
        place = self._tag(tokens, self.statement_tags)
        if place is None:
            return None
        tag = (BREAK, *tokens.words[place:])
        starts = (n for n in range(_LONGEST) if (*tokens.words[:n], *tag) in self.request_tags)
        return replace(tokens.part(next(starts, 0), place), asks=False)

    def _tag(self, tokens: Tokens, tags: Collection[Phrase]) -> int | None:
        places = tokens.beginnings[1:] if tokens.asks else ()
        return next((place for place in places if tokens.words[place:] in tags), None)

    def remove_markers(self, tokens: Tokens, kept_whole: Collection[Phrase] = ()) -> Tokens:
        """Remove all phrases that add nothing, but no part of the phrases that are `kept_whole`."""
        tokens = _begun_once(tokens)
        words, edges = tokens.words, tokens.edges
        kept: list[int] = []
        removed: list[Phrase] = []
        place = 0
        while place < len(words):
            lengths = range(min(_LONGEST, len(words) - place), 0, -1)
            whole = next((n for n in lengths if words[place : place + n] in kept_whole), 0)
            has_pauses = not tokens.is_transcript
            end = place if whole else self._end(words, place, edges, has_pauses=has_pauses)
            if end == place:
                end += whole or 1
                kept += range(place, end)
            else:
                removed.append(words[place:end])
            place = end
        return replace(_begun_once(tokens.only(kept)), removed=(*tokens.removed, *removed))

    def leave_last_degree(self, tokens: Tokens, degrees: Mapping[Phrase, str]) -> Tokens:
        """Leave the last of the degrees between pauses, and none that is said again elsewhere."""
        words, found = tokens.words, None
        for start, end in pairwise(sorted(tokens.edges)):
            for first, last in combinations(range(start, min(end, start + _LONGEST) + 1), 2):
                beside = (*words[start:first], *words[last:end])
                if words[first:last] in degrees and all((w,) in self.emphasis for w in beside):
                    if found and found[3] != start:
                        return tokens  # "often, it cuts and, often, it pounds"
                    found = (found[0] if found else start, first, last, end)
                    break
        if found is None:
            return tokens
        begin, first, last, end = found
        rest = (*words[:begin], BREAK, *words[end:])
        again = (p for p in degrees if degrees[p] == degrees[words[first:last]])
        kept = () if any(any(places_of(p, rest)) for p in again) else range(first, last)
        return tokens.only([*range(begin), *kept, *range(end, len(words))])

    def _end(self, words: Phrase, start: int, edges: Collection[int], *, has_pauses: bool) -> int:
        clauses = word_patterns.match_pattern(self.clauses, words, start)
        ends = [end for end, _ in clauses if end in edges]
        for end in range(min(len(words), start + _LONGEST), start, -1):
            phrase = words[start:end]
            apart = (start in edges and end in edges) or (not has_pauses and end - start > 2)
            if phrase in self.anywhere or (apart and phrase in self.apart):
                ends.append(end)
        return max(ends, default=start)


_LONGEST = 8  # the greatest length of a marker that is no clause [words]


def _begun_once(tokens: Tokens) -> Tokens:
    words = tokens.words
    again = {
        place
        for pause in tokens.pauses
        for length in range(1, min(pause, _LONGEST) + 1)
        if words[pause - length : pause] == words[pause : pause + length]
        for place in range(pause - length, pause)
    }
    return tokens.only([place for place in range(len(words)) if place not in again])


def move_to_front(
    tokens: Tokens, phrases: Collection[Phrase], barriers: Collection[str]
) -> Tokens | None:
    """Move the only one of some phrases to the beginning; None if it is there or not the only one.

    English lets an adverb stand almost anywhere: "a shoe you can sometimes pound with". But it
    crosses none of the `barriers`: "I never heard that ..." says nothing of what was heard.
    """
    words = tokens.words
    found = [
        (start, start + length)
        for length in sorted({len(phrase) for phrase in phrases}, reverse=True)
        for start in range(len(words) - length + 1)
        if words[start : start + length] in phrases
    ]
    if not found or found[0][0] == 0:
        return None
    start, end = found[0]
    if not set(barriers).isdisjoint(words[:start]):
        return None
    if any(later[0] >= end or later[1] <= start for later in found[1:]):
        return None
    items = tokens.items
    pauses = (p + end - start if p <= start else p for p in tokens.pauses if not start < p <= end)
    moved = (*items[start:end], *items[:start], *items[end:])
    return replace(tokens, items=moved, pauses=tuple(sorted({*pauses})))


Named = Callable[[Tokens], str | None]


@dataclass(frozen=True)
class ControlPhrases:
    """The words of `controls.yaml`: phrases of each control, and those that may stand round them.

    Of several controls in an utterance that counts whose phrases come first.
    """

    words: WordLists

    def match(self, tokens: Tokens, named: Named) -> tuple[str, str | None] | None:
        """Return the control that an utterance is, and what it names, as `named` tells, if any."""
        words = tokens.words
        found: dict[str, str | None] = {}
        place = 0
        while place < len(words):
            control, end, thing = self._control(tokens, place, named)
            if end == place:
                end = self.words.end("polite", words, place) + (words[place] == BREAK)
            if end == place:
                return None
            place = end
            if control:
                found[control] = thing or found.get(control)
        controls = self.words.names("controls")
        return next(((each, found[each]) for each in controls if each in found), None)

    def _control(self, tokens: Tokens, start: int, named: Named) -> tuple[str, int, str | None]:
        spans = self.words.of_group("controls", tokens.words, start)
        for control, end, slots in sorted(spans, key=lambda each: each[1], reverse=True):
            slot, place = next(iter(slots.items()), ("", (0, 0)))
            thing = tokens.part(*place)
            is_pronoun = self.is_pronoun(thing.words)
            if not slot or (is_pronoun and slot == "THING"):
                return control, end, None
            kind = None if is_pronoun else named(thing)
            if kind is not None:
                return control, end, kind
        return "", start, None

    def is_pronoun(self, words: tuple[str, ...]) -> bool:
        """Whether some words stand for the object in the hand."""
        return self.words.has("pronouns", *words)

    def after_polite(self, words: tuple[str, ...]) -> int:
        """Return the place after the phrases that change nothing at the beginning of some words."""
        place = 0
        while (end := self.words.end("polite", words, place)) > place:
            place = end
        return place
