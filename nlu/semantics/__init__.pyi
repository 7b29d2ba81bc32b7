# SPDX-License-Identifier: Apache-2.0
from .coreference import Discourse, RefusedError, resolve
from .features import FeatureReader, UtteranceFeatures, load_features
from .interpretation import Interpreter
from .licence_table import Licence, load_licence
from .meaning import Command, Control, Meaning, Question, Rule, Statement, ToolCommand
from .pragmatics import Intention, Pragmatics, load_pragmatics
from .predicates import PredicateForm, fill, form_of, form_of_term, match

__all__ = [
    "Command",
    "Control",
    "Discourse",
    "FeatureReader",
    "Intention",
    "Interpreter",
    "Licence",
    "Meaning",
    "Pragmatics",
    "PredicateForm",
    "Question",
    "RefusedError",
    "Rule",
    "Statement",
    "ToolCommand",
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
