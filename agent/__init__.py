# SPDX-License-Identifier: Apache-2.0
"""The composition root: everything joined into one that can be talked to.

agent     knowledge base, language, inference and body, joined
dialogue  believes what is told, carries out what is asked, answers what is wanted
goal      the predicate of a command; the goal manager walks its action tree
step      one node of that walk, with its four operations
decision  why this thing and why this part, with every candidate
reply     the answer to one utterance, with all that came of it
episode   a command and what came of it, as it is kept in the graph

>>> from hilt.agent import Agent
>>> with Agent.open("memory:", simulate=False) as agent:
...     agent.hear("A knife is used for cutting").said
'I learned: a knife is used for cutting (0.95, from Sam).'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .agent import Agent
    from .dialogue.reply import Reply
    from .protocols import Motion, Vision

__all__ = ["Agent", "Motion", "Reply", "Vision"]

_HOMES = {"Agent": "agent", "Motion": "protocols", "Reply": "dialogue.reply", "Vision": "protocols"}


def __getattr__(name: str) -> object:
    """Load what is asked for when it is asked for, so that `hilt --help` answers at once."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f".{_HOMES[name]}", __name__), name)
