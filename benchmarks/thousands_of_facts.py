"""Thousands of facts told to one mind: how many are stored exactly as they were said, and how fast.

The sentences are "a NOUN is often used for GERUND" with nouns and gerunds of `benchmarks/data`,
"occasionally", "sometimes" or no word in place of "often". A sentence is stored exactly, asked
about, refused, or stored as something else. Near the end the rate and the time per sentence must
be what they were at the beginning. Run it as

    python benchmarks/thousands_of_facts.py [COUNT] [SEED] [--agent] [--list] [--plurals]

With `--agent` the sentences are told to an agent over a base in memory, else to a session of the
language part; `--list` prints all that were not stored exactly; `--plurals` says "NOUNS are".
"""

from __future__ import annotations

import random
import statistics
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

from hilt.nlu import Language, Session, Understanding

DATA = Path(__file__).parent / "data"
DEGREES = {"": 0.95, "often ": 0.75, "sometimes ": 0.5, "occasionally ": 0.25}

Fact: TypeAlias = "dict[str, object]"
Listener: TypeAlias = Callable[[str], Understanding]


def words(name: str) -> list[str]:
    """The words of a file of `benchmarks/data`."""
    lines = (DATA / f"{name}.txt").read_text(encoding="utf-8").splitlines()
    return [word for line in lines if not line.startswith("#") for word in line.split()]


def facts(
    count: int, rng: random.Random, language: Language, *, plurals: bool
) -> Iterator[tuple[str, Fact]]:
    """Different sentences and what each means; every noun and every gerund occurs early."""
    nouns, gerunds, pairs = words("nouns"), words("gerunds"), words("plurals")
    said: set[tuple[str, str]] = set()
    while len(said) < count:
        noun, gerund = rng.choice(nouns + pairs), rng.choice(gerunds)
        if (noun, gerund) in said:
            continue
        said.add((noun, gerund))
        degree, lower = rng.choice(list(DEGREES.items()))
        subject, verb = language.inflection.with_article(noun), "is"
        if plurals or noun in pairs:
            subject = noun if noun in pairs else language.inflection.form(noun, "plural")
            verb = "are"
        fact: Fact = {"rule": "functional", "object": noun, "affordance": gerund}
        yield f"{subject} {verb} {degree}used for {gerund}", fact | {"confidence": [lower, 1.0]}


def session(language: Language) -> Listener:
    """One conversation with the language part."""
    state = Session(language)

    def hear(text: str) -> Understanding:
        nonlocal state
        understood, state = state.hear(text)
        return understood

    return hear


def agent() -> Listener:
    """One conversation with an agent over a base in memory."""
    from hilt.agent import Agent

    listener = Agent.open("memory:")
    return lambda text: listener.hear(text).understanding


def outcome(understood: Understanding, fact: Fact) -> str:
    """What became of a sentence."""
    meaning = understood.meaning.as_json()
    if meaning == fact:
        return "exact"
    return understood.kind if understood.kind in {"ask_back", "error"} else "otherwise"


def main(*arguments: str) -> None:
    """Tell the facts, and print what became of them."""
    numbers = [int(each) for each in arguments if each.isdigit()]
    count, seed = (*numbers, *(5529, 0)[len(numbers) :])
    language, rng = Language.load(), random.Random(seed)  # noqa: S311 - no secret
    hear = agent() if "--agent" in arguments else session(language)
    found: Counter[str] = Counter()
    times: list[float] = []
    for text, fact in facts(count, rng, language, plurals="--plurals" in arguments):
        started = time.process_time()
        understood = hear(text)
        times.append((time.process_time() - started) * 1e3)
        kind = outcome(understood, fact)
        found[kind] += 1
        if "--list" in arguments and kind != "exact":
            print(f"{kind}: {text} -> {understood.meaning.as_json()}")
    print(f"{count} facts, seed {seed}")
    for kind in ("exact", "ask_back", "error", "otherwise"):
        print(f"{kind:>10} {found[kind]:5}  {100 * found[kind] / count:.1f} %")
    part = max(1, count // 10)
    for name, some in (("first", times[:part]), ("last", times[-part:])):
        p95 = sorted(some)[int(0.95 * len(some))]
        print(f"{name} {part}: median {statistics.median(some):.2f} ms, p95 {p95:.2f} ms")


if __name__ == "__main__":
    main(*sys.argv[1:])
