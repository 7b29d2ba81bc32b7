"""What becomes of an utterance that loses a word: refused, the same, or something else.

Each word of each utterance of the test data is left out once. What then still gives a belief or a
goal either means the same (the word carried no meaning), or something else. That can be right: "a
spoon is used for cutting" is a sentence too, and nobody can hear the "never" that was lost. So the
words whose loss changed a meaning are listed, for a person to judge. Run it as

    python benchmarks/word_removal.py [--all]
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import yaml

from hilt.nlu import Language, Session, Understanding

DATA = Path(__file__).parents[1] / "tests" / "nlu" / "data"
FILES = ("paper", "paraphrases", "commands", "wide")
ACTING = ("statement", "command")


def utterances() -> Iterator[str]:
    """The statements and commands of the test data."""
    for name in FILES:
        for group in yaml.safe_load((DATA / f"{name}.yaml").read_text(encoding="utf-8")):
            if "before" not in group:
                yield from group["texts"]


def shortened(text: str) -> Iterator[tuple[str, str]]:
    """Each word of a text, and the text without it."""
    words = text.split()
    for place, word in enumerate(words):
        yield word, " ".join(words[:place] + words[place + 1 :])


def outcome(whole: Understanding, cut: Understanding) -> str:
    """What the loss of a word did."""
    if cut.kind not in ACTING:
        return "noticed" if cut.kind in {"error", "ask_back"} else "neither belief nor goal"
    return "same meaning" if cut.meaning == whole.meaning else "other meaning"


def main() -> None:
    """Count the outcomes, and list the words that changed a meaning."""
    session = Session(Language.load())
    counts: Counter[str] = Counter()
    words: Counter[str] = Counter()
    for text in utterances():
        whole, _ = session.hear(text)
        if whole.kind not in ACTING:
            continue
        for word, rest in shortened(text):
            cut, _ = session.hear(rest)
            came = outcome(whole, cut)
            counts[came] += 1
            if came == "other meaning":
                words[word.lower().strip(".,!?;:")] += 1
                if "--all" in sys.argv:
                    print(f"{text!r} - {word!r}: {cut.meaning.as_json()}")
    print(dict(counts))
    print("words whose loss changed a meaning:", dict(words.most_common()))


if __name__ == "__main__":
    main()
