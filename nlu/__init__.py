"""Natural language understanding and generation: from a text to its meaning, and back.

A text becomes tokens, these a chart of derivations of a categorial grammar (CCG), a derivation a
predicate form, the form a speech act and an intention, and the intention a meaning.

token           a word as the lexicon spells it
category        the syntactic type of a word, by what it combines with: `NP/N`
term            the lambda term that a word contributes to the meaning: `λx.x`
chart           all constituents that the words of an utterance can form
derivation      one way in which they form the whole utterance
predicate form  its meaning without variables: `pass(self,knife)`
speech act      who says it to whom, and how: `INSTRUCT(sam,self,pass(self,knife))`
intention       what the speaker wants by it: `want(sam,pass(self,knife))`
meaning         the value that leaves this package: a rule, a command, a question, ...

>>> from hilt.nlu import Language
>>> language = Language.load()
>>> language.understand("pass me something used for cutting").pragmatics
'want(sam,pass(self,usedFor(something,cutting)))'
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
