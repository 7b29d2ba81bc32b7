"""Shows where the right offer is lost for utterances that are not understood at once.

    python benchmarks/lost_offers.py [FILE ...] [--list]

A file has one JSON object a line: `text`, `meaning`, and `before`, the utterances before it.
Without files the utterances of `tests/nlu/data` are taken, each by weights that were not trained
on it. `--list` prints the utterances, too.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from train_offers import FOLDS, folds_of, read_examples, right_meanings, trained

from hilt.nlu import Language, Session
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.offers.candidates import candidates
from hilt.nlu.offers.meaning_shapes import shape_of
from hilt.nlu.offers.mentions import Mentions
from hilt.nlu.offers.offers import OfferFinder
from hilt.nlu.parsing.clarification import MAX_CHOICES
from hilt.nlu.parsing.understanding import UtteranceContext
from hilt.nlu.semantics.discourse import Discourse
from hilt.nlu.semantics.meaning import Json, Meaning


class Loss(NamedTuple):
    """Where the right offer of an utterance is lost; `offered` if it is not."""

    text: str
    at: str
    detail: str


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--folds", type=int, default=FOLDS, help="how many of the folds to measure")
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    language = Language.load()
    found = list(
        of_files(language, options.files) if options.files else of_folds(language, options.folds)
    )
    if options.list:
        for loss in sorted(found, key=lambda each: each[1:]):
            print(f"{loss.at:28} {loss.text}\n{'':28} {loss.detail}")
    count = Counter(each.at for each in found)
    for at, n in count.most_common():
        print(f"{at:40} {n:5} {n / len(found):6.1%}")
    print(f"{'not understood at once':40} {len(found):5}")


def of_files(language: Language, files: Sequence[Path]) -> Iterator[Loss]:
    """Yield the losses of the utterances of some files."""
    for path in files:
        for line in filter(str.strip, path.read_text(encoding="utf-8").splitlines()):
            case = json.loads(line)
            right = tuple(right_meanings(case["meaning"]))
            session = Session(language).after(tuple(case.get("before") or ()))
            understood, _ = session.hear(case["text"])
            if understood.kind in {"error", "ask_back"} and right:
                yield loss_of(language, language.offers, case["text"], session.discourse, right)


def of_folds(language: Language, count: int) -> Iterator[Loss]:
    """Yield the losses of the utterances of the test data, by weights trained on the others."""
    examples = list(read_examples(language))
    folds = folds_of(examples, 0)
    for fold in range(count):
        known = [each for each, n in zip(examples, folds, strict=True) if n != fold]
        offers = replace(language.offers, model=trained(known, language.tool_acts))
        for each, n in zip(examples, folds, strict=True):
            if n == fold and each.is_refused and each.right:
                yield loss_of(language, offers, each.text, each.discourse, each.right)


def loss_of(
    language: Language, offers: OfferFinder, text: str, discourse: Discourse, right: Sequence[Json]
) -> Loss:
    """Return where the right offer of an utterance is lost."""
    tokens = tokenize(text, language.builder.contractions)
    context = UtteranceContext("sam", "self", discourse)
    said = [_plain(each) for each in offers.meanings(tokens, context)]
    if any(each in right for each in said):
        return Loss(text, "offered", "")
    mentions = offers.mentions(tokens, context.discourse)
    is_slip = bool(said) and bool(offers.of_corrected(mentions.tokens, context))
    at, detail = ("another: typing slips" if is_slip else ""), ""
    if not at and not offers.is_text(tokens):
        at = "too long, or no words"
    if not at:
        at, detail = _in_ranking(offers, mentions, context, right)
    return Loss(text, at, f"{detail} wanted {right[0]} offered {said}")


def _in_ranking(
    offers: OfferFinder, mentions: Mentions, context: UtteranceContext, right: Sequence[Json]
) -> tuple[str, str]:
    """Where a right candidate is lost, and its probability after that of the likeliest."""
    some = candidates(mentions, offers.model.shapes, offers.tool_acts)
    if not any(each.meaning in right for each in some):
        shape = shape_of(right[0], mentions, offers.tool_acts)
        missing = "filling" if shape in offers.model.shapes else "shape"
        return f"no candidate: {missing}", shape.text
    ranked = offers.ranked(mentions)
    place = next((n for n, (_, each) in enumerate(ranked) if each.meaning in right), None)
    if place is None:
        return "ranked too low", ""
    (chance, candidate), (greatest, first) = ranked[place], ranked[0]
    detail = f"{chance:.2f} after {greatest:.2f} {first.meaning}"
    reason = offers.rejected(candidate, mentions, context)
    if reason:
        return f"rejected: {reason}", detail
    ahead = [each for _, each in ranked[:place] if not offers.rejected(each, mentions, context)]
    return ("behind others" if len(ahead) >= MAX_CHOICES else "below the threshold"), detail


def _plain(meaning: Meaning) -> Json:
    return json.loads(json.dumps(meaning.as_json()))


if __name__ == "__main__":
    main()
