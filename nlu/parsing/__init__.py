"""Parsing: from the text of an utterance to its readings, or to the clarification it needs.

chart             the CCG chart of a token sequence, and its derivations
clause_spans      the words of a derivation by clause, and the features of a sentence
derivation_views  derivation trees as text, JSON and SVG
parser            the readings of one sentence, from its chart
periphery         what surrounds a core, and beside which meanings it may stand
reading_filter    which readings may introduce new words, and what "no" negates
segmentation      splitting at pauses, and combining the meanings of segments
clarification     answers to utterances that have no single clear reading
strategies        the order in which an utterance is tried: sentence, segments, ...
understanding     the result: reading, meaning, new words, discourse state
utterance_pieces  the pieces between pauses: their forms, and what a meaning may depend on in them
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
