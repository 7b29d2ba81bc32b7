# SPDX-License-Identifier: Apache-2.0
"""Words that deny the thing right after them: "no knife is used for pounding".

"No, knives are for cutting" puts something right, "no knives are for pounding" denies it, and only
the pause tells. So a rule is believed of "no knife" only as one that says that it is not so.
"""

from __future__ import annotations

from collections.abc import Callable, Collection

from ..lexicon.tokenizer import Tokens
from .meaning import Meaning, Statement

_LIKELY = 0.5  # a rule whose upper bound is below says that something is not so


def denies_a_thing(
    tokens: Tokens, denying: Collection[str], is_thing: Callable[[str], bool]
) -> bool:
    """Whether a word that denies stands right before a thing, with no pause between them.

    Args:
        tokens: the utterance.
        denying: words that deny what is named after them.
        is_thing: whether a word names, or may name, a thing.
    """
    words = tokens.words
    return any(
        word in denying and place not in tokens.pauses and is_thing(words[place])
        for place, word in enumerate(words[:-1], start=1)
    )


def is_denial(meaning: Meaning) -> bool:
    """Whether nothing is taught but that something is not so."""
    rules = meaning.rules if isinstance(meaning, Statement) else ()
    return all(rule.confidence[1] < _LIKELY for rule in rules)
