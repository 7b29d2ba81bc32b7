from .candidates import CandidateMeaning, candidates
from .checks import OfferChecks, load_check_words
from .choice_answers import choice_of
from .meaning_shapes import MeaningShape, meaning_from_json, shape_of
from .mentions import Mention, Mentions, find_mentions
from .offers import OfferFinder, OfferModel, load_model
from .ranker import Ranker
from .typing_slips import corrected_texts

__all__ = [
    "CandidateMeaning",
    "MeaningShape",
    "Mention",
    "Mentions",
    "OfferChecks",
    "OfferFinder",
    "OfferModel",
    "Ranker",
    "candidates",
    "choice_of",
    "corrected_texts",
    "find_mentions",
    "load_check_words",
    "load_model",
    "meaning_from_json",
    "shape_of",
]
