"""The utterances that the repository has: its test data, what Hilt generates, and its documents."""

from __future__ import annotations

import ast
import json
import random
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import yaml

from hilt.nlu import Language, Session, Understanding
from hilt.nlu.jsgf import sentences

ROOT = Path(__file__).parents[1]
DATA = ROOT / "tests" / "nlu" / "data"

NEAR = ("paper", "paraphrases", "commands", "conversation")
GROUPED = (
    *NEAR, "frames", "constructions", "kinds", "materials", "attitudes", "new_words",
    "wide", "aside", "far",
)  # fmt: skip
SENTENCES = 3000
"""How many sentences of the generated grammar are drawn."""

_QUOTED = re.compile(r'"([^"\n]{6,120})"|`([^`\n]{6,120})`')
_SPOKEN = re.compile(r"^[A-Za-z][A-Za-z ,.'?!-]+$")
_BEFORE = ("To pass a knife, grab it by the blade",)


class Utterance(NamedTuple):
    """A text with what was said before, and what it must mean.

    Attributes:
        wanted: the meaning, a part of it, or several under `any_of`; None is a refusal, and
            `{"understood": True}` any belief, goal, question or reply.
        source: the data set that it is from.
    """

    text: str
    before: tuple[str, ...]
    wanted: dict[str, object] | None
    source: str

    def hear(self, session: Session) -> Understanding:
        """The understanding of the text at its place in a conversation."""
        return session.after(self.before).hear(self.text)[0]

    def outcome(self, understood: Understanding) -> str:
        """`right`, `open` for a question back or a failure, else `wrong`."""
        found = json.loads(json.dumps(understood.meaning.as_json()))
        if _fits(found, self.wanted):
            return "right"
        return "open" if _is_open(found) else "wrong"


def data_sets() -> dict[str, list[Utterance]]:
    """All utterances of the test data, by file."""
    found = {name: list(_grouped(name)) for name in GROUPED}
    found |= {path.stem: list(_lines(path)) for path in sorted(DATA.glob("*.jsonl"))}
    refusals = yaml.safe_load((DATA / "refusals.yaml").read_text(encoding="utf-8"))
    found["refusals"] = [Utterance(text, (), None, "refusals") for text in refusals]
    families = yaml.safe_load((DATA / "unsaid.yaml").read_text(encoding="utf-8")).values()
    for name, wanted in (("unsaid", None), ("said", {"understood": True})):
        given = [each for family in families for each in family.get(name) or ()]
        texts = [each if isinstance(each, str) else each[0] for each in given]
        found[name] = [Utterance(text, (), wanted, name) for text in texts]
    found["paradigm"] = list(paradigm())
    return found


def paradigm() -> Iterator[Utterance]:
    """Every verb of the paradigm in every form."""
    data = yaml.safe_load((DATA / "paradigm.yaml").read_text(encoding="utf-8"))
    for verb in data["verbs"]:
        for _, means, says in data["forms"][verb["kind"]]:
            wanted = _filled(data["meanings"][verb["kind"]][means], verb)
            yield Utterance(says.format(**verb), (), wanted, "paradigm")


def generated(language: Language) -> Iterator[Utterance]:
    """Sentences that the grammar for speech recognisers has, with every shape of meaning."""
    for text in sentences(language, SENTENCES, random.Random(0)):  # noqa: S311 - no secret
        yield Utterance(text, _BEFORE, {"understood": True}, "generated")


def dialogues() -> Iterator[Utterance]:
    """Every turn of the dialogues of the tests after the turns before it."""
    discourse = yaml.safe_load((DATA / "discourse.yaml").read_text(encoding="utf-8"))
    answered = ROOT / "tests" / "agent" / "data" / "dialogues.yaml"
    conversations = yaml.safe_load(answered.read_text(encoding="utf-8")).values()
    for turns in [*(each["turns"] for each in discourse), *conversations]:
        said = [turn["say"] for turn in turns]
        for place, text in enumerate(said):
            yield Utterance(text, tuple(said[:place]), {"understood": True}, "dialogues")


def documented() -> Iterator[Utterance]:
    """Whatever reads like an utterance in documents, examples and the code of the tests."""
    examples = (ROOT / "ontology" / "english" / "examples.yaml").read_text(encoding="utf-8")
    conversations = [[text] for text in yaml.safe_load(examples)["examples"]]
    for path in [*sorted(ROOT.glob("docs/**/*.md")), ROOT / "README.md"]:
        quoted = _QUOTED.finditer(path.read_text(encoding="utf-8"))
        conversations += [[found[1] or found[2]] for found in quoted]
    for folder in ("tests", "agent", "examples", "benchmarks"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            conversations += _written(path)
    said: set[tuple[str, ...]] = set()
    for texts in conversations:
        spoken = [text for text in texts if _SPOKEN.match(text) and 2 <= len(text.split()) <= 25]
        for place, text in enumerate(spoken):
            for before in {tuple(spoken[max(0, place - 3) : place]), _BEFORE}:
                if (*before, text) not in said:
                    said.add((*before, text))
                    yield Utterance(text, before, {"understood": True}, "documented")


def _written(path: Path) -> Iterator[list[str]]:
    """The texts of each function of a module, in order, and all others each on its own."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        texts = [
            each.value
            for each in ast.walk(node)
            if isinstance(each, ast.Constant) and isinstance(each.value, str)
        ]
        if isinstance(node, ast.FunctionDef):
            yield texts
        else:
            yield from ([text] for text in texts)


def _grouped(name: str) -> Iterator[Utterance]:
    for group in yaml.safe_load((DATA / f"{name}.yaml").read_text(encoding="utf-8")):
        wanted = group.get("meaning") or {"includes": group["check"]}
        before = (group["before"],) if "before" in group else ()
        for text in group["texts"]:
            yield Utterance(text, before, wanted, name)


def _lines(path: Path) -> Iterator[Utterance]:
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.strip():
            each = json.loads(line)
            yield Utterance(
                each["text"], tuple(each.get("before") or ()), each["meaning"], path.stem
            )


def _filled(value: object, verb: dict[str, str]) -> object:
    if isinstance(value, str):
        return value.format(**verb)
    if isinstance(value, dict):
        return {key: _filled(each, verb) for key, each in value.items()}
    return value


def _is_open(found: dict[str, object]) -> bool:
    return bool(found.get("error") or found.get("ask_back") or found.get("note"))


def _fits(found: dict[str, object], wanted: dict[str, object] | None) -> bool:
    if wanted is None:
        return _is_open(found) or bool(found.get("negated"))
    if "any_of" in wanted:
        options = wanted["any_of"]
        assert isinstance(options, list)
        return any(_fits(found, each) for each in options)
    if "understood" in wanted:
        return not _is_open(found)
    if "includes" in wanted:
        part = wanted["includes"]
        assert isinstance(part, dict)
        return part.items() <= found.items()
    if wanted.get("error") or wanted.get("ask_back"):
        return _is_open(found)
    return found == wanted
