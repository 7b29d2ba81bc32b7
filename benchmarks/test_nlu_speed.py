"""How fast utterances are understood, over the test data and beside nltk's CCG parser.

    pytest benchmarks/test_nlu_speed.py

The comparison needs nltk (`pip install nltk`), which Hilt itself does not. It gets a lexicon with
just the words and categories of the sentences it is given, so it has less to look at.
"""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml

from hilt.nlu import Language, Session

DATA = Path(__file__).parents[1] / "tests" / "nlu" / "data"
FILES = ("paper", "paraphrases", "commands", "conversation", "wide", "aside", "far")

MEDIAN, NEARLY_ALL, LONG = 1e-3, 5e-3, 5e-3  # [s]: p50, p95, 18 words
RULE = "To pass a knife generally grab the knife by the blade"
EIGHTEEN = (
    "when you pass the sharp red knife to me you should always grab it by the blade of the knife"
)

# What nltk needs for RULE and its shorter forms; categories as our lexicon has them.
NLTK_LEXICON = """
    :- S, B, C, NP, N, BY, P
    to => (S/B)/C
    pass => C/NP
    generally => B/B
    grab => (B/BY)/NP
    a => NP/N
    the => NP/N
    the => P/P
    knife => N
    by => BY/P
    blade => P
"""


@pytest.fixture(scope="module")
def session() -> Session:
    """A conversation at its beginning."""
    return Session(Language.load())


def utterances() -> Iterator[str]:
    """All utterances of the data, those of other authors too."""
    for name in FILES:
        for group in yaml.safe_load((DATA / f"{name}.yaml").read_text(encoding="utf-8")):
            yield from group["texts"]
    for line in (DATA / "blind.jsonl").read_text(encoding="utf-8").splitlines():
        yield json.loads(line)["text"]


def seconds(act: Callable[[], object], repeat: int = 5) -> float:
    """The least processor time that something takes [s]."""
    times: list[float] = []
    for _ in range(repeat):
        started = time.process_time()
        act()
        times.append(time.process_time() - started)
    return min(times)


def test_utterances_are_understood_in_a_millisecond(session: Session) -> None:
    """Median and 95th percentile over all test utterances, each said once before."""
    times = sorted(seconds(lambda text=text: session.hear(text), 2) for text in utterances())

    middle, high = statistics.median(times), times[int(len(times) * 0.95)]

    print(f"{len(times)} utterances: p50 {middle * 1e3:.2f} ms, p95 {high * 1e3:.2f} ms")
    assert middle <= MEDIAN
    assert high <= NEARLY_ALL


def test_a_long_utterance_takes_little_more(session: Session) -> None:
    """Eighteen words and more."""
    taken = seconds(lambda: session.hear(EIGHTEEN))

    print(f"{len(EIGHTEEN.split())} words: {taken * 1e3:.2f} ms")
    assert taken <= LONG


@pytest.mark.peer
def test_beside_nltk(session: Session) -> None:
    """The ratio of times on the sentences that both can parse."""
    chart = pytest.importorskip("nltk.ccg.chart")
    lexicon = pytest.importorskip("nltk.ccg.lexicon").fromstring(NLTK_LEXICON)
    parser = chart.CCGChartParser(lexicon, chart.DefaultRuleSet)
    for text in (RULE.replace("generally ", ""), RULE):
        words = text.lower().split()

        theirs = seconds(lambda words=words: list(parser.parse(words)), 3)
        ours = seconds(lambda text=text: session.hear(text))

        readings = sum(1 for _ in parser.parse(words))
        print(
            f"{len(words)} words: ours {ours * 1e3:.2f} ms, nltk {theirs * 1e3:.2f} ms "
            f"({theirs / ours:.1f} times), its readings {readings}, ours 1"
        )
