# SPDX-License-Identifier: Apache-2.0
from .categories import AtomicCategory, Category, Functor
from .combinators import Combination, Combinator
from .constructions import Construction
from .grammar import Grammar, Unary, load_grammar
from .notation import parse_term, read_category, read_entry, read_rule, read_type, read_unary
from .patterns import PatternError
from .terms import Apply, Bound, Constant, Lambda, Term, normal_form
from .types import Basic, FunctionType, Type, TypeMismatchError

__all__ = [
    "Apply",
    "AtomicCategory",
    "Basic",
    "Bound",
    "Category",
    "Combination",
    "Combinator",
    "Constant",
    "Construction",
    "FunctionType",
    "Functor",
    "Grammar",
    "Lambda",
    "PatternError",
    "Term",
    "Type",
    "TypeMismatchError",
    "Unary",
    "load_grammar",
    "normal_form",
    "parse_term",
    "read_category",
    "read_entry",
    "read_rule",
    "read_type",
    "read_unary",
]
