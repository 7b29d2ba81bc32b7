"""Lines that are typed on a terminal: a prompt, a history over sessions, completion of words."""

import re
from collections.abc import Callable, Collection, Iterator

from platformdirs import user_state_path
from prompt_toolkit import PromptSession
from prompt_toolkit.completion import CompleteEvent, Completer, Completion
from prompt_toolkit.document import Document
from prompt_toolkit.history import FileHistory, History, InMemoryHistory
from prompt_toolkit.patch_stdout import patch_stdout
from prompt_toolkit.shortcuts import CompleteStyle

_WORD = re.compile(r"[^\s,.;:!?\"']+")


class WordCompleter(Completer):
    """Completes one of the `words` by its beginning, in any case; offers nothing for nothing."""

    def __init__(self, words: Callable[[], Collection[str]]) -> None:
        self.words = words

    def get_completions(
        self, document: Document, complete_event: CompleteEvent
    ) -> Iterator[Completion]:
        """Yield the words that begin like the one before the cursor, sorted."""
        start = document.get_word_before_cursor(pattern=_WORD).lower()
        for word in sorted(self.words()) if start else ():
            if word.startswith(start):
                yield Completion(word, -len(start))


def read_lines(
    prompt: Callable[[], str],
    words: Callable[[], Collection[str]],
    interrupt: Callable[[], None] = lambda: None,
) -> Iterator[str]:
    """Yield the lines that are typed until the end of input; Ctrl-C discards one and interrupts.

    What is printed meanwhile, in any thread, stands above the line that is being typed.
    """
    session = PromptSession[str](
        history=_history(),
        completer=WordCompleter(words),
        complete_style=CompleteStyle.READLINE_LIKE,
        complete_while_typing=False,
    )
    while True:
        try:
            with patch_stdout(raw=True):
                line = session.prompt(prompt())
        except EOFError:
            return
        except KeyboardInterrupt:
            interrupt()
        else:
            yield line


def _history() -> History:
    file = user_state_path("hilt") / "history"
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    except OSError:
        return InMemoryHistory()
    return FileHistory(file)
