"""Norms: whether an act is forbidden, and what must come first.

A norm applies to an act if its action is one of those that the act belongs to, and its features and
other contexts hold. A prohibition, or an obligation that is not met, stands unless a permission
that applies overrides it: of two norms in conflict the more specific one prevails (`node_rules`),
then the one of the more trusted speaker, then the later one.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from ..kb.interval import CERTAIN, EPSILON, VACUOUS, Interval
from ..kb.rule import FORBIDDEN, NORMS, OBLIGED, PERMITTED, Atom, Rule
from .affordance import Affordances
from .node_rules import Specificity
from .proof import Json, Proof, derive
from .taxonomy import Taxonomy

PUT_DOWN = "putDown"  # what empties the hand, which is no action tree


@dataclass(frozen=True)
class Act:
    """What is about to be done with one object."""

    #: the actions that are done, the nearest first: that of a node and those above it
    actions: Sequence[str]
    #: object, part: its type, and the part that it is held by; None where not known yet
    object: str | None = None
    properties: frozenset[str] = frozenset()  #: those that it is known to have
    part: str | None = None
    #: what else holds: places, roles of who receives it, what a tool is used on
    contexts: Mapping[Atom, Interval] = field(default_factory=dict[Atom, Interval])
    #: the acts before this one, in order: action and type of object
    done: Sequence[tuple[str, str]] = ()
    holding: str | None = None  #: the type of the object in the hand, None when it is empty


@dataclass(frozen=True)
class NormConflict:
    """Two norms of which one forbids what the other permits, and why one of them prevails."""

    prevailing: Rule
    overruled: Rule
    reason: str


@dataclass(frozen=True)
class NormVerdict:
    """What the norms say of an act, and the conflicts of norms that were resolved.

    `forbidding` is the norm by which it must not be done, None where it may be, and `proof` derives
    its interval. `unseen` are properties on which it depends and that vision cannot report.
    """

    forbidding: Rule | None = None
    proof: Proof | None = None
    unseen: tuple[str, ...] = ()
    conflicts: tuple[NormConflict, ...] = ()

    @property
    def first(self) -> Atom | None:
        """The action that must come first, if that is what is missing."""
        argument = self.forbidding.argument if self.forbidding else None
        return argument if argument and argument.kind == "action" else None

    def as_json(self) -> Json:
        """Return the verdict as a JSON object."""
        return {
            "rule": self.forbidding.id if self.forbidding else None,
            "conflicts": [
                {"prevails": each.prevailing.id, "over": each.overruled.id, "because": each.reason}
                for each in self.conflicts
            ],
        }


ALLOWED = NormVerdict()


@dataclass(frozen=True)
class NormChecker:
    """Checks acts against norms, which are inherited along the taxonomy of `affordances`.

    `visible` are the properties that vision can report. `momentary` norms hold for now and are in
    no base; those with ids in `unheeded` are not to be heeded now.
    """

    affordances: Affordances
    visible: frozenset[str] = frozenset()
    momentary: Sequence[Rule] = ()
    unheeded: Collection[str] = ()

    def judge(self, act: Act) -> NormVerdict:
        """Return whether an act may be done, and why not."""
        judged = self._judged(act, NORMS)
        against = [rule for rule in judged.applying if judged.is_against(rule)]
        permitting = [rule for rule in judged.applying if rule.functor == PERMITTED]
        conflicts = tuple(
            judged.conflict(rule, one)
            for rule in against
            for one in permitting
            # That something need not come first lifts only the obligation to do just that first.
            if one.argument == rule.argument or not one.argument or one.argument.kind != "action"
        )
        lifted = {each.overruled.id for each in conflicts}
        if not (standing := [rule for rule in against if rule.id not in lifted]):
            return NormVerdict(conflicts=conflicts)
        strongest = max(standing, key=lambda rule: (not judged.unseen(rule), _rank(rule)))
        operators = self.affordances.settings.operators
        premise = derive("and", judged.evidence(strongest), operators)
        told = Proof("told", strongest.support, rule=strongest)
        proof = derive("modus ponens", (premise, told), operators)
        return NormVerdict(strongest, proof, judged.unseen(strongest), conflicts)

    def obliged_parts(self, act: Act) -> list[str]:
        """Return the parts by which alone an act may be done, by the norms in their order."""
        found = self._judged(act, (OBLIGED,)).applying
        return [rule.part for rule in sorted(found, key=_rank, reverse=True) if rule.part]

    def _judged(self, act: Act, functors: Sequence[str]) -> "_JudgedAct":
        taxonomy = self.affordances.taxonomy
        named = (kind for name in act.actions for kind, _ in taxonomy.above(Atom("action", name)))
        actions = tuple(dict.fromkeys(named))
        keys = [f"{action.name}.{functor}" for action in actions for functor in functors]
        known = [*self.affordances.rules_at(keys), *self.momentary]
        heeded = [rule for rule in known if rule.id not in self.unheeded]
        return _JudgedAct(act, actions, heeded, taxonomy, self.visible)


@dataclass(frozen=True)
class _JudgedAct:
    """An act with the norms on its actions, which are the nearest first."""

    act: Act
    actions: tuple[Atom, ...]
    norms: Sequence[Rule]
    taxonomy: Taxonomy
    visible: frozenset[str]

    @cached_property
    def applying(self) -> list[Rule]:
        return [rule for rule in self.norms if self._applies(rule)]

    @cached_property
    def _shown(self) -> Mapping[Atom, Interval]:
        act = self.act
        seen = [Atom("property", name) for name in act.properties]
        seen += [Atom("object", act.object)] if act.object else []
        evidence = {**act.contexts, **dict.fromkeys(seen, CERTAIN)}
        implied = self.taxonomy.implied(evidence)
        return {atom: evidence[origin] for atom, (_, origin) in implied.items()}

    def _applies(self, rule: Rule) -> bool:
        if Atom("action", rule.context or "") not in self.actions or not _is_likely(rule.support):
            return False
        unseen = self.unseen(rule)
        needed = [atom for atom in self._premises(rule) if atom.name not in unseen]
        if not all(_is_likely(self._shown.get(atom, VACUOUS)) for atom in needed):
            return False
        return rule.part is None or rule.functor == OBLIGED or self._is_part(rule.part)

    def _premises(self, rule: Rule) -> list[Atom]:
        others = (atom for atom in rule.contexts if atom.kind not in {"action", "object"})
        return sorted((*rule.features, *others))

    def _is_part(self, wanted: str) -> bool:
        return wanted in self.taxonomy.names_above("part", self.act.part)

    def unseen(self, rule: Rule) -> tuple[str, ...]:
        """Return the properties of a norm that nobody can see: whether a mug is hot."""
        return tuple(
            atom.name
            for atom in sorted(rule.features)
            if atom.kind == "property" and atom not in self._shown and atom.name not in self.visible
        )

    def is_against(self, rule: Rule) -> bool:
        if rule.functor != OBLIGED:
            return rule.functor == FORBIDDEN
        if rule.part:
            return self.act.part is not None and not self._is_part(rule.part)
        return not self._is_met(rule)

    def _is_met(self, rule: Rule) -> bool:
        first = rule.argument and rule.argument.name
        named = next((atom.name for atom in rule.contexts if atom.kind == "object"), None)
        held, thing = self.act.holding, named or self.act.object
        kinds = self.taxonomy.names_above
        if first == PUT_DOWN:
            return held is None or (thing is not None and thing not in kinds("object", held))
        for action, done_with in reversed(self.act.done):
            if action == first and thing in {None, *kinds("object", done_with)}:
                return True
            if action == rule.context and done_with == self.act.object:
                return False
        return False

    def conflict(self, rule: Rule, permission: Rule) -> NormConflict:
        """Return which of a norm against the act and a permission prevails, and why."""
        order = Specificity(self.taxonomy, self.actions, has_material=True)
        pairs = ((permission, rule), (rule, permission))
        for one, other in pairs:
            if order.is_more_specific(one, other):
                return NormConflict(one, other, "more specific")
        one, other = max(pairs, key=lambda pair: _rank(pair[0]))
        reason = "told by somebody who is trusted more" if one.trust > other.trust else "later"
        return NormConflict(one, other, reason)

    def evidence(self, rule: Rule) -> list[Proof]:
        known = [atom for atom in self._premises(rule) if atom in self._shown]
        shown = [Proof("given", self._shown[atom], str(atom)) for atom in known]
        return shown or [Proof("given", CERTAIN, f"action:{rule.context}")]


def _is_likely(interval: Interval) -> bool:
    return interval.lower + interval.upper > 1 + EPSILON


def _rank(rule: Rule) -> tuple[float, float, str]:
    return rule.trust, math.inf if rule.utterance is None else rule.utterance, rule.id
