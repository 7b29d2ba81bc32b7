# SPDX-License-Identifier: Apache-2.0
"""How many there are of something, as a person says it."""

from __future__ import annotations


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
