"""Offers: meanings to choose from for an utterance that the grammar does not understand.

mentions            the names in an utterance, with the roles that they may have
meaning_shapes      meanings with slots in place of the names
candidates          the meanings that the names allow
ranker              a log-linear model of which candidate was meant, or none
checks              what an offer may not lose: a negation, condition, degree, doer or source
typing_slips        the words meant by misspelled ones
offers              candidates, ranked, checked, and parsed back from the sentences that say them
choice_answers      the answers to numbered choices
utterance_segments  spans of an utterance that may be all that it means
courtesies          greetings, thanks and praise in what is not understood
phrase_memory       turns of phrase whose meaning was confirmed
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
