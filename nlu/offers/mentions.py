"""Mentions: the names that occur in an utterance, with the roles that they may have in a meaning.

A known name is found by the lexicon. An unknown word may be a new name, by its place and ending. An
utterance also refers to the object mentioned last, and a correction to the last rule.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

from ..lexicon.lexicon import Entry, Lexicon
from ..lexicon.tokenizer import Tokens
from ..lexicon.unknown_words import KnownWords
from ..semantics.discourse import SOMETHING, THIRD_PERSON, Discourse
from ..semantics.interpretation import GOALS
from ..semantics.meaning import Confidence, Rule

_ROLES = {
    **dict.fromkeys(("N", "NS"), "object"),
    "MS": "material",
    "P": "part",
    "AP": "property",
    **dict.fromkeys(("RN", "HN"), "person"),
    **dict.fromkeys(("K", "KB", "K3", "KPP", "KW"), "affordance"),
    **dict.fromkeys(("C", "CP", "CG", "C3", "HP", "HT", "GP"), "act"),
}
"""The role of a name whose category has this result."""

_BEFORE_VERBS = frozenset(
    {"to", "can", "could", "should", "must", "you", "we", "i", "they", "one", "people", "and"}
)
_BEFORE_PARTICIPLES = frozenset({"be", "been", "being", "get", "gets", "is", "are"})

_LABELS = ("degree", "object", "part", "property", "material", "person", "act", "affordance", "new")
"""Of the roles of one word the first of these is its label."""

_NEW_ROLES = {**{r: r for r in ("object", "part", "affordance", "person")}, "context": "act"}

LEAST_ASIDE = 4  # the least length of what is said aside, from pause to pause [words]

_USING = frozenset({"use", "uses", "using", "used"})
_OWNERS = frozenset({"your", "my", "his", "her", "their", "the", "a", "one", "other", "our"})
_ON = frozenset({"on", "off", "onto", "under"})
_AT = _ON | {"at", "in", "from", "near", "behind", "beside"}
_PRONOUNS = THIRD_PERSON | {"one", "ones", "that", "these", "this", "those"}
_JOINING = frozenset({"and", "or", "not", "nor"})
_BEFORE_PLACES = frozenset({"by", "of", "at", "with", "on", "in", "from"})
_BEFORE_PEOPLE = frozenset({"the", "my", "our", "his", "her"})
_SPOKEN_OF = frozenset({"object", "part", "affordance", "material", "property"})

Span = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Mention:
    """A name at the tokens `[start, end)`, in its dictionary form, in one of its roles.

    It `is_new` where it is no known name, and `is_unknown` where the word itself is not known.
    """

    role: str
    name: str
    start: int
    end: int
    is_new: bool = False
    is_unknown: bool = False


@dataclass(frozen=True)
class Mentions:
    """What one utterance names."""

    tokens: Tokens
    names: tuple[Mention, ...]  #: the names, in the order of the utterance
    #: the places and intervals of words for a degree of confidence
    degrees: tuple[tuple[int, int, Confidence], ...] = ()
    #: the words for the object mentioned last before, or its place where no object is named
    references: tuple[Mention, ...] = ()
    last: Rule | None = None  #: the last rule before the utterance
    features: frozenset[str] = frozenset()  #: what its words say of doer, time, source and sign

    @cached_property
    def by_role(self) -> Mapping[str, Mapping[str, tuple[Mention, ...]]]:
        """The mentions of each name, by role and name."""
        found: dict[str, dict[str, tuple[Mention, ...]]] = {}
        for each in (*self.names, *self.references):
            names = found.setdefault(each.role, {})
            names[each.name] = (*names.get(each.name, ()), each)
        return found

    @cached_property
    def _roles(self) -> Mapping[Span, Mapping[str, str]]:
        found: dict[Span, dict[str, str]] = {}
        for each in self.names:
            role = "new" if each.is_new else each.role
            found.setdefault((each.start, each.end), {})[role] = each.name
        return found

    @cached_property
    def required(self) -> Mapping[Span, frozenset[str]]:
        """The known names that a meaning must use: for each of their places, the names it has."""
        return {
            span: frozenset(name for role, name in names.items() if role != "new")
            for span, names in self._roles.items()
            if _is_required(names)
            and not (names.keys() <= {"object", "new"} and self._is_place(span))
        }

    def _is_place(self, span: Span) -> bool:
        return not _AT.isdisjoint(self.tokens.words[max(0, span[0] - 2) : span[0]])

    def required_beside(self, used: Iterable[Sequence[Mention]]) -> Iterator[frozenset[str]]:
        """Yield what a meaning must use that is no part of the longer names it uses.

        Beside one part another one need not be used that is not joined to it: "hold the blade, so
        that he can take the handle".
        """
        given = [m for some in used for m in some]
        parts = {m.name for m in given if m.role == "part"}
        longer = [m for m in given if m.end - m.start > 1]
        for (start, end), names in self.required.items():
            is_joined = not _JOINING.isdisjoint(self.tokens.words[max(0, start - 3) : start])
            is_beside = parts and not is_joined and "part" in self._roles[start, end]
            if not is_beside and not any(m.start <= start and end <= m.end for m in longer):
                yield names

    @cached_property
    def pieces(self) -> tuple[Span, ...]:
        """The spans of the tokens from pause to pause."""
        return tuple(pairwise(sorted(self.tokens.edges)))

    def asides(self, used: Iterable[Mention]) -> tuple[Span, ...]:
        """Return the pieces that have none of some names and no degree, but a clause's length."""
        places = {each.start for each in used}
        named = places | {start for start, _, _ in self.degrees}
        long = (piece for piece in self.pieces if piece[1] - piece[0] >= LEAST_ASIDE)
        return tuple(each for each in long if places and named.isdisjoint(range(*each)))

    @cached_property
    def known(self) -> tuple[Mention, ...]:
        """The names that are known, without acts."""
        return tuple(each for each in self.names if not each.is_new and each.role in _SPOKEN_OF)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """The tokens, with a label for its roles instead of each name."""
        labels = list(self.tokens.words)
        degrees = {(start, end): {"degree": ""} for start, end, _ in self.degrees}
        roles = {**self._roles, **degrees}
        for start, end in sorted(roles, key=lambda span: span[1] - span[0]):
            label = _label(roles[start, end], self.tokens.words[end - 1])
            labels[start:end] = [label, *[""] * (end - start - 1)]
        return tuple(labels)


def find_mentions(
    tokens: Tokens,
    known: KnownWords,
    degrees: Mapping[tuple[str, ...], Confidence],
    discourse: Discourse,
) -> Mentions:
    """Return what an utterance names; `degrees` has the words for degrees of confidence."""
    words = tokens.words
    found = dict.fromkeys((*_known(words, known.lexicon), *_new(tokens, known)))
    found |= dict.fromkeys(_as_acts(found, known.lexicon))
    # Of what stands within a longer known name, and of objects behind "on" and the like, none.
    known_places = {range(each.start, each.end) for each in found if not each.is_new}
    whole = [m for m in found if not any({*range(m.start, m.end)} < {*p} for p in known_places)]
    things = {each for each in whole if each.role == "object" and not each.is_new}
    places = {m for m in things if _ON.intersection(words[max(0, m.start - 2) : m.start])}
    names = (each for each in whole if places == things or each not in places)
    ordered = tuple(sorted(names, key=lambda each: (each.start, each.end)))
    references = tuple(_references(tokens, ordered, discourse))
    return Mentions(tokens, ordered, tuple(_degrees(words, degrees)), references, discourse.rule)


def _references(
    tokens: Tokens, names: Sequence[Mention], discourse: Discourse
) -> Iterator[Mention]:
    thing = discourse.object
    while thing and thing.arguments:
        thing = thing.arguments[0]
    if thing is None or thing.name in SOMETHING:
        return
    things = [each for each in names if each.role == "object" and not each.is_new]
    first = min((each.start for each in things), default=len(tokens.words))
    places = [place for place, word in enumerate(tokens.words[:first]) if word in _PRONOUNS]
    for place in places:
        yield Mention("object", thing.said, place, place + 1)
    if not places and not things:
        yield Mention("object", thing.said, 0, 0)


def _label(names: Mapping[str, str], word: str) -> str:
    if "affordance" in names and names.get("act") not in GOALS:
        return "<affordance>"
    role = next(role for role in _LABELS if role in names)
    if role == "act":
        return f"<act {names[role]}>"
    return "<new-ing>" if role == "new" and word.endswith("ing") else f"<{role}>"


def _is_required(names: Mapping[str, str]) -> bool:
    if "affordance" in names:  # a word like "hold" need not be a use
        return names.get("act") not in GOALS
    return bool({"object", "part"} & names.keys()) and not {"material", "property"} & names.keys()


def _as_acts(found: Iterable[Mention], lexicon: Lexicon) -> Iterator[Mention]:
    for each in found:
        if each.role == "affordance" and not each.is_new:
            for other in _known((each.name,), lexicon):
                if other.role == "act" and other.name in GOALS:
                    yield replace(each, role="act", name=other.name)


def _known(words: tuple[str, ...], lexicon: Lexicon) -> Iterator[Mention]:
    for start in range(len(words)):
        for end, node in lexicon.nodes(words, start):
            roles = ((_ROLES.get(each.category.atom.name), each.name) for each in node.entries)
            is_noun = start > 0 and words[start - 1] in _OWNERS  # "your hand"
            for role, name in dict.fromkeys(roles):
                is_verb = role in {"act", "affordance"} and not words[start].endswith("ing")
                if role and name and not (is_noun and is_verb):
                    yield Mention(role, name, start, end)
        if words[start] in _USING and {"for", "to", "as"}.isdisjoint(words[start + 1 : start + 2]):
            yield Mention("act", "use", start, start + 1)


def _new(tokens: Tokens, known: KnownWords) -> Iterator[Mention]:
    unknown = known.unknown(tokens)
    guesses = known.guesses(tokens, unknown)
    for start, entries in guesses.items():
        for entry in entries:
            role = _NEW_ROLES.get(entry.role)
            is_name = tokens.items[start].capital and start not in tokens.beginnings
            if role and (role == "person" if is_name else _fits(role, entry, tokens.words, start)):
                end = start + 1 + entry.says.count(" ")
                is_unknown = tokens.items[start] in unknown
                yield Mention(role, entry.name, start, end, is_new=True, is_unknown=is_unknown)
                first, second = ("", "", *tokens.words[:start])[-2:]
                may_be_person = second in _BEFORE_PEOPLE and first not in {"", *_BEFORE_PLACES}
                if role == "object" and may_be_person:
                    yield Mention("person", entry.name, start, end, True, is_unknown)
                # A material goes by its singular: "pancake" for "flipping pancakes".
                is_one = not any(e.role == "object" and e.name != e.says for e in entries)
                is_material = first == "to" or second.endswith("ing")
                if role == "object" and is_material and (is_one or entry.name != entry.says):
                    yield Mention("material", entry.name, start, end, True, is_unknown)


def _fits(role: str, entry: Entry, words: tuple[str, ...], start: int) -> bool:
    is_gerund = entry.says.endswith("ing")
    before = words[start - 1] if start else ""
    verbs = _BEFORE_PARTICIPLES if entry.says.endswith("ed") else _BEFORE_VERBS
    is_verb = is_gerund or before in verbs
    if role not in {"affordance", "act"}:
        is_plural = entry.says[-1:] == "s" != entry.name[-1:]  # not in "a shoe ends up"
        return not is_verb and not (is_plural and before in {"a", "an"})
    # "Mixing" and "mixed" are forms of "mix", and no verbs of their own.
    of_itself = {"act": entry.says, "affordance": f"{entry.says}ing"}[role]
    is_form = entry.says.endswith(("ing", "ed"))
    return is_verb and not (is_form and entry.name == of_itself)


def _degrees(
    words: tuple[str, ...], degrees: Mapping[tuple[str, ...], Confidence]
) -> Iterator[tuple[int, int, Confidence]]:
    longest = max(map(len, degrees), default=0)
    place = 0
    while place < len(words):
        ends = range(min(len(words), place + longest), place, -1)
        end = next((end for end in ends if words[place:end] in degrees), None)
        if end is not None:
            yield place, end, degrees[words[place:end]]
        place = end or place + 1
