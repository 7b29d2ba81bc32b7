from .clause_features import FeatureReader, UtteranceFeatures, load_features
from .coreference import resolve
from .discourse import Discourse
from .interpretation import Interpreter
from .licence_table import LicenceTable, load_licence
from .meaning import Command, Control, Meaning, Question, Rule, Statement, ToolCommand
from .pragmatics import Intention, Pragmatics, load_pragmatics
from .predicates import PredicateForm, UninterpretableError, fill, form_of, form_of_term, match

__all__ = [
    "Command",
    "Control",
    "Discourse",
    "FeatureReader",
    "Intention",
    "Interpreter",
    "LicenceTable",
    "Meaning",
    "Pragmatics",
    "PredicateForm",
    "Question",
    "Rule",
    "Statement",
    "ToolCommand",
    "UninterpretableError",
    "UtteranceFeatures",
    "fill",
    "form_of",
    "form_of_term",
    "load_features",
    "load_licence",
    "load_pragmatics",
    "match",
    "resolve",
]
