"""What the files of a language say, apart from names and answers; kept ready for the next program.

Reading and checking the files takes several times as long as reading what they were made into.
"""

from functools import partial
from pathlib import Path
from typing import NamedTuple

from ..ontology.confidence import Degrees, load_degrees
from ..ontology.disk_cache import kept
from ..ontology.errors import UnknownNameError
from .grammar.combinators import CombinationTable
from .grammar.grammar import Grammar, load_grammar
from .lexicon.inflection import load_inflection
from .lexicon.loader import LexiconBuilder
from .semantics.clause_features import FeatureReader, load_features
from .semantics.licence_table import LicenceTable, load_licence
from .semantics.predicates import Pragmatics, load_pragmatics

LANGUAGES_FOLDER = Path(__file__).parents[1] / "ontology"

_WORD_FILES = (
    "lexicon.yaml",
    "clauses.yaml",
    "attitudes.yaml",
    "constructions.yaml",
    "requests.yaml",
    "conversation.yaml",
    "fragments.yaml",
    "norms.yaml",
)


class LanguageTables(NamedTuple):
    """What the files of a language say."""

    degrees: Degrees
    grammar: Grammar
    builder: LexiconBuilder
    pragmatics: Pragmatics
    features: FeatureReader
    licence: LicenceTable


def language_folder(language: str) -> Path:
    """Return the folder of a language; `UnknownNameError` if there is none."""
    known = [path.parent.name for path in LANGUAGES_FOLDER.glob("*/lexicon.yaml")]
    if language not in known:
        raise UnknownNameError("language", language, known)
    return LANGUAGES_FOLDER / language


def load_tables(folder: Path) -> LanguageTables:
    """Return what the files in a folder say, a new value at each call.

    It is cached until a file of language or code changes. `DataError` says where a file is wrong.
    """
    code = Path(__file__).parent
    sources = (*code.glob("*.py"), *code.glob("*/*.py"), *code.glob("*/*.lark"))
    files = (*folder.glob("*.*"), *LANGUAGES_FOLDER.glob("*.*"), *sources)
    return kept(folder.name, files, partial(_read, folder))


def _read(folder: Path) -> LanguageTables:
    degrees = load_degrees()
    grammar = load_grammar(folder / "grammar.yaml", degrees=degrees.intervals)
    inflection = load_inflection(folder / "inflection.yaml")
    builder = LexiconBuilder(grammar, inflection, CombinationTable(grammar.unary))
    for name in _WORD_FILES:
        builder.read(folder / name)
    features = load_features(folder / "features.yaml")
    licence = load_licence(features.values, degrees.intervals)
    return LanguageTables(degrees, grammar, builder, load_pragmatics(), features, licence)
