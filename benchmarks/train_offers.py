"""Trains the weights of the offers ("Did you mean ..?") from the utterances of `tests/nlu/data`.

    python benchmarks/train_offers.py [--seed 0] [--write]

Prints a table over five folds, which are runs of neighbouring lines of the files, so that sentences
written together are on one side. `--write` trains on all and writes `ontology/english/offers.json`.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import sys
import time
from array import array
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.optimize
import scipy.sparse
import yaml
from utterances import DATA, Utterance, data_sets

from hilt.nlu import Language, Session
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.offers.candidates import (
    NONE,
    Asides,
    CandidateMeaning,
    OfferModel,
    candidates,
    filling_features,
    utterance_features,
)
from hilt.nlu.offers.meaning_shapes import (
    MeaningShape,
    composed_shapes,
    meaning_from_json,
    shape_of,
)
from hilt.nlu.offers.mentions import Mentions
from hilt.nlu.offers.offers import LEAST
from hilt.nlu.parsing.understanding import UtteranceContext
from hilt.nlu.semantics.discourse import Discourse
from hilt.nlu.semantics.meaning import Json

OFFERS_FILE = Path(__file__).parents[1] / "ontology" / "english" / "offers.json"
OUT_OF_THE_BLUE = UtteranceContext("sam", "self", Discourse())
FOLDS = 5
RUN = 20  # neighbouring lines that stay together

LEAST_SHAPES, LEAST_FEATURES = 40, 4
"""How many examples have a shape or a feature that is used."""

KEPT = (12000, 5500, 2700, 1600, 1150, 1000)
"""How many weights are kept after each fit, the greatest; of equal ones those of more choices."""

NAMED = 0.65
"""How much less a weight needs whose feature has another one: it takes fewer bytes in the file."""

STEPS = 40
"""The greatest number of steps of each fit."""

PENALTY = 2.0
"""The weight of the squared weights in the loss."""

UNDERSTOOD, TO_REFUSE = 0.2, 0.5
"""How much an utterance counts for which nothing is ever offered, or nothing should be."""


_PEOPLE = ("recipient", "speaker")


@dataclass(frozen=True)
class Example:
    """An utterance, what it names, and the meanings that are right; none if it is to be refused."""

    text: str
    discourse: Discourse
    mentions: Mentions
    right: tuple[Json, ...]
    is_refused: bool  # by the grammar as it is
    must_be_refused: bool


def main() -> None:
    """Print the table, and write the weights if asked to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folds", type=int, default=FOLDS, help="how many of the folds to measure")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    language = Language.load()
    examples = list(read_examples(language))
    folds = folds_of(examples, options.seed)
    results = [
        result
        for fold in range(options.folds)
        for result in measure(language, examples, folds, fold)
    ]
    if results:
        print_table(results)
    if options.write:
        model = trained(examples, language.tool_acts)
        OFFERS_FILE.write_text(as_json(model, options.seed), encoding="utf-8")


def folds_of(examples: Sequence[Example], seed: int) -> list[int]:
    """Return the fold of each example; neighbours are in the same one."""
    runs = np.random.default_rng(seed).permutation(len(examples) // RUN + 1) % FOLDS
    return [int(runs[number // RUN]) for number in range(len(examples))]


def read_examples(language: Language) -> Iterator[Example]:
    """Yield the utterances of all files with what they mean, in their order."""
    for each in _utterances():
        session = Session(language).after(each.before)
        understood, _ = session.hear(each.text)
        yield Example(
            each.text,
            session.discourse,
            mentions_of(session, each.text),
            tuple(right_meanings(each.wanted)),
            understood.kind in {"error", "ask_back"},
            _is_open(each.wanted),
        )


def _utterances() -> Iterator[Utterance]:
    for name, utterances in data_sets().items():
        yield from utterances if name != "paradigm" else ()
    for family in yaml.safe_load((DATA / "unsaid.yaml").read_text(encoding="utf-8")).values():
        for text in family["unsaid"]:
            yield Utterance(text, (), None, "unsaid")


def mentions_of(session: Session, text: str) -> Mentions:
    """What an utterance names at its place in a conversation."""
    tokens = tokenize(text, session.language.builder.contractions)
    return session.language.offers.mentions(tokens, session.discourse)


def _is_open(wanted: dict[str, object] | None) -> bool:
    """Whether a failure or a question back is all that fits what is wanted."""
    choices = (wanted or {}).get("any_of")
    if isinstance(choices, list):
        return all(map(_is_open, choices))
    return not wanted or bool(wanted.keys() & {"error", "ask_back"})


def right_meanings(wanted: dict[str, object] | None) -> Iterator[Json]:
    """The meanings that fit what is wanted."""
    choices = (wanted or {}).get("any_of")
    for each in choices if isinstance(choices, list) else ():
        yield from right_meanings(each)
    if wanted and not wanted.keys() & {"any_of", "error", "ask_back", "ack"}:
        with contextlib.suppress(ValueError, KeyError, TypeError):  # the check of a part of it
            wanted = {"confidence": [0.95, 1.0], **wanted} if "norm" in wanted else wanted
            right = json.loads(json.dumps(meaning_from_json(wanted).as_json()))
            yield {key: v.lower() if key in _PEOPLE else v for key, v in right.items()}


def shapes_of(examples: Iterable[Example], acts: Mapping[str, str]) -> tuple[MeaningShape, ...]:
    """The composed shapes, and those of the meanings of at least `LEAST_SHAPES` examples."""
    count = Counter(
        shape
        for each in examples
        for shape in {shape_of(m, each.mentions, acts) for m in each.right}
    )
    common = (shape for shape, n in count.most_common() if n >= LEAST_SHAPES)
    return tuple(dict.fromkeys((*composed_shapes(), *common)))


@dataclass
class Choices:
    """The candidates of an utterance, and which of them are right, with "none" as the last."""

    example: Example
    candidates: list[CandidateMeaning]
    right: np.ndarray


def choices(
    examples: Sequence[Example], shapes: Sequence[MeaningShape], acts: Mapping[str, str]
) -> list[Choices]:
    """Return the choices that each example has."""
    found: list[Choices] = []
    for each in examples:
        some = list(candidates(each.mentions, shapes, acts))
        right = [one.meaning in each.right for one in some]
        found.append(Choices(each, some, np.array([*right, not any(right)])))
    return found


@dataclass
class Design:
    """The features of all candidates: rows of the shapes of an utterance, and of their fillings."""

    names: list[tuple[str, str]]
    shapes: scipy.sparse.csr_matrix
    of_shape: np.ndarray
    fillings: scipy.sparse.csr_matrix

    def scores(self, weights: np.ndarray) -> np.ndarray:
        """The score of each choice."""
        return (self.shapes @ weights)[self.of_shape] + self.fillings @ weights

    def only(self, order: np.ndarray) -> Design:
        """These features alone."""
        names = [self.names[each] for each in order]
        shapes, fillings = self.shapes[:, order].tocsr(), self.fillings[:, order].tocsr()
        return Design(names, shapes, self.of_shape, fillings)

    def gradient(self, errors: np.ndarray) -> np.ndarray:
        """The gradient of the weights, from the errors of the probabilities."""
        of_shapes = np.bincount(self.of_shape, errors, self.shapes.shape[0])
        return self.shapes.T @ of_shapes + self.fillings.T @ errors


def used_features(data: Sequence[Choices]) -> list[tuple[str, str]]:
    """The features that at least `LEAST_FEATURES` right choices have, of equal traits one."""
    count: Counter[tuple[str, str]] = Counter()
    for choice in data:
        mentions = choice.example.mentions
        none = utterance_features(mentions, mentions.asides(mentions.known))
        seen = {(f, NONE) for f in none} if choice.right[-1] else set()
        for each, right in zip(choice.candidates, choice.right, strict=False):
            if right:
                said = list(utterance_features(mentions, each.asides(mentions)))
                seen.update((f, trait) for trait in each.shape.traits for f in said)
                seen.update(filling_features(each, mentions))
        count.update(seen)
    doubled = _doubled({each.shape for choice in data for each in choice.candidates})
    return [f for f, n in count.items() if n >= LEAST_FEATURES and f[1] not in doubled]


def _doubled(shapes: Iterable[MeaningShape]) -> set[str]:
    """The traits of just those shapes that have another trait, too."""
    owners: dict[str, set[str]] = defaultdict(set)
    for shape in shapes:
        for trait in shape.traits:
            owners[trait].add(shape.text)
    firsts: dict[frozenset[str], str] = {}
    for trait in sorted(owners, key=lambda each: (not each.startswith("kind"), each)):
        firsts.setdefault(frozenset(owners[trait]), trait)
    return owners.keys() - set(firsts.values())


def design(data: Sequence[Choices], names: list[tuple[str, str]]) -> Design:
    """Return the features of all choices, of which only those with a name count."""
    columns: dict[str, dict[str, int]] = defaultdict(dict)
    for number, (feature, trait) in enumerate(names):
        columns[feature][trait] = number
    shapes, fillings = _Rows(), _Rows()
    of_shape: list[int] = []
    for choice in data:
        mentions = choice.example.mentions
        by_trait: dict[Asides, dict[str, list[int]]] = {}
        rows: dict[tuple[str, Asides], int] = {}
        for each in choice.candidates:
            asides = each.asides(mentions)
            if asides not in by_trait:
                by_trait[asides] = _by_trait(mentions, asides, columns)
            key = (each.shape.text, asides)
            if key not in rows:
                rows[key] = shapes.add(
                    n for t in each.shape.traits for n in by_trait[asides].get(t, ())
                )
            of_shape.append(rows[key])
            found = filling_features(each, mentions)
            fillings.add(columns[f][t] for f, t in found if t in columns.get(f, {}))
        none = _by_trait(mentions, mentions.asides(mentions.known), columns)
        of_shape.append(shapes.add(none.get(NONE, ())))
        fillings.add(())
    return Design(names, shapes.matrix(len(names)), np.array(of_shape), fillings.matrix(len(names)))


def _by_trait(
    mentions: Mentions, asides: Asides, columns: Mapping[str, Mapping[str, int]]
) -> dict[str, list[int]]:
    """The numbers of the features that an utterance has, by trait."""
    found: dict[str, list[int]] = defaultdict(list)
    for feature in utterance_features(mentions, asides):
        for trait, number in columns.get(feature, {}).items():
            found[trait].append(number)
    return found


class _Rows:
    def __init__(self) -> None:
        self.columns: array[int] = array("i")
        self.starts = array("i", [0])

    def add(self, columns: Iterable[int]) -> int:
        self.columns.extend(columns)
        self.starts.append(len(self.columns))
        return len(self.starts) - 2

    def matrix(self, width: int) -> scipy.sparse.csr_matrix:
        values = np.ones(len(self.columns), dtype=np.float32)
        shape = (len(self.starts) - 1, width)
        return scipy.sparse.csr_matrix(
            (values, np.array(self.columns), np.array(self.starts)), shape=shape
        )


def trained(examples: Sequence[Example], acts: Mapping[str, str]) -> OfferModel:
    """Fit the weights, and again those that are kept, fewer each time."""
    shapes = shapes_of(examples, acts)
    data = choices(examples, shapes, acts)
    part = design(data, used_features(data))
    weights = _fit(data, part, STEPS)
    for kept in KEPT:
        part = part.only(_greatest(part, weights, kept))
        weights = _fit(data, part, STEPS)
    found: dict[str, dict[str, float]] = defaultdict(dict)
    for (feature, trait), weight in zip(part.names, weights, strict=True):
        if shown := round(float(weight), 1):
            found[feature][trait] = shown
    return OfferModel(shapes, found)


def _greatest(whole: Design, weights: np.ndarray, kept: int) -> np.ndarray:
    uses = np.bincount(whole.of_shape, minlength=whole.shapes.shape[0])
    count = whole.shapes.T @ uses + np.asarray(whole.fillings.sum(axis=0)).ravel()
    size = np.abs(weights) * count**0.1
    least = np.sort(size)[-min(kept, len(size))]
    named = {name for (name, _), each in zip(whole.names, size, strict=True) if each >= least}
    is_named = np.array([name in named for name, _ in whole.names])
    return np.argsort(-size / np.where(is_named, NAMED, 1.0))[:kept]


def _count(example: Example) -> float:
    if not example.is_refused:
        return UNDERSTOOD
    return TO_REFUSE if example.must_be_refused else 1.0


def _fit(data: Sequence[Choices], made: Design, steps: int) -> np.ndarray:
    right = np.concatenate([choice.right for choice in data]).astype(float)
    sizes = [len(choice.right) for choice in data]
    firsts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    owners = np.repeat(np.arange(len(sizes)), sizes)
    counts = np.array([_count(each.example) for each in data])

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        scores = made.scores(weights)
        scores -= np.maximum.reduceat(scores, firsts)[owners]
        powers = np.exp(scores)
        total = np.add.reduceat(powers, firsts)
        good = np.maximum(np.add.reduceat(powers * right, firsts), 1e-300)
        value = counts @ (np.log(total) - np.log(good)) + PENALTY / 2 * weights @ weights
        errors = powers / total[owners] - powers * right / good[owners]
        gradient = made.gradient(counts[owners] * errors)
        return value, gradient + PENALTY * weights

    start = np.zeros(len(made.names))
    return scipy.optimize.minimize(
        loss, start, jac=True, method="L-BFGS-B", options={"maxiter": steps}
    ).x


@dataclass(frozen=True)
class Result:
    """What was offered for one utterance.

    Attributes:
        has: whether a candidate is right.
        ranked: whether each of the three likeliest candidates is right.
        first: the probability of the likeliest.
        offered: whether each of the meanings offered after the checks is right.
        seconds: how long finding the offers took.
    """

    example: Example
    has: bool
    ranked: tuple[bool, ...]
    first: float
    offered: tuple[bool, ...]
    seconds: float


def measure(
    language: Language, examples: Sequence[Example], folds: Sequence[int], fold: int
) -> Iterator[Result]:
    """Yield what is offered for the utterances of a fold after training on the others."""
    known = [each for each, number in zip(examples, folds, strict=True) if number != fold]
    model = trained(known, language.tool_acts)
    print(
        f"fold {fold}: {len(model.shapes)} shapes, {len(as_json(model, 0))} bytes", file=sys.stderr
    )
    offers = replace(language.offers, model=model)
    new = [each for each, number in zip(examples, folds, strict=True) if number == fold]
    for choice in choices(new, model.shapes, language.tool_acts):
        example = choice.example
        ranked = offers.ranked(example.mentions)[:3]
        start = time.process_time()
        offered = offers.of_mentions(example.mentions, OUT_OF_THE_BLUE)
        seconds = time.process_time() - start
        yield Result(
            example,
            bool(any(choice.right[:-1])),
            tuple(each.meaning in example.right for _, each in ranked),
            ranked[0][0] if ranked else 0.0,
            tuple(json.loads(json.dumps(each.as_json())) in example.right for each in offered),
            seconds,
        )


def print_table(results: Sequence[Result]) -> None:
    """Print what was offered for all utterances, and for those that are refused at present."""
    took = sorted(each.seconds * 1000 for each in results)
    print(f"one offer: {np.mean(took):.1f} ms, 95 %: {took[len(took) * 19 // 20]:.1f} ms")
    for title, chosen in (
        ("all", results),
        ("refused", [r for r in results if r.example.is_refused]),
    ):
        wanted = [each for each in chosen if each.example.right]
        unwanted = [each for each in chosen if each.example.must_be_refused]
        print(
            f"{title}: {len(wanted)} with a meaning, {sum(r.has for r in wanted)} with it as a",
            f"candidate; {len(unwanted)} to be refused",
        )
        _print_row(
            "without checks", wanted, unwanted, lambda r: r.ranked if r.first >= LEAST else ()
        )
        _print_row("no threshold", wanted, unwanted, lambda r: r.ranked)
        _print_row("with checks", wanted, unwanted, lambda r: r.offered)


def _print_row(
    title: str,
    wanted: Sequence[Result],
    unwanted: Sequence[Result],
    offers: Callable[[Result], Sequence[bool]],
) -> None:
    first = sum(offers(each)[:1] == (True,) for each in wanted)
    among = sum(any(offers(each)) for each in wanted)
    total, wrong = max(len(wanted), 1), sum(bool(offers(each)) for each in unwanted)
    print(
        f"  {title:15} offered {sum(bool(offers(each)) for each in wanted):5}"
        f"  right first {first:5} ({first / total:.0%})"
        f"  among three {among:5} ({among / total:.0%})"
        f"  for what must be refused {wrong} ({wrong / max(len(unwanted), 1):.1%})"
    )


def as_json(model: OfferModel, seed: int) -> str:
    """The file of a model: its shapes and traits, and for each feature its traits with weights.

    A trait goes by its number, that of a frequent one is small, and its weight in tenths follows.
    """
    count = Counter(trait for each in model.weights.values() for trait in each)
    traits = sorted(count, key=lambda trait: (-count[trait], trait))
    weights = (
        f"{_compact(feature)}:"
        + _compact([n for t, w in each.items() for n in (traits.index(t), round(10 * w))])
        for feature, each in sorted(model.weights.items())
    )
    others = [each.text for each in model.shapes if each not in composed_shapes()]
    made_by = f"python benchmarks/train_offers.py --write --seed {seed}"
    lines = [
        f'{{"made_by":{json.dumps(made_by)},',
        '"shapes":[\n' + ",\n".join(others) + "],",
        f'"traits":{_compact(traits)},',
        '"weights":{\n' + ",\n".join(weights) + "}}\n",
    ]
    return "\n".join(lines)


def _compact(value: object) -> str:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False)


if __name__ == "__main__":
    main()
