"""Semantics and pragmatics: from the term of a derivation to what an utterance means to Hilt.

predicates       predicate forms, and patterns over them: `pass(self,knife)`
meaning          the meanings: rules, commands, questions, corrections, acknowledgements
coreference      the referent of "it" in what was said before
discourse        what a conversation mentioned so far
pragmatics       rules from speech acts to intentions
interpretation   from an intention to its meaning
clause_features  who does it, when, how surely and on whose word, read off the small words
licence_table    which features let a meaning become a rule, and how sure it is then
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
