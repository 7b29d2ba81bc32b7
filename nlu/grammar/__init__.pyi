from .categories import AtomicCategory, Category, Functor
from .combinators import BinaryRule, CombinationTable
from .constructions import Construction
from .grammar import Grammar, UnaryRule, load_grammar
from .notation_reader import parse_term, read_entry, read_rule, read_type, read_unary
from .terms import Application, BoundVariable, Constant, Lambda, Term, normal_form
from .types import BasicType, FunctionType, Type, TypeMismatchError
from .word_patterns import PatternError

__all__ = [
    "Application",
    "AtomicCategory",
    "BasicType",
    "BinaryRule",
    "BoundVariable",
    "Category",
    "CombinationTable",
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
    "UnaryRule",
    "load_grammar",
    "normal_form",
    "parse_term",
    "read_entry",
    "read_rule",
    "read_type",
    "read_unary",
]
