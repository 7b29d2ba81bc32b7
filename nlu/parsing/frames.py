# SPDX-License-Identifier: Apache-2.0
"""Frames: the meaning of objects, uses and degrees in any order, read from `frames.yaml`.

"Poking, that is something a screwdriver does sometimes" names an object, a use and a degree. The
chart has the category of each span; a frame says that an object and a use make a rule. Every other
word must be listed as a filler of that frame, so that no word is dropped: a word that is not
listed, such as "only", "than" or "said", blocks the frame. After frame semantics (Fillmore 1982)
and categories that take a set of arguments (Hoffman 1995).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from ...ontology.yaml_reader import Field, read_yaml
from ..grammar.categories import Category
from ..grammar.constructions import Gap, pieces_of
from ..grammar.grammar import Grammar
from ..grammar.notation import read_category, read_entry
from ..grammar.patterns import (
    Steps,
    compile_pattern,
    match_pattern,
    read_words,
    spellings,
    words_of,
)
from ..grammar.terms import Value, bind, evaluate
from ..lexicon.tokenizer import Tokens

Phrase = tuple[str, ...]


class Kind(NamedTuple):
    """One kind of slot value: its name in the tables of neighbours, and its category."""

    name: str
    category: Category


@dataclass(frozen=True)
class Fillers:
    """A group of filler phrases, which add nothing to the meaning of a frame.

    Attributes:
        steps: the graph of the phrases by their first word, `*` for any; the number at an end is
            the index of the kind of word.
    """

    kinds: tuple[str, ...]
    steps: Mapping[str, Steps]
    words: frozenset[str]

    def match(self, words: Sequence[str], place: int) -> frozenset[tuple[str, int]]:
        """Return the kind and the end of each phrase that matches from a position on."""
        steps = (*self.steps.get(words[place], ()), *self.steps.get("*", ()))
        found = match_pattern(steps, words, place)
        return frozenset((self.kinds[kind], end) for kind, end in found)


@dataclass(frozen=True)
class Frame:
    """Slots that have a meaning together, in any order.

    Attributes:
        fillers: the names of the filler groups that may stand between the slots.
        cues: those groups of which one phrase is required.
        result: the category of the utterance; a rule takes a degree as well.
        value: the function from the meanings of the slots, in their order, to the meaning.
        joins: whether it may span several sentences.
    """

    slots: tuple[tuple[Kind, ...], ...]
    fillers: tuple[str, ...]
    cues: frozenset[str]
    result: Category
    value: Value
    cost: float
    joins: bool


@dataclass(frozen=True)
class Frames:
    """The frames of a language, and the groups of filler phrases by name.

    Attributes:
        denials: phrases that say "never", by their kind.
        barred: phrases that block every frame.
        inverted: phrases that make a question when they come first.
        inverting: degrees after which subject and verb are inverted without a question.
        asking: words that make a question wherever they stand.
        openers: the filler groups that begin a question without a question mark.
        follows: the kinds that may follow each kind, also at the start and the end of a clause.
        needs: the kinds of which one must precede a kind; a rule needs those of `clause`.
        degree: the degree of a rule when none was said.
    """

    frames: tuple[Frame, ...]
    fillers: Mapping[str, Fillers]
    denials: Fillers
    barred: Fillers
    inverted: frozenset[Phrase]
    inverting: frozenset[Phrase]
    asking: frozenset[Phrase]
    openers: frozenset[str]
    follows: Mapping[str, frozenset[str]]
    needs: Mapping[str, frozenset[str]]
    degree: str

    @cached_property
    def needed(self) -> frozenset[str]:
        """All kinds that are needed before another kind or in a clause."""
        return frozenset[str]().union(*self.needs.values())

    @cached_property
    def categories(self) -> frozenset[Category]:
        """The categories of all slot values."""
        slots = (slot for frame in self.frames for slot in frame.slots)
        return frozenset(kind.category for slot in slots for kind in slot)

    @cached_property
    def words(self) -> frozenset[str]:
        """All words of all fillers and denials."""
        groups = (self.denials, *self.fillers.values())
        return frozenset[str]().union(*(group.words for group in groups))

    def may_follow(self, kind: str, last: str) -> bool:
        """Whether one kind may directly follow another one."""
        return kind in self.follows.get(last, frozenset())

    def is_barred(self, tokens: Tokens) -> bool:
        """Whether an utterance has a phrase that blocks every frame."""
        return any(self.barred.match(tokens.words, place) for place in range(len(tokens.items)))


def load_frames(path: Path, grammar: Grammar) -> Frames:
    """Return the frames of a language from its file.

    Raises:
        DataError: the file is invalid; has line and column.
    """
    parts = read_yaml(path).entries(
        required=(
            "fillers",
            "barred",
            "denials",
            "slots",
            "frames",
            "degree",
            "openers",
            "follows",
            "needs",
        ),
        optional=("inverted", "inverting", "asking"),
    )
    groups = {name: group.entries() for name, group in parts["fillers"].entries().items()}
    fillers = {name: _fillers(group) for name, group in groups.items()}
    slots = {name: tuple(_kinds(field)) for name, field in parts["slots"].entries().items()}
    sets = {
        name: frozenset(phrase for item in parts[name].items() for phrase in spellings(item))
        if name in parts
        else frozenset[Phrase]()
        for name in ("inverted", "inverting", "asking")
    }
    denials = _fillers(parts["denials"].entries())
    kinds = {kind for group in (denials, *fillers.values()) for kind in group.kinds}
    kinds |= {kind.name for slot in slots.values() for kind in slot}
    return Frames(
        tuple(_frame(field, grammar, fillers, slots) for field in parts["frames"].items()),
        fillers=MappingProxyType(fillers),
        barred=_fillers({"": parts["barred"]}),
        denials=denials,
        openers=frozenset(parts["openers"].texts()),
        follows=_sets(parts["follows"], kinds | {"start", "end", "DG", "NP"}),
        needs=_sets(parts["needs"], kinds | {"clause", "pause", "DG", "NP"}),
        degree=parts["degree"].text(choices=tuple(grammar.signature)),
        **sets,
    )


def _sets(field: Field, known: Collection[str]) -> Mapping[str, frozenset[str]]:
    """Return the table of kinds, checked against the known ones."""
    found: dict[str, frozenset[str]] = {}
    for kind, others in field.entries().items():
        if kind not in known:
            raise others.fail(f'there is no kind "{kind}"; expected one of {sorted(known)}.')
        found[kind] = frozenset(each.text(choices=known) for each in others.items())
    return MappingProxyType(found)


def _fillers(kinds: Mapping[str, Field]) -> Fillers:
    steps: dict[str, Steps] = {}
    words: set[str] = set()
    for number, phrases in enumerate(kinds.values()):
        for says in phrases.items():
            text = read_words(says)
            words.update(words_of(text))
            for step in compile_pattern(text, number):
                if not isinstance(step, int):
                    steps[step[0]] = (*steps.get(step[0], ()), step)
    return Fillers(tuple(kinds), MappingProxyType(steps), frozenset(words))


def _kinds(field: Field) -> Iterator[Kind]:
    for name, categories in field.entries().items():
        for item in categories.items():
            yield Kind(name, read_category(item))


def _frame(
    field: Field,
    grammar: Grammar,
    fillers: Mapping[str, Fillers],
    slots: Mapping[str, tuple[Kind, ...]],
) -> Frame:
    parts = field.entries(required=("takes", "with", "is"), optional=("cues", "joins"))
    gaps = _gaps(parts["takes"])
    taken = tuple(
        slots.get(str(gap.category), (Kind(str(gap.category), gap.category),)) for gap in gaps
    )
    line = parts["is"]
    category, term, cost = read_entry(line)
    # The term must be well typed for every kind of slot value.
    for index in range(max(map(len, taken))):
        each = zip(gaps, taken, strict=True)
        chosen = [Gap(gap.name, kinds[index % len(kinds)].category) for gap, kinds in each]
        grammar.verify(category, term, line, grammar.types_of(chosen, line))
    names = [item.text(choices=tuple(fillers)) for item in parts["with"].items()]
    wanted = parts["cues"].items() if "cues" in parts else ()
    cues = [item.text(choices=tuple(fillers)) for item in wanted]
    return Frame(
        taken,
        (*names, *cues),
        frozenset(cues),
        category,
        evaluate(reduce(bind, (gap.name for gap in reversed(gaps)), term)),
        cost,
        "joins" not in parts or parts["joins"].text(choices=("yes", "no")) == "yes",
    )


def _gaps(field: Field) -> list[Gap]:
    found = pieces_of(field.text().split(), field)
    gaps = [piece for piece in found if isinstance(piece, Gap) and piece.name]
    if not gaps or len(gaps) < len(found):
        raise field.fail('expected nothing but gaps with names, like "{x:NP} {a:USE}".')
    return gaps
