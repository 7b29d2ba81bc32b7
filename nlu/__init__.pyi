from .language import Language, Session
from .lexicon.vocabulary import NewWord, Vocabulary
from .parsing.understanding import Reading, Understanding
from .semantics.discourse import Discourse
from .semantics.meaning import (
    ANY_OBJECT,
    Acknowledgement,
    ActionRule,
    AskBack,
    Command,
    FunctionalRule,
    Meaning,
    Misunderstanding,
    ObjectReference,
    Question,
    Retraction,
    Rule,
    Statement,
    ToolCommand,
)

__all__ = [
    "ANY_OBJECT",
    "Acknowledgement",
    "ActionRule",
    "AskBack",
    "Command",
    "Discourse",
    "FunctionalRule",
    "Language",
    "Meaning",
    "Misunderstanding",
    "NewWord",
    "ObjectReference",
    "Question",
    "Reading",
    "Retraction",
    "Rule",
    "Session",
    "Statement",
    "ToolCommand",
    "Understanding",
    "Vocabulary",
]
