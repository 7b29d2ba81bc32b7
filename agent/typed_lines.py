"""Lines that are typed on a terminal: a prompt, a history over sessions, completion of words."""

import contextlib
import sys
from collections.abc import Callable, Collection, Generator, Iterator
from pathlib import Path

from platformdirs import user_state_path

HISTORY_LENGTH = 1000  # lines
_DELIMITERS = " \t\n,.;:!?\"'"


def read_lines(
    prompt: Callable[[], str],
    words: Callable[[], Collection[str]],
    interrupt: Callable[[], None] = lambda: None,
) -> Iterator[str]:
    """Yield the lines that are typed until the end of input; Ctrl-C discards one and interrupts."""
    with _editing(user_state_path("hilt") / "history", words):
        while True:
            try:
                line = input(prompt())
            except EOFError:
                sys.stdout.write("\n")  # the shell's prompt stands on a line of its own
                return
            except KeyboardInterrupt:
                sys.stdout.write("\n")
                interrupt()
                continue
            yield line


def typed_so_far() -> str:
    """Return what was typed of the present line; empty where that is not known."""
    readline = sys.modules.get("readline")
    return readline.get_line_buffer() if readline else ""


def completions(start: str, words: Collection[str]) -> list[str]:
    """Return the words with this prefix, sorted; none for an empty prefix.

    >>> completions("spo", {"spoon", "spoons", "mug"})
    ['spoon', 'spoons']
    """
    return sorted(word for word in words if start and word.startswith(start.lower()))


@contextlib.contextmanager
def _editing(history: Path, words: Callable[[], Collection[str]]) -> Generator[None]:
    try:
        import readline
    except ImportError:
        yield
        return

    def complete(start: str, number: int) -> str | None:
        found = completions(start, words())
        return found[number] if number < len(found) else None

    with contextlib.suppress(OSError):
        readline.read_history_file(history)
    readline.set_history_length(HISTORY_LENGTH)
    readline.set_completer_delims(_DELIMITERS)
    readline.set_completer(complete)
    readline.parse_and_bind("tab: complete")
    try:
        yield
    finally:
        readline.set_completer(None)
        with contextlib.suppress(OSError):
            history.parent.mkdir(parents=True, exist_ok=True)
            readline.write_history_file(history)
