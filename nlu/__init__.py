# SPDX-License-Identifier: Apache-2.0
"""Natural language: from a text to its meaning, and from what there is to say to a text.

Utterance       one text from one speaker to one addressee
token           a word as the lexicon spells it
category        what a word combines with (`NP/N`), and so what it is
term            the lambda term a word contributes to the meaning (`λx.x`)
chart           all that the words of an utterance can be together
derivation      one way in which they are a whole utterance
predicate form  its meaning without variables: `pass(self,knife)`
speech act      who says it to whom, and how: `INSTRUCT(sam,self,pass(self,knife))`
intention       what the speaker wants by it: `want(sam,pass(self,knife))`
meaning         what it comes to for Hilt: a rule, a command, a question, ...

    >>> from hilt.nlu import Language
    >>> language = Language.load()
    >>> language.understand("pass me something used for cutting").pragmatics
    'want(sam,pass(self,usedFor(something,cutting)))'
"""

from __future__ import annotations

from .language import Language
from .lexicon.vocabulary import NewWord, Vocabulary
from .parsing.understanding import Reading, Understanding
from .semantics.coreference import Discourse
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
from .session import Session

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
