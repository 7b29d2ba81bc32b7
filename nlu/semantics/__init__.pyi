# SPDX-License-Identifier: Apache-2.0
from .coreference import Discourse, RefusedError, resolve
from .features import FeatureReader, Features, load_features
from .interpretation import Interpreter
from .licence import Licence, load_licence
from .meaning import Command, Control, Meaning, Question, Rule, Statement, ToolCommand
from .pragmatics import Intention, Pragmatics, load_pragmatics
from .predicates import Form, fill, form_of, form_of_term, match

__all__ = [
    "Command",
    "Control",
    "Discourse",
    "FeatureReader",
    "Features",
    "Form",
    "Intention",
    "Interpreter",
    "Licence",
    "Meaning",
    "Pragmatics",
    "Question",
    "RefusedError",
    "Rule",
    "Statement",
    "ToolCommand",
    "fill",
    "form_of",
    "form_of_term",
    "load_features",
    "load_licence",
    "load_pragmatics",
    "match",
    "resolve",
]
