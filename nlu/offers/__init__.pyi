# SPDX-License-Identifier: Apache-2.0
from .candidates import CandidateMeaning, candidates
from .checks import Checks, load_check_words
from .choice import ChoiceWords, load_choice_words
from .mentions import Mention, Mentions, find_mentions
from .offers import OfferModel, Offers, load_model
from .ranker import Ranker
from .shapes import Shape, meaning_from_json, shape_of
from .slips import corrected_texts

__all__ = [
    "CandidateMeaning",
    "Checks",
    "ChoiceWords",
    "Mention",
    "Mentions",
    "OfferModel",
    "Offers",
    "Ranker",
    "Shape",
    "candidates",
    "corrected_texts",
    "find_mentions",
    "load_check_words",
    "load_choice_words",
    "load_model",
    "meaning_from_json",
    "shape_of",
]
