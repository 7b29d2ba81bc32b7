"""Episodes: how the robot carried out a command, step by step, and by which rules.

The graph `episodes` has the facts that queries ask for (goal, outcome, which rules decided what at
which node, what each grasp came to); the complete record, as `hilt do --json` prints it, is stored
beside them as one text. Experience is counted from the grasp trials, which are stored nowhere else.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby
from numbers import Number
from typing import Annotated, cast

from ..ontology.vocabulary import Iri, external, iri, term
from .history import ANSWER, SPEAKER, TEXT, rules_property, utterance_property
from .interval import Interval
from .rdf import record_mapping, rule_mapping
from .rdf.record_mapping import FieldProperty, RecordMapping, group_pairs, local_name
from .rdf.rule_mapping import DERIVED, LOWER, TYPE, UPPER, atom_from_iri, atom_iri, decimal
from .rdf.terms import Quad, Term
from .rule import Atom
from .stores.base import ReadableStore, Store

EPISODES = iri("graph", "episodes")

STEP, INDEX, TRIAL = term("step"), term("index"), term("trial")
FORGOTTEN_BY = term("forgottenBy")
HELD = "held"

_OBJECT, _USED = term("chosenObject"), rules_property(external("prov:used"))
_FEATURES = FieldProperty(rule_mapping.FEATURE, Iri, atom_iri, atom_from_iri, ())
_OUTCOME = FieldProperty(term("outcome"), str)
_LIFTED = FieldProperty(term("lifted"), Number, decimal, float, None)
_HANDED_OVER = FieldProperty(term("handedOver"), bool, default=None)
_RECORDED = FieldProperty(rule_mapping.GENERATED_AT, datetime, default=None)


def _name(predicate: Iri, kind: str, default: object = record_mapping.REQUIRED) -> FieldProperty:
    return FieldProperty(predicate, Iri, lambda n: atom_iri(Atom(kind, n)), local_name, default)


@dataclass(frozen=True)
class EpisodeStep:
    """The decision at one node of the action tree."""

    #: path of the node, as "pass/graspObject"
    path: Annotated[str, FieldProperty(term("path"), str)]
    features: Annotated[tuple[Atom, ...], _FEATURES] = ()  #: the features that were searched for
    #: object, part: the object and the part chosen; None where none was
    object: Annotated[str | None, _name(_OBJECT, "object", None)] = None
    part: Annotated[str | None, _name(rule_mapping.PART, "part", None)] = None
    #: interval of the conclusion; None where nothing was concluded
    interval: Interval | None = None
    rules: Annotated[tuple[str, ...], _USED] = ()  #: ids of the rules that support it


@dataclass(frozen=True)
class GraspTrial:
    """One closing of the gripper, and what came of it."""

    object: Annotated[str, _name(_OBJECT, "object")]  #: the kind of object
    part: Annotated[str, _name(rule_mapping.PART, "part")]  #: the part by which it was to be held
    #: the action that it was grasped for ("pass")
    context: Annotated[str, _name(rule_mapping.CONTEXT, "action")]
    #: held; slipped while it was lifted; dropped later; the wrong part or nothing (missed) between
    #: the fingers; or refused at the hand-over
    outcome: Annotated[str, _OUTCOME]
    robot: Annotated[str, FieldProperty(term("robot"), str)] = ""  #: the robot that did it
    #: number of the utterance that made it be forgotten; None while it counts
    forgotten_by: Annotated[int | None, utterance_property(FORGOTTEN_BY, None)] = None


@dataclass(frozen=True, kw_only=True)
class Episode:
    """The execution of one command."""

    goal: Annotated[str, FieldProperty(term("goal"), str)]  #: in predicate form
    text: Annotated[str, FieldProperty(TEXT, str)]  #: the command as it was said
    speaker: Annotated[str, SPEAKER]  #: who said it
    outcome: Annotated[str, _OUTCOME]  #: done, failed, asked, refused or not_understood
    said: Annotated[str, FieldProperty(ANSWER, str)]  #: the answer
    seed: Annotated[int, FieldProperty(term("seed"), int)]  #: the seed of all random choices
    document: Annotated[str, FieldProperty(term("document"), str)]  #: the complete record as JSON
    #: object, part: the object and the part that were chosen; None where none was
    object: Annotated[str | None, _name(_OBJECT, "object", None)] = None
    part: Annotated[str | None, _name(rule_mapping.PART, "part", None)] = None
    rules: Annotated[tuple[str, ...], _USED] = ()  #: ids of the rules that decided
    steps: tuple[EpisodeStep, ...] = ()  #: the decisions at the nodes, in order of execution
    trials: tuple[GraspTrial, ...] = ()  #: what each grasp came to, in order
    #: the parts that the fingers touched
    touched: Annotated[tuple[str, ...], _name(term("touched"), "part", ())] = ()
    #: height the object was lifted [m]; None without a simulation
    lifted_m: Annotated[float | None, _LIFTED] = None
    #: whether it was still held at the hand-over; None without a simulation
    handed_over: Annotated[bool | None, _HANDED_OVER] = None
    #: where the joints of the robot were, packed by `sim/robot/trajectory.py`
    trajectory: Annotated[str | None, FieldProperty(term("trajectory"), str, default=None)] = None
    #: number of the utterance it answers; None until it is recorded
    utterance: Annotated[int | None, utterance_property(term("about"), None)] = None
    id: str = ""  #: unique in the base; empty until it is recorded
    #: when it was recorded, with its time zone; None before
    time: Annotated[datetime | None, _RECORDED] = None


def episode_quads(episode: Episode) -> Iterator[Quad]:
    """The statements about a recorded episode, its steps and its grasp trials, and what follows."""
    node = iri("episode", episode.id)
    stored = [*_EPISODES.quads(node, episode)]
    for index, step in enumerate(episode.steps):
        place = iri("step", f"{episode.id}.{index}")
        stored += (Quad(node, STEP, place, EPISODES), Quad(place, INDEX, index, EPISODES))
        stored += _STEPS.quads(place, step)
        if step.interval is not None:
            bounds = ((LOWER, step.interval.lower), (UPPER, step.interval.upper))
            stored += (Quad(place, key, decimal(bound), EPISODES) for key, bound in bounds)
    for index, trial in enumerate(episode.trials):
        place = iri("trial", f"{episode.id}.{index}")
        stored += (Quad(node, TRIAL, place, EPISODES), Quad(place, INDEX, index, EPISODES))
        stored += _TRIALS.quads(place, trial)
    yield from stored
    for about, some in groupby(sorted(stored), key=lambda quad: quad.subject):
        yield from observation_quads(about, [(quad.predicate, quad.object) for quad in some])


def observation_quads(node: Iri, properties: Iterable[tuple[Iri, Term]]) -> Iterator[Quad]:
    """What follows from an episode or a grasp trial with these properties: an observation."""
    found = group_pairs(properties)
    if _TRIALS.type in found[TYPE]:
        yield Quad(node, TYPE, external("sosa:Observation"), DERIVED)
        for stored, key in _OBSERVED.items():
            yield from (Quad(node, key, value, DERIVED) for value in found[stored])
    for trial in found[TRIAL]:
        for time in found[rule_mapping.GENERATED_AT]:
            yield Quad(cast(Iri, trial), external("sosa:resultTime"), time, DERIVED)


def read_episodes(store: Store) -> Iterator[Episode]:
    """All episodes of a store, the oldest first."""
    found = {quad.subject for quad in store.quads(None, TYPE, _EPISODES.type, EPISODES)}
    episodes = (read_episode(store, node) for node in found)
    yield from sorted(episodes, key=lambda one: (one.utterance or 0, one.id))


def trial_nodes(store: Store, of: str | None, part: str | None) -> Iterator[Iri]:
    """The grasp trials that count, with an object `of` this kind and by this part, if given."""
    wanted = ((_TRIALS.fields["object"], of), (_TRIALS.fields["part"], part))
    for quad in store.quads(None, TYPE, _TRIALS.type, EPISODES):
        found = group_pairs(store.properties(quad.subject, EPISODES))
        fits = (name is None or at.encode(name) in found[at.predicate] for at, name in wanted)
        if not found[FORGOTTEN_BY] and all(fits):
            yield quad.subject


def read_episode(store: ReadableStore, node: Iri) -> Episode:
    """The episode of a node; ValidationError or KeyError if something of it is missing."""
    found = group_pairs(store.properties(node, EPISODES))
    trials = tuple(map(_TRIALS.read, _in_order(store, found[TRIAL])))
    steps = list[EpisodeStep]()
    for step in _in_order(store, found[STEP]):
        bounds = [cast(float, step[key][0]) for key in (LOWER, UPPER) if step[key]]
        steps.append(_STEPS.read(step, interval=Interval(*bounds) if bounds else None))
    return _EPISODES.read(found, steps=tuple(steps), trials=trials, id=local_name(node))


def _in_order(store: ReadableStore, nodes: Iterable[Term]) -> list[record_mapping.PropertyValues]:
    found = [group_pairs(store.properties(cast(Iri, node), EPISODES)) for node in nodes]
    return sorted(found, key=lambda each: cast(int, each[INDEX][0]))


_OBSERVED = {
    _OBJECT: external("sosa:hasFeatureOfInterest"),
    _OUTCOME.predicate: external("sosa:hasSimpleResult"),
}
_EPISODES = RecordMapping(Episode, "An episode", term("Episode"), EPISODES)
_STEPS = RecordMapping(EpisodeStep, "A step", term("Step"), EPISODES)
_TRIALS = RecordMapping(GraspTrial, "A trial", term("GraspTrial"), EPISODES)
