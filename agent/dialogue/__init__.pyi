from .manager import DialogueManager
from .questions import AnswerSources, answer
from .reply import Reply
from .teaching import Lesson, lesson_from_statement
from .translation import meaning_from_rule, request_from_command, rule_from_meaning

__all__ = [
    "AnswerSources",
    "DialogueManager",
    "Lesson",
    "Reply",
    "answer",
    "lesson_from_statement",
    "meaning_from_rule",
    "request_from_command",
    "rule_from_meaning",
]
