"""Random input for the language part: nothing may crash, and nothing may take long.

Four kinds in turn: random characters of all of Unicode, known words in any order, good sentences
with their words shuffled, and good sentences cut, doubled or spliced. Whatever of them becomes a
goal is listed, for a person to see that each is a sentence that asks for it. Run it as

    python benchmarks/fuzz_nlu.py [COUNT] [SEED]
"""

from __future__ import annotations

import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import yaml

from hilt.nlu import Command, Language, ToolCommand

DATA = Path(__file__).parents[1] / "tests" / "nlu" / "data"
FILES = ("paper", "paraphrases", "commands", "conversation", "wide")
SLOW = 0.1  # [s], the bound of one parse


def sentences() -> list[str]:
    """The utterances of the test data."""
    groups = [
        group
        for name in FILES
        for group in yaml.safe_load((DATA / f"{name}.yaml").read_text(encoding="utf-8"))
    ]
    return [text for group in groups for text in group["texts"]]


def inputs(language: Language, count: int, rng: random.Random) -> Iterator[str]:
    """Random inputs, the four kinds in turn."""
    good, words = sentences(), sorted({*language.lexicon.words()})
    makers = (
        lambda: "".join(chr(rng.randrange(0x11000)) for _ in range(rng.randrange(200))),
        lambda: " ".join(rng.choices(words, k=rng.randrange(41))),
        lambda: _shuffled(rng.choice(good), rng),
        lambda: _spliced(rng.choice(good), rng.choice(good), rng),
    )
    for number in range(count):
        yield makers[number % len(makers)]()


def _shuffled(text: str, rng: random.Random) -> str:
    words = text.split()
    rng.shuffle(words)
    return " ".join(words)


def _spliced(text: str, other: str, rng: random.Random) -> str:
    first, second = text.split(), other.split()
    return " ".join(first[: rng.randrange(len(first) + 1)] + second[rng.randrange(len(second)) :])


def main(count: int = 100_000, seed: int = 0) -> None:
    """Run, and print what was seen."""
    language, rng = Language.load(), random.Random(seed)  # noqa: S311 - no secret
    kinds: Counter[str] = Counter()
    goals: Counter[str] = Counter()
    times: list[float] = []
    slowest = (0.0, "")
    for text in inputs(language, count, rng):
        started = time.process_time()
        understood = language.understand(text)
        times.append(time.process_time() - started)
        slowest = max(slowest, (times[-1], text))
        kinds[understood.kind] += 1
        if isinstance(understood.meaning, (Command, ToolCommand)):
            goals[text] += 1
    times.sort()
    print(f"{count} inputs, seed {seed}: {dict(kinds)}")
    print(f"slowest {times[-1] * 1e3:.1f} ms, over {SLOW:g} s: {sum(t > SLOW for t in times)}")
    print(f"slowest: {slowest[1]!r}")
    for text, _ in goals.most_common(40):
        print(f"a goal: {text!r}")


if __name__ == "__main__":
    main(*(int(each) for each in sys.argv[1:]))
