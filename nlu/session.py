# SPDX-License-Identifier: Apache-2.0
"""A conversation that is kept nowhere: each utterance is understood after those before it.

What was spoken of ("it"), the last rule ("no, by the handle") and the words that statements taught
are carried on from one utterance to the next. Nothing is believed and nothing is done.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from .language import Language
from .parsing.understanding import Understanding
from .semantics.coreference import Discourse
from .semantics.meaning import Statement


@dataclass(frozen=True)
class Session:
    """What a listener knows at one moment of a conversation.

    Attributes:
        language: with the words learned so far.
        discourse: what was spoken of so far.
    """

    language: Language
    discourse: Discourse = field(default_factory=Discourse)

    def hear(self, text: str, *, speaker: str = "sam") -> tuple[Understanding, Session]:
        """What an utterance means here, and the session after it."""
        understood = self.language.understand(text, speaker=speaker, discourse=self.discourse)
        language = self.language
        if isinstance(understood.meaning, Statement):
            language = language.with_words(understood.new_words)
        return understood, Session(language, understood.discourse)

    def after(self, texts: Iterable[str], *, speaker: str = "sam") -> Session:
        """The session once several utterances were heard."""
        session = self
        for text in texts:
            _, session = session.hear(text, speaker=speaker)
        return session
