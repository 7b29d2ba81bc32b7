# SPDX-License-Identifier: Apache-2.0
"""Which words are known, and all that the others may be.

Known are the words of the lexicon, those of grammar, and the fillers of frames. Some words of turns
of phrase may name something new as well, and a word that only adds nothing ends no name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from .inflection import Inflection
from .lexicon import Entry, Lexicon
from .loader import LexiconBuilder
from .tokenizer import Token, Tokens
from .unknown_words import NOUNS, compounds, guesses

_KNOWN_COST = 1.0  # a word of a turn of phrase hardly ever names something, too


@dataclass(frozen=True, repr=False)
class KnownWords:
    """The words that are known.

    Attributes:
        lexicon: the words with their meanings.
        framed: the words that add nothing in frames.
        book: how entries are made for new words.
        inflection: forms of words.
    """

    lexicon: Lexicon
    framed: frozenset[str]
    builder: LexiconBuilder
    inflection: Inflection

    @cached_property
    def words(self) -> frozenset[str]:
        """Every single word that the lexicon has."""
        return frozenset(self.lexicon.words())

    @cached_property
    def named(self) -> frozenset[str]:
        """Every single word that is part of a name: of an object, a use, a property, ..."""
        names = self.lexicon.names
        return frozenset(
            word for kind in NOUNS for name in names.get(kind, ()) for word in name.split(" ")
        )

    def unknown(self, tokens: Tokens) -> list[Token]:
        """The tokens that are not known."""
        return [token for token in tokens.items if not self._has(token.word)]

    def guesses(self, tokens: Tokens, unknown: Sequence[Token]) -> Mapping[int, Sequence[Entry]]:
        """All that new words may be, and names of two words, by their places."""
        found = {
            place: guesses(
                token, self.builder, self.inflection, cost=0.0 if token in unknown else _KNOWN_COST
            )
            for place, token in enumerate(tokens.items)
            if token in unknown or token.word in self._unnamed
        }
        for place, pair in enumerate(pairwise(tokens.items)):
            is_cut = place + 1 in tokens.pauses
            first, second = (token.word for token in pair)
            if not is_cut and first not in self.builder.closed and self._may_end_a_name(second):
                names = compounds(first, second, self.builder, self.inflection, self.lexicon)
                if names:
                    found[place] = [*found.get(place, ()), *names]
        return found

    def _has(self, word: str) -> bool:
        return word in self.lexicon or word in self.builder.closed or word in self.framed

    @cached_property
    def _unnamed(self) -> frozenset[str]:
        """Words of turns of phrase that name nothing yet, and may be taught as names."""
        return self.builder.names_too - self.named

    def may_be_a_thing(self, word: str) -> bool:
        """Whether a word names, or may name, a thing."""
        names = self._things | self.builder.names_too | self.builder.denied
        return word in names or not self._has(word)

    @cached_property
    def _things(self) -> frozenset[str]:
        """The words, in all forms, that name objects and parts."""
        names = self.lexicon.names
        return frozenset[str]().union(*(names.get(kind, ()) for kind in ("N", "NS", "P")))

    def _may_end_a_name(self, word: str) -> bool:
        """Whether a word may end the name of a thing: "territory", which adds nothing, does not."""
        is_named = word in self.lexicon or word in self.builder.names_too
        return word not in self.builder.closed and (is_named or word not in self.framed)
