"""Plain text: a number with its noun, and a text without control characters."""

import re

_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")  # but tab and new line


def counted(number: int, one: str, several: str = "") -> str:
    """Return a number with its noun.

    >>> counted(1, "rule"), counted(0, "rule"), counted(2, "hypothesis", "hypotheses")
    ('1 rule', '0 rules', '2 hypotheses')
    """
    return f"{number} {one if number == 1 else several or one + 's'}"


def printable(text: str) -> str:
    r"""Return a text without control characters, which could command the terminal.

    >>> printable("hello\x1b[2J")
    'hello�[2J'
    """
    return _CONTROLS.sub("\ufffd", text)
