# SPDX-License-Identifier: Apache-2.0
"""Episodes: how the robot carried out a command, step by step, and by which rules.

The graph `episodes` has the facts that queries ask for (goal, outcome, which rules decided what at
which node); the complete record, as `hilt do --json` prints it, is stored beside them as one text.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from decimal import Decimal
from typing import cast

from ..ontology.vocabulary import Iri, external, iri, split, term
from .history import ANSWER, TEXT, utterance_iri
from .interval import Interval
from .rdf.rule_mapping import (
    ATTRIBUTED_TO,
    FEATURE,
    GENERATED_AT,
    LOWER,
    PART,
    TYPE,
    UPPER,
    atom_from_iri,
    atom_iri,
    rule_id,
    rule_iri,
)
from .rdf.terms import Quad, Term
from .rule import Atom
from .stores.base import Store

EPISODES = iri("graph", "episodes")

GOAL, SEED, OUTCOME, DOCUMENT = (term(n) for n in ("goal", "seed", "outcome", "document"))
ABOUT, STEP, INDEX, PATH = (term(n) for n in ("about", "step", "index", "path"))
OBJECT, USED = term("chosenObject"), external("prov:used")
TOUCHED, LIFTED, HANDED_OVER = (term(n) for n in ("touched", "lifted", "handedOver"))


@dataclass(frozen=True)
class EpisodeStep:
    """The decision at one node of the action tree.

    Attributes:
        path: path of the node, as "pass/graspObject".
        features: the features that were searched for.
        object: the object chosen; None where none was.
        part: the part chosen; None where none was.
        interval: interval of the conclusion; None where nothing was concluded.
        rules: ids of the rules that support it.
    """

    path: str
    features: tuple[Atom, ...] = ()
    object: str | None = None
    part: str | None = None
    interval: Interval | None = None
    rules: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Episode:
    """The execution of one command.

    Attributes:
        goal: in predicate form.
        text: the command as it was said.
        speaker: who said it.
        outcome: done, failed, asked, refused or not_understood.
        said: the answer.
        seed: the seed of all random choices.
        document: the complete record as JSON.
        object: the object that was chosen; None where none was.
        part: the part that was chosen; None where none was.
        rules: ids of the rules that decided.
        steps: the decisions at the nodes, in order of execution.
        touched: the parts that the fingers touched.
        lifted_m: height the object was lifted [m]; None without a simulation.
        handed_over: whether it was still held at the hand-over; None without a simulation.
        utterance: number of the utterance it answers; None until it is recorded.
        id: unique in the base; empty until it is recorded.
        time: when it was recorded, with its time zone; None before.
    """

    goal: str
    text: str
    speaker: str
    outcome: str
    said: str
    seed: int
    document: str
    object: str | None = None
    part: str | None = None
    rules: tuple[str, ...] = ()
    steps: tuple[EpisodeStep, ...] = ()
    touched: tuple[str, ...] = ()
    lifted_m: float | None = None
    handed_over: bool | None = None
    utterance: int | None = None
    id: str = ""
    time: datetime | None = None


def episode_quads(episode: Episode) -> Iterator[Quad]:
    """The statements about a recorded episode and its steps."""
    node = iri("episode", episode.id)
    for predicate, value in _episode_properties(episode):
        yield Quad(node, predicate, value, EPISODES)
    for index, step in enumerate(episode.steps):
        yield Quad(node, STEP, _step_iri(episode.id, index), EPISODES)
        for predicate, value in _step_properties(index, step):
            yield Quad(_step_iri(episode.id, index), predicate, value, EPISODES)


def read_episodes(store: Store) -> Iterator[Episode]:
    """All episodes of a store, the oldest first."""
    found = {quad.subject for quad in store.quads(None, TYPE, term("Episode"), EPISODES)}
    yield from sorted(
        (_read(store, node) for node in found), key=lambda one: (one.utterance or 0, one.id)
    )


def _episode_properties(episode: Episode) -> Iterator[tuple[Iri, Term]]:
    yield TYPE, term("Episode")
    yield GOAL, episode.goal
    yield TEXT, episode.text
    yield ATTRIBUTED_TO, iri("speaker", episode.speaker)
    yield OUTCOME, episode.outcome
    yield ANSWER, episode.said
    yield SEED, episode.seed
    yield DOCUMENT, episode.document
    yield from _choice_properties(episode.object, episode.part)
    for one in episode.rules:
        yield USED, rule_iri(one)
    yield from _outcome_properties(episode)
    if episode.utterance is not None:
        yield ABOUT, utterance_iri(episode.utterance)
    if episode.time is not None:
        yield GENERATED_AT, episode.time


def _outcome_properties(episode: Episode) -> Iterator[tuple[Iri, Term]]:
    for part in episode.touched:
        yield TOUCHED, atom_iri(Atom("part", part))
    if episode.lifted_m is not None:
        yield LIFTED, Decimal(str(round(episode.lifted_m, 6)))
    if episode.handed_over is not None:
        yield HANDED_OVER, episode.handed_over


def _choice_properties(name: str | None, part: str | None) -> Iterator[tuple[Iri, Term]]:
    if name is not None:
        yield OBJECT, atom_iri(Atom("object", name))
    if part is not None:
        yield PART, atom_iri(Atom("part", part))


def _read(store: Store, node: Iri) -> Episode:
    found = _properties(store, node)
    steps = [_properties(store, cast(Iri, step)) for step in found[STEP]]
    return Episode(
        goal=_text(found[GOAL]),
        text=_text(found[TEXT]),
        speaker=_name(found[ATTRIBUTED_TO]) or "",
        outcome=_text(found[OUTCOME]),
        said=_text(found[ANSWER]),
        seed=cast(int, found[SEED][0]),
        document=_text(found[DOCUMENT]),
        object=_name(found[OBJECT]),
        part=_name(found[PART]),
        rules=_rule_ids(found[USED]),
        steps=tuple(_read_step(step) for step in sorted(steps, key=_index)),
        touched=tuple(sorted(split(cast(Iri, part))[1] for part in found[TOUCHED])),
        lifted_m=float(cast(Decimal, found[LIFTED][0])) if found[LIFTED] else None,
        handed_over=cast(bool, found[HANDED_OVER][0]) if found[HANDED_OVER] else None,
        utterance=int(_name(found[ABOUT]) or 0) or None,
        id=split(node)[1],
        time=cast(datetime, found[GENERATED_AT][0]),
    )


def _text(values: list[Term]) -> str:
    return cast(str, values[0])


def _rule_ids(nodes: list[Term]) -> tuple[str, ...]:
    return tuple(sorted(rule_id(cast(Iri, node)) for node in nodes))


def _index(step: dict[Iri, list[Term]]) -> int:
    return cast(int, step[INDEX][0])


def _properties(store: Store, node: Iri) -> dict[Iri, list[Term]]:
    found: dict[Iri, list[Term]] = defaultdict(list)
    for predicate, value in store.properties(node, EPISODES):
        found[predicate].append(value)
    return found


def _step_properties(index: int, step: EpisodeStep) -> Iterator[tuple[Iri, Term]]:
    yield TYPE, term("Step")
    yield INDEX, index
    yield PATH, step.path
    for feature in step.features:
        yield FEATURE, atom_iri(feature)
    yield from _choice_properties(step.object, step.part)
    if step.interval is not None:
        yield LOWER, Decimal(str(step.interval.rounded().lower))
        yield UPPER, Decimal(str(step.interval.rounded().upper))
    for one in step.rules:
        yield USED, rule_iri(one)


def _read_step(found: dict[Iri, list[Term]]) -> EpisodeStep:
    bounds = [cast(float, found[key][0]) for key in (LOWER, UPPER) if found[key]]
    return EpisodeStep(
        _text(found[PATH]),
        tuple(sorted(atom_from_iri(cast(Iri, node)) for node in found[FEATURE])),
        _name(found[OBJECT]),
        _name(found[PART]),
        Interval(*bounds) if bounds else None,
        _rule_ids(found[USED]),
    )


def _name(nodes: list[Term]) -> str | None:
    return split(cast(Iri, nodes[0]))[1] if nodes else None


def _step_iri(episode: str, index: int) -> Iri:
    return iri("step", f"{episode}.{index}")
