"""The words of a language: tokens, entries, inflection, unknown words.

tokenizer          texts as tokens
lexicon            entries with category and lambda term, found token by token
loader             the reader of word files, and the builder of entries for new names
inflection         plurals, gerunds, participles and articles, by rules
vocabulary         the names of a domain, and words that were learned
learned_lexicon    the lexicon that grows by the words that are learned
immutable_index    an immutable mapping to which adding is cheap
unknown_words      entries for words never heard
misspelling        the known word that a new one is a slip of
discourse_markers  phrases that add nothing, such as "you know", and their removal
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
