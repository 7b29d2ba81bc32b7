# SPDX-License-Identifier: Apache-2.0
"""Reader of the frames of a language, from its `frames.yaml`."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import reduce
from pathlib import Path
from types import MappingProxyType

from ...ontology.yaml_reader import Field, read_yaml
from ..grammar.constructions import Gap, pieces_of
from ..grammar.grammar import Grammar
from ..grammar.notation import read_category, read_entry
from ..grammar.patterns import Steps, spellings, steps_of, words_in, words_of
from ..grammar.terms import bind, evaluate
from .frames import Fillers, Frame, Frames, Kind, Phrase


def load_frames(path: Path, grammar: Grammar) -> Frames:
    """Read the frames of a language.

    Raises:
        DataError: the file is not as expected; says where.
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
        name: frozenset(_phrases(parts[name])) if name in parts else frozenset[Phrase]()
        for name in ("inverted", "inverting", "asking")
    }
    denials = _fillers(parts["denials"].entries())
    kinds = {kind for group in (denials, *fillers.values()) for kind in group.kinds}
    kinds |= {kind.name for slot in slots.values() for kind in slot}
    follows = _sets(parts["follows"], kinds | {"start", "end", "DG", "NP"})
    return Frames(
        tuple(_frame(field, grammar, fillers, slots) for field in parts["frames"].items()),
        fillers=MappingProxyType(fillers),
        barred=_fillers({"": parts["barred"]}),
        denials=denials,
        openers=frozenset(parts["openers"].texts()),
        follows=follows,
        needs=_sets(parts["needs"], kinds | {"clause", "pause", "DG", "NP"}),
        degree=parts["degree"].text(choices=tuple(grammar.signature)),
        **sets,
    )


def _sets(field: Field, known: Collection[str]) -> Mapping[str, frozenset[str]]:
    """The kinds that belong to each kind, all of them known."""
    found: dict[str, frozenset[str]] = {}
    for kind, others in field.entries().items():
        if kind not in known:
            raise others.fail(f'there is no kind "{kind}"; expected one of {sorted(known)}.')
        found[kind] = frozenset(each.text(choices=known) for each in others.items())
    return MappingProxyType(found)


def _phrases(field: Field) -> Iterator[Phrase]:
    for each in field.items():
        yield from spellings(each)


def _fillers(kinds: Mapping[str, Field]) -> Fillers:
    """The phrases of a group, which stand there by the kind of word."""
    steps: dict[str, Steps] = {}
    words: set[str] = set()
    for number, phrases in enumerate(kinds.values()):
        for says in phrases.items():
            text = words_in(says)
            words.update(words_of(text))
            for step in steps_of(text, number):
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
    taken = tuple(_slot(gap, slots) for gap in gaps)
    line = parts["is"]
    category, term, cost = read_entry(line)
    # Whatever may fill a slot must fit.
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


def _slot(gap: Gap, slots: Mapping[str, tuple[Kind, ...]]) -> tuple[Kind, ...]:
    name = str(gap.category)
    return slots.get(name, (Kind(name, gap.category),))


def _gaps(field: Field) -> list[Gap]:
    found = pieces_of(field.text().split(), field)
    gaps = [piece for piece in found if isinstance(piece, Gap) and piece.name]
    if not gaps or len(gaps) < len(found):
        raise field.fail('expected nothing but gaps with names, like "{x:NP} {a:USE}".')
    return gaps
