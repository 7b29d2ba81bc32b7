# SPDX-License-Identifier: Apache-2.0
from .controls import ControlPhrases, load_controls
from .discourse_markers import DiscourseMarkers
from .inflection import Inflection, load_inflection
from .learned_lexicon import LearnedLexicon
from .lexicon import Entry, Lexicon, Sense
from .loader import LexiconBuilder
from .misspelling import intended_word
from .shared_index import SharedIndex
from .tokenizer import Token, Tokens, tokenize
from .unknown_words import KnownWords
from .vocabulary import NewWord, Vocabulary, household_vocabulary

__all__ = [
    "ControlPhrases",
    "DiscourseMarkers",
    "Entry",
    "Inflection",
    "KnownWords",
    "LearnedLexicon",
    "Lexicon",
    "LexiconBuilder",
    "NewWord",
    "Sense",
    "SharedIndex",
    "Token",
    "Tokens",
    "Vocabulary",
    "household_vocabulary",
    "intended_word",
    "load_controls",
    "load_inflection",
    "tokenize",
]
