"""Combinatory categorial grammar (CCG) with lambda terms, read from the notation of data files.

categories, types  syntactic categories, and the types of their meanings
terms              lambda terms in de Bruijn notation, normalised by evaluation
notation_reader    the reader of categories, terms, types and rules
word_patterns      spellings with choices, as automata: `when (you|we) [want to]`
word_lists         the patterns and phrases of one file of a language, by key
grammar            the categories, unary rules and root categories of a language
constructions      phrases with gaps, as lexical entries
combinators        application and harmonic composition in normal form
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
