# SPDX-License-Identifier: Apache-2.0
from .controls import ControlPhrases, load_controls
from .discourse_markers import DiscourseMarkers
from .inflection import Inflection, load_inflection
from .lexicon import Entry, Lexicon, Sense
from .loader import LexiconBuilder
from .tokenizer import Token, Tokens, tokenize
from .unknown_words import KnownWords, closest_word
from .vocabulary import NewWord, Vocabulary, household_vocabulary

__all__ = [
    "ControlPhrases",
    "DiscourseMarkers",
    "Entry",
    "Inflection",
    "KnownWords",
    "Lexicon",
    "LexiconBuilder",
    "NewWord",
    "Sense",
    "Token",
    "Tokens",
    "Vocabulary",
    "closest_word",
    "household_vocabulary",
    "load_controls",
    "load_inflection",
    "tokenize",
]
