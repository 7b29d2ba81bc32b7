from .manager import DialogueManager
from .questions import answer
from .reply import Reply
from .teaching import Lesson, lesson_from_statement
from .translation import meaning_from_rule, request_from_command, rule_from_meaning

__all__ = [
    "DialogueManager",
    "Lesson",
    "Reply",
    "answer",
    "lesson_from_statement",
    "meaning_from_rule",
    "request_from_command",
    "rule_from_meaning",
]
