# SPDX-License-Identifier: Apache-2.0
"""Small things that are written everywhere: a number with its noun, a text without controls."""

from __future__ import annotations

import re

_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")  # but tab and new line


def counted(number: int, one: str, several: str = "") -> str:
    """A number with its noun.

    Args:
        number: how many.
        one: what each is called.
        several: the plural, where it is not made with an s.

    >>> counted(1, "rule"), counted(0, "rule"), counted(2, "hypothesis", "hypotheses")
    ('1 rule', '0 rules', '2 hypotheses')
    """
    return f"{number} {one if number == 1 else several or one + 's'}"


def printable(text: str) -> str:
    r"""A text of somebody else's, without what would command the terminal that shows it.

    >>> printable("hello\x1b[2J")
    'hello�[2J'
    """
    return _CONTROLS.sub("\ufffd", text)
