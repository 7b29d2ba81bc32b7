"""Mentions: the names that occur in an utterance, with the roles that they may have in a meaning.

A known name is found by the lexicon. An unknown word may be a new name, by its place and ending. An
utterance also refers to objects mentioned before, and to the use or the act of the last turn.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

from ..lexicon.lexicon import Entry, Lexicon
from ..lexicon.loader import NOUN_ROLES
from ..lexicon.tokenizer import Tokens
from ..lexicon.unknown_words import KnownWords
from ..semantics.discourse import SOMETHING, THIRD_PERSON, Discourse
from ..semantics.interpretation import GOALS
from ..semantics.meaning import Confidence

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

_SUBJECTS = frozenset({"it", "one", "who", "that", "which", "everybody", "everyone", "usually"})

_LABELS = ("degree", "object", "part", "property", "material", "person", "act", "affordance", "new")
"""Of the roles of one word the first of these is its label."""

_NEW_ROLES = {**{r: r for r in ("object", "part", "affordance", "person")}, "context": "act"}

LEAST_ASIDE = 4  # the least length of what is said aside, from pause to pause [words]

_USING = frozenset({"use", "uses", "using", "used"})
_OWNERS = frozenset({"your", "my", "his", "her", "their", "the", "a", "one", "other", "our"})
_ON = frozenset({"on", "off", "onto", "under"})
_AT = _ON | {"at", "in", "from", "near", "behind", "beside"}
_PRONOUNS = THIRD_PERSON | {"one", "ones", "that", "these", "this", "those"}
_PEOPLE = frozenset({"him", "her", "he", "she", "them", "they"})
_JOINING = frozenset({"and", "or", "not", "nor"})
_BEFORE_PLACES = frozenset({"by", "of", "at", "with", "on", "in", "from"})
_BEFORE_PEOPLE = frozenset({"the", "my", "our", "his", "her"})
_LAST_ROLES = {"affordance": "affordance", "material": "material", "context": "act", "goal": "act"}
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
    #: the words for objects mentioned before; at no place what is not named, from the last turn
    references: tuple[Mention, ...] = ()
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
            and not (
                names.keys() <= {"object", "new"} and _AT & {*self.tokens.words[: span[0]][-2:]}
            )
        }

    def required_beside(self, used: Iterable[Sequence[Mention]]) -> Iterator[frozenset[str]]:
        """Yield what a meaning must use that is no part of the longer names it uses.

        It may leave out what stands between pauses without any name that it uses. Beside one part
        one not joined to it need not be used: "hold the blade, so that he can take the handle".
        """
        given = [m for some in used for m in some]
        places = {m.start for m in given}
        asides = [each for each in self.pieces if places.isdisjoint(range(*each))]
        parts = {m.name for m in given if m.role == "part"}
        longer = [m for m in given if m.end - m.start > 1]
        for (start, end), names in self.required.items():
            is_joined = not _JOINING.isdisjoint(self.tokens.words[max(0, start - 3) : start])
            is_beside = parts and not is_joined and "part" in self._roles[start, end]
            is_aside = bool(given) and any(one <= start < other for one, other in asides)
            is_within = any(m.start <= start and end <= m.end for m in longer)
            if not (is_beside or is_aside or is_within):
                yield names

    @cached_property
    def pieces(self) -> tuple[Span, ...]:
        """The spans of the tokens from pause to pause."""
        return tuple(pairwise(sorted(self.tokens.edges)))

    def asides(self, used: Iterable[Mention]) -> tuple[Span, ...]:
        """Return the pieces that have none of some names and no degree, but a clause's length."""
        places = {each.start for each in used if each.end}
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
        roles = {**self._roles, **{(start, end): {"degree": ""} for start, end, _ in self.degrees}}
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
    found |= dict.fromkeys(_as_acts(found, known))
    # Of what stands within a longer known name, and of objects behind "on" and the like, none.
    known_places = {range(each.start, each.end) for each in found if not each.is_new}
    whole = [m for m in found if not any({*range(m.start, m.end)} < {*p} for p in known_places)]
    things = {each for each in whole if each.role == "object" and not each.is_new}
    places = {m for m in things if _ON.intersection(words[max(0, m.start - 2) : m.start])}
    names = (each for each in whole if places == things or each not in places)
    found_degrees = tuple(_degrees(words, degrees))
    of_degree = {place for start, end, _ in found_degrees for place in range(start, end)}
    named = (each for each in names if of_degree.isdisjoint(range(each.start, each.end)))
    ordered = tuple(sorted(named, key=lambda each: (each.start, each.end)))
    references = tuple(_references(tokens, ordered, discourse))
    return Mentions(tokens, ordered, found_degrees, references)


def _references(
    tokens: Tokens, names: Sequence[Mention], discourse: Discourse
) -> Iterator[Mention]:
    words = tokens.words
    if discourse.person:
        for place in (place for place, word in enumerate(words) if word in _PEOPLE):
            yield Mention("person", discourse.person.said, place, place + 1)
    known = [each for each in names if each.role == "object" and not each.is_new]
    first = min((each.start for each in known), default=len(words))
    places = [(n, n + 1) for n, word in enumerate(words[:first]) if word in _PRONOUNS]
    mentioned = filter(None, (discourse.object, *discourse.named, *discourse.pair))
    things = dict.fromkeys(each.innermost.said for each in mentioned)
    for start, end in places or ([] if known else [(0, 0)]):
        yield from (Mention("object", each, start, end) for each in things if each not in SOMETHING)
    named = {each.role for each in names if not each.is_new}
    last = ((role, getattr(discourse.last, key, "")) for key, role in _LAST_ROLES.items())
    for role, name in discourse.spoken or last:
        if name and role not in named:
            yield Mention(role, name, 0, 0)


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


def _as_acts(found: Iterable[Mention], known: KnownWords) -> Iterator[Mention]:
    """Yield the acts that uses are: "cut" of "cutting", and what a word like "hold" is besides."""
    acts = {(each.start, each.end) for each in found if each.role == "act"}
    for each in found:
        if each.role == "affordance":
            others = () if each.is_new else _known((each.name,), known.lexicon)
            names = [other.name for other in others if other.role == "act" and other.name in GOALS]
            is_open = (each.start, each.end) not in acts
            bare = known.origins(each.name, "ing")[:1] if is_open and not names else ()
            yield from (replace(each, role="act", name=name) for name in (*names, *bare))


def _role(entry: Entry) -> str | None:
    role = _ROLES.get(entry.category.atom.name)
    # "Long" and "a kind of" make a noun of a noun, and name no thing.
    is_whole = entry.category == entry.category.atom
    return role if is_whole or role in {"act", "affordance", "property"} else None


def _known(words: tuple[str, ...], lexicon: Lexicon) -> Iterator[Mention]:
    for start in range(len(words)):
        for end, node in lexicon.nodes(words, start):
            roles = ((_role(each), each.name) for each in node.entries)
            is_noun = start > 0 and words[start - 1] in _OWNERS  # "your hand"
            for role, name in dict.fromkeys(roles):
                is_verb = role in {"act", "affordance"} and not words[start].endswith("ing")
                if role and name and not (is_noun and is_verb):
                    yield Mention(role, name, start, end)
        if words[start] in _USING and {"for", "to", "as"}.isdisjoint(words[start + 1 : start + 2]):
            yield Mention("act", "use", start, start + 1)


def _new(tokens: Tokens, known: KnownWords) -> Iterator[Mention]:
    unknown = known.unknown(tokens)
    for start, entries in known.guesses(tokens, unknown).items():
        is_owned = start > 0 and tokens.words[start - 1] in _OWNERS
        plurals = {each.role for each in entries if each.name != each.says}
        for entry in entries:
            # "Bolts" are several; "the lens" may be one.
            if entry.name == entry.says and entry.role in plurals & NOUN_ROLES and not is_owned:
                continue
            role = _NEW_ROLES.get(entry.role)
            is_name = tokens.items[start].capital and start not in tokens.beginnings
            fits = role == "person" if is_name else _fits(entry, tokens.words, start, known)
            if role and fits:
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


def _fits(entry: Entry, words: tuple[str, ...], start: int, known: KnownWords) -> bool:
    before, says = words[start - 1] if start else "", entry.says
    verbs = _BEFORE_PARTICIPLES if says.endswith("ed") else _BEFORE_VERBS
    is_form, is_verb = says.endswith(("ing", "ed")), says.endswith("ing") or before in verbs
    ends_in_s = says[-1:] == "s" != entry.name[-1:]
    if entry.role not in {"affordance", "context"}:
        is_use = before == "for" and says.partition(" ")[0].endswith("ing")  # "for rolling dough"
        is_clause = is_use or (" " in says and is_form)  # "a tool called a wrench"
        return not is_verb and not is_clause and not (ends_in_s and before in {"a", "an"})
    # "A corkscrew pulls corks", "chisels carve wood": beside a noun of the other number.
    is_after_noun = known.names(before) or not known.has(before) or before in _SUBJECTS
    may_agree = start > 0 and is_after_noun and ends_in_s != before.endswith("s")
    # "Mixing" and "mixed" are forms of "mix", and no verbs of their own.
    of_itself = says if entry.role == "context" else f"{says}ing"
    return (is_verb or may_agree) and not (is_form and entry.name == of_itself)


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
