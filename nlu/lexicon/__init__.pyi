from .control_phrases import ControlPhrases, load_controls
from .discourse_markers import DiscourseMarkers
from .immutable_index import ImmutableIndex
from .inflection import Inflection, load_inflection
from .learned_lexicon import LearnedLexicon
from .lexicon import Entry, LazyEntry, Lexicon
from .loader import LexiconBuilder
from .misspelling import intended_word
from .tokenizer import Token, Tokens, tokenize
from .unknown_words import KnownWords
from .vocabulary import NewWord, Vocabulary, household_vocabulary

__all__ = [
    "ControlPhrases",
    "DiscourseMarkers",
    "Entry",
    "ImmutableIndex",
    "Inflection",
    "KnownWords",
    "LazyEntry",
    "LearnedLexicon",
    "Lexicon",
    "LexiconBuilder",
    "NewWord",
    "Token",
    "Tokens",
    "Vocabulary",
    "household_vocabulary",
    "intended_word",
    "load_controls",
    "load_inflection",
    "tokenize",
]
