"""Unknown words: the entries that a word which is not known may stand for.

An unknown word gets an entry for every role that a name can have, and the chart finds which one
fits the rest of the sentence (Scheutz et al. 2017): "a zib is used for cutting" names an object.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain, pairwise

from .learned_lexicon import LearnedLexicon
from .lexicon import Entry, LazyEntry
from .loader import NOUN_ROLES, LexiconBuilder, Verb
from .tokenizer import BREAK, Token, Tokens
from .vocabulary import NewWord

MAX_NEW_WORDS = 5
MIN_LETTERS = 3
MAX_LETTERS = 30

NOUNS = frozenset({"N", "NS", "P", "MS"})  # the categories of names of things
PLACES = frozenset({"LOC"})

_ACTS = frozenset({"CP/NP", "(CP/UP)/NP"})

_VERB_COST = 0.5  # a name is likelier than an act: there are more things than things to do
_PERSON_COST = 1.0
_RECIPIENT_COST = 3.0  # what may as well be a thing is one
_COMPOUND_COST = 0.75
_SINGULAR_COST = 0.25  # what looks like a plural is one
_NAMEABLE_COST = 1.0  # a word of a construction hardly ever names something, too

RECIPIENT = "recipient"
"""The role of an entry for somebody who is not known, in the place of who is given something."""

_COMPOUNDED = (
    ("object", "object", ("N", "NS")),
    ("part", "part", ("P",)),
    ("human", RECIPIENT, ("HN",)),
    ("place", "place", PLACES),
)
"""The templates and roles of names of two words, with the categories of their second word."""

_PEOPLE = frozenset({"person", RECIPIENT})

_NAMED_BY = {
    "object": NOUNS,
    "part": frozenset({"P"}),
    "affordance": frozenset({"K", "KB"}),
    "context": frozenset({"CP/NP", "CG/NP", "C/NP"}),
    "place": PLACES,
}


def is_word(word: str) -> bool:
    """Whether a token can be a word at all."""
    return word.isalpha() and MIN_LETTERS <= len(word) <= MAX_LETTERS


def new_words(entries: Iterable[Entry]) -> tuple[NewWord, ...]:
    """The new words that a reading rests on, each once."""
    named = (e for e in entries if e.role and e.role not in _PEOPLE)
    return tuple(dict.fromkeys(NewWord(e.name, e.role, e.says) for e in named))


def new_recipients(entries: Iterable[Entry]) -> tuple[NewWord, ...]:
    """The people whom a reading takes for somebody who is not known yet."""
    return tuple(NewWord(e.name, e.role, e.says) for e in entries if e.role == RECIPIENT)


@dataclass(frozen=True, repr=False)
class KnownWords:
    """The words that are known, and the entries that all others may stand for."""

    lexicon: LearnedLexicon
    builder: LexiconBuilder

    def unknown(self, tokens: Tokens) -> list[Token]:
        """The tokens that are not known."""
        return [token for token in tokens.items if not self.has(token.word)]

    def origins(self, word: str, form: str) -> list[str]:
        """The words of which a word may be some form, the likeliest first."""
        return self.builder.inflection.origins(word, form)

    def has(self, word: str) -> bool:
        """Whether a word is known."""
        return word in self.lexicon or word in self.builder.closed

    def names(self, word: str, role: str | None = None) -> bool:
        """Whether a word, in any form, may have a role, or else occurs in the name of a thing."""
        if role is None:
            return self.lexicon.is_in_name(word, NOUNS)
        return self.lexicon.is_name(word, _NAMED_BY[role])

    def is_only_part(self, word: NewWord) -> bool:
        """Whether a word for an object is one for a part in the vocabulary of the language."""
        if word.role != "object" or ("part", word.word) in self.lexicon.learned:
            return False
        return self.lexicon.is_name(word.said, ("P",))

    def is_surely_name(self, said: str) -> bool:
        """Whether new words are a name: a single one, or a noun with a noun or gerund before it.

        Other first words may be adjectives, last ones adverbs: "the chipped mug", "the mug pronto".
        """
        first, _, last = said.rpartition(" ")
        if not first or last in self.builder.homographs or self.origins(first, "ing"):
            return True
        return self.lexicon.is_name(first, NOUNS) and self.lexicon.is_name(last, NOUNS)

    def may_be_a_thing(self, word: str) -> bool:
        """Whether a word names, or may name, an object or a part."""
        if word in self.builder.denied or not self.builder.is_of_grammar(word):
            return True
        return self.lexicon.is_name(word, ("N", "NS", "P"))

    def guesses(self, tokens: Tokens, unknown: Sequence[Token]) -> Mapping[int, Sequence[Entry]]:
        """The entries of new words, and of names of two words, by their places."""
        found: dict[int, list[Entry]] = {}
        for place, token in enumerate(tokens.items):
            if token in unknown:
                # A transcript has no capitals, so any word may be a name.
                is_open = tokens.is_transcript and not self._is_after_naming(tokens.words, place)
                found[place] = self._guesses(token.word, 0.0, is_capital=token.capital or is_open)
            elif self._may_be_taught(tokens, place):
                found[place] = self._guesses(token.word, _NAMEABLE_COST, is_capital=token.capital)
        for place, entries in found.items():
            entries.extend(self._recipients(tokens, place))
        for place, (first, second) in enumerate(pairwise(tokens.words)):
            is_cut = place + 1 in tokens.pauses or first in self.builder.closed
            if is_cut or self._may_be_clause(tokens, place):
                continue
            is_determined = place > 0 and self.builder.is_determiner(tokens.words[place - 1])
            names = self._compounds(first, second, is_determined)
            if names:
                found[place] = [*found.get(place, ()), *names]
        return found

    def _is_after_naming(self, words: Sequence[str], place: int) -> bool:
        return place > 0 and words[place - 1] in self.builder.naming

    def _guesses(self, word: str, cost: float, *, is_capital: bool) -> list[Entry]:
        kinds = self.lexicon.name_categories(word)
        taken = {"object": {"N", "NS"}, "part": NOUNS, "affordance": {"K", "KB"}}
        taken |= {"context": kinds - NOUNS, "place": PLACES}
        open_roles = frozenset(role for role, of_role in taken.items() if not of_role & kinds)
        entries = _entries(self.builder, word, is_capital, open_roles)
        return [entry._replace(cost=entry.cost + cost) for entry in entries]

    def _recipients(self, tokens: Tokens, place: int) -> Iterator[Entry]:
        words = tokens.words
        word, after = words[place], words[place + 1 : place + 2]
        if self.lexicon.name_categories(word) or not is_word(word):
            return
        is_followed = any(map(self.builder.is_of_grammar, after))
        is_alone = is_followed or self._is_after_naming(words, place)
        singulars = self.origins(word, "plural")
        for kind in ("human", "person") if is_alone and not singulars else ("human",):
            name = (singulars or [word])[0]
            found = self.builder.noun(kind, name, role=RECIPIENT, cost=_RECIPIENT_COST)
            yield from (each.entry() for each in found if each.says == word)

    def _may_be_clause(self, tokens: Tokens, place: int) -> bool:
        words, end = tokens.words, place + 2
        is_joined = place > 0 and words[place - 1] in self.builder.joining
        is_last = end == len(words) or end in tokens.pauses or words[end] == BREAK
        return is_joined and is_last and not self.has(words[place + 1])

    def _compounds(self, first: str, second: str, is_determined: bool) -> list[Entry]:
        is_name = self.lexicon.is_name(first, NOUNS | {"K"})
        is_open = not self.has(first) or (is_determined and self._may_name(first))
        if first == second or not (is_name or (is_open and is_word(first))):
            return []
        singular = next(iter(self.origins(second, "plural")), second)
        found = chain.from_iterable(
            self.builder.noun(kind, f"{first} {singular}", role=role, cost=_COMPOUND_COST)
            for kind, role, kinds in _COMPOUNDED
            if self._may_end(first, second, role, kinds)
            or (is_determined and role == "object" and self._may_name(second))
        )
        return [each.entry() for each in found if each.says == f"{first} {second}"]

    def _may_end(self, first: str, second: str, role: str, kinds: Iterable[str]) -> bool:
        if role == "place" and self.lexicon.is_in_name(second, PLACES):
            return True  # "boiler room", as "living room"
        if self.lexicon.is_name(second, kinds):
            return role != "part" or not self.lexicon.is_name(first, kinds)
        if second in self.builder.homographs:
            return role == "object"
        is_plural = bool(self.origins(first, "plural"))
        is_act = role == RECIPIENT and self.origins(first, "ing")  # nobody is a holding pen
        return not (is_plural or is_act) and is_word(second) and not self.has(second)

    def _may_name(self, word: str) -> bool:
        if not is_word(word) or self.builder.is_of_grammar(word) or not self.has(word):
            return False
        names = self.lexicon.name_categories(word)
        return not names.isdisjoint(_ACTS) or not (names or self.origins(word, "adverb"))

    def _may_be_taught(self, tokens: Tokens, place: int) -> bool:
        """Whether a known word may name something new: a hook, the tip, for sticking, to stick.

        It may where a name is expected: after an article and the like, as a gerund, as a plural at
        the beginning or in a list, a part after a property, and an act: "can I hammer with it?".
        """
        words = tokens.words
        word, before = words[place], words[place - 1] if place else ""
        if word in self.builder.homographs:
            return self.builder.is_determiner(before)
        is_part = self.lexicon.is_name(word, ("P",))
        if len(word) < MIN_LETTERS or (self.builder.is_of_grammar(word) and not is_part):
            return False
        is_denied = before in self.builder.denying and place < len(words) - 1
        is_act = before in self.builder.doers and self.lexicon.is_name(word, NOUNS)
        if is_denied or is_act or before in self.builder.naming or self.origins(word, "ing"):
            return True
        if is_part and self.lexicon.is_name(before, ("AP",)):
            return True
        is_listed = not before or place in tokens.pauses or before in self.builder.joining
        return is_listed and bool(self.origins(word, "plural"))


@lru_cache(maxsize=8192)
def _entries(
    builder: LexiconBuilder, word: str, is_capital: bool, roles: frozenset[str]
) -> tuple[Entry, ...]:
    senses: list[LazyEntry] = []
    inflection = builder.inflection
    singulars = inflection.origins(word, "plural")
    for role in sorted(roles & NOUN_ROLES):
        senses += builder.noun(role, word, role=role, cost=_SINGULAR_COST if singulars else 0.0)
        for name in singulars[:1]:
            senses += builder.noun(role, name, role=role)
    if is_capital:
        senses += builder.noun("person", word, role="person", cost=_PERSON_COST)
    bare_forms = [] if any(inflection.origins(word, form) for form in ("third", "ing")) else [word]
    for form in ("ing", "third", "participle"):
        bare_forms += inflection.origins(word, form)[:1]
    for bare in bare_forms:
        act, use = Verb(bare, ("new_act",), bare), Verb(bare, ("new_affordance",), None)
        if "context" in roles:
            senses += builder.verb_forms(act, "context", _VERB_COST)
        if "affordance" in roles:
            senses += builder.verb_forms(use, "affordance")
    return tuple(each.entry() for each in senses if each.says == word)
