from .chart import Chart, Derivation
from .clarification import Clarifier
from .derivation_views import DerivationStep
from .parser import SentenceParser, UtteranceContext
from .reading_filter import ReadingFilter
from .segmentation import combine_meanings, segmentations
from .strategies import UtteranceParser
from .understanding import Reading, Understanding

__all__ = [
    "Chart",
    "Clarifier",
    "Derivation",
    "DerivationStep",
    "Reading",
    "ReadingFilter",
    "SentenceParser",
    "Understanding",
    "UtteranceContext",
    "UtteranceParser",
    "combine_meanings",
    "segmentations",
]
