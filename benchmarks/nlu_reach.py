"""What each file of the English data is worth: reach and wrong meanings without it.

Every data set is understood with all files, and once more with each word file left out. The table
has for each the kB of English data, the share of utterances that are right at once, and how many
are understood wrongly; a refusal is right where one is wanted. Run it as

    python benchmarks/nlu_reach.py [--sets NAME ...] [--json]
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

from rich.console import Console
from rich.progress import track
from rich.table import Table
from utterances import NEAR, Utterance, data_sets

from hilt.nlu import Language, Session
from hilt.nlu import language as loader
from hilt.ontology.errors import HiltError

ENGLISH = loader.LANGUAGES_FOLDER / "english"
LEFT_OUT = ("clauses.yaml", "constructions.yaml", "requests.yaml", "conversation.yaml")
GROUPS = {
    "near": NEAR,
    "paradigm": ("paradigm",),
    "far": ("far", "far_voices", "blind_far", "blind_last", "blind_people"),
    "refused": ("refusals", "blind_refusals", "near_misses", "unsaid"),
}
EMPTY = "constructions: []\n"
FOLDERS: list[TemporaryDirectory[str]] = []  # a language reads some files when it needs them


def language_without(name: str | None) -> Language | None:
    """English without one of its word files, None when it cannot be loaded without it."""
    if name is None:
        return Language.load()
    folder = TemporaryDirectory()
    FOLDERS.append(folder)
    copy = Path(folder.name) / "english"
    copy.mkdir()
    for path in ENGLISH.iterdir():
        text = EMPTY if path.name == name else path.read_text(encoding="utf-8")
        (copy / path.name).write_text(text, encoding="utf-8")
    with patch.object(loader, "LANGUAGES_FOLDER", copy.parent):
        try:
            return Language.load()
        except HiltError:
            return None


def kilobytes(without: str | None) -> float:
    """The size of the English data that is read [kB]."""
    return sum(p.stat().st_size for p in ENGLISH.iterdir() if p.name != without) / 1000


def outcomes(language: Language, utterances: Collection[Utterance]) -> Counter[str]:
    """How many utterances are right, open and wrong."""
    session = Session(language)
    return Counter(each.outcome(each.hear(session)) for each in utterances)


def rows(groups: dict[str, list[Utterance]]) -> Iterator[dict[str, object]]:
    """One row for all files, and one for each file left out."""
    steps = [(name, group) for name in (None, *LEFT_OUT) for group in groups]
    row: dict[str, object] = {}
    language: Language | None = None
    for name, group in track(steps, "data sets", console=Console(stderr=True)):
        if group == next(iter(groups)):
            language = language_without(name)
            row = {"without": name or "", "kB": round(kilobytes(name), 1)}
        if language is not None:
            found = outcomes(language, groups[group])
            row[group] = round(found["right"] / len(groups[group]), 4)
            row[f"{group} wrong"] = found["wrong"]
        if group == [*groups][-1]:
            yield row


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--sets", nargs="*", default=[*GROUPS], choices=[*GROUPS])
    parser.add_argument("--json", action="store_true", help="one JSON document")
    options = parser.parse_args()
    sets = data_sets()
    groups = {name: [each for key in GROUPS[name] for each in sets[key]] for name in options.sets}
    found = list(rows(groups))
    if options.json:
        print(json.dumps(found, indent=1))
        return
    table = Table(*found[0])
    for row in found:
        table.add_row(*(str(row.get(column, "")) for column in found[0]))
    Console().print(table)


if __name__ == "__main__":
    main()
