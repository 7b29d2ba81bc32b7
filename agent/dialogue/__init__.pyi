# SPDX-License-Identifier: Apache-2.0
from .manager import DialogueManager
from .questions import Knowledge, answer
from .reply import Reply
from .teaching import Lesson

__all__ = [
    "DialogueManager",
    "Knowledge",
    "Lesson",
    "Reply",
    "answer",
    "lesson",
    "request_of",
    "rule_of",
    "said_of",
]
