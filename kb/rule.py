"""Rules of cognitive affordance: features and contexts imply an affordance, within an interval.

    r:  f1 AND f2 ... AND c1 ...  =>[lower, upper]  functor(argument)

A *feature* is what the robot can see (an object, a property), a *context* what it is doing or
where, and the *affordance* is the conclusion: that the object is used for something
(`usedFor(cutting)`), or how an action is done (`graspObject(blade)`). The form is that of section 2
of the paper; the rules r1 to r3 of its section 3.3 are made by `functional` and `grasping`.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Literal

from ..ontology.errors import ValidationError
from ..ontology.vocabulary import ATOM_KINDS
from .interval import DIGITS, Interval

USED_FOR = "usedFor"
GRASP_OBJECT = "graspObject"
KIND_OF = "kindOf"  # concludes a more general kind of object
FIND_OBJECT = "findObject"  # the node that functional rules are attached to
FORBIDDEN, OBLIGED, PERMITTED = "forbidden", "obliged", "permitted"  # the functors of norms
NORMS = (FORBIDDEN, OBLIGED, PERMITTED)
# The kind of argument that known functors need; any other functor takes any.
ARGUMENT_KINDS: Mapping[str, str] = MappingProxyType(
    {USED_FOR: "affordance", GRASP_OBJECT: "part", KIND_OF: "object"}
)
_EXAMPLES = {USED_FOR: "cutting", GRASP_OBJECT: "blade", KIND_OF: "knife"}
DEFAULT_SPEAKER = "sam"  # where no speaker is named
MAX_NAME = 100  # characters

Status = Literal["active", "retracted", "superseded", "induced"]
Kind = Literal["functional", "action", "norm", "general"]
_KINDS: Mapping[str, Kind] = {
    **{USED_FOR: "functional", GRASP_OBJECT: "action"},
    **{FORBIDDEN: "norm", OBLIGED: "norm", PERMITTED: "norm"},
}

_WORDS = re.compile(r"[^\W_]+(?:[-' ][^\W_]+)*")
_FUNCTOR = re.compile(r"[a-z][A-Za-z0-9]*")
_SPEAKER = re.compile(r"[^\W_](?:[\w .'@+-]*[\w.])?")


@dataclass(frozen=True, slots=True, order=True)
class Atom:
    """One atomic premise or conclusion of a rule; ValidationError for an unknown kind or bad name.

    >>> print(Atom("object", "wine glass"))
    object:wine glass
    """

    kind: str  #: one of object, part, property, action, place, role, affordance, material
    name: str  #: lower-case words with single spaces; an action may have capitals inside (pickUp)

    def __post_init__(self) -> None:
        if self.kind not in ATOM_KINDS:
            problem = f'"{self.kind}" is no kind of atom; expected one of {", ".join(ATOM_KINDS)}.'
            raise ValidationError([problem])
        is_name = len(self.name) <= MAX_NAME and _WORDS.fullmatch(self.name)
        if not is_name or (self.kind != "action" and self.name != self.name.lower()):
            problem = (
                f'"{self.name[:MAX_NAME]}" is no name of {_article(self.kind)}; expected '
                f"lower-case words with single spaces, at most {MAX_NAME} characters."
            )
            raise ValidationError([problem])

    @classmethod
    def parse(cls, text: str) -> Atom:
        """The atom of a text such as "object:knife"."""
        kind, _, name = text.partition(":")
        return cls(kind, name)

    def __str__(self) -> str:
        return f"{self.kind}:{self.name}"


@dataclass(frozen=True, repr=False)
class Rule:
    """One rule of one speaker; ValidationError if it has no premise, or a name is malformed.

    >>> rule = grasping("knife", "blade", "pass", interval=Interval(0.95, 1))
    >>> rule
    <Rule pass, object:knife => graspObject(blade) [0.95, 1.00]>
    >>> rule.node
    'pass.graspObject'
    """

    #: perceptual invariants; all must be seen. May be empty when there is a context ("to pass
    #: anything ...").
    features: frozenset[Atom]
    #: all must hold: the action it is done for, a place, a role, the material that it is done to
    contexts: frozenset[Atom]
    functor: str  #: the predicate concluded: "usedFor", "graspObject", or another action's name
    #: its argument: an affordance, a part, ...; None where the functor needs none
    argument: Atom | None
    interval: Interval  #: as it was said, with at most 6 fractional digits
    speaker: str = DEFAULT_SPEAKER
    #: number of the utterance that last asserted it; None before it is stored
    utterance: int | None = None
    #: when it was last asserted, with a time zone; None before it is stored
    time: datetime | None = None
    status: Status = "active"  #: active, retracted, superseded, or induced
    #: the present trust in the speaker, in [0, 1]; not part of the rule's content
    trust: float = field(default=1.0, compare=False)

    def __post_init__(self) -> None:
        if not self.features and not self.contexts:
            raise ValidationError(["A rule needs at least one feature or context."])
        if not _FUNCTOR.fullmatch(self.functor) or len(self.functor) > MAX_NAME:
            raise ValidationError([f'"{self.functor[:MAX_NAME]}" is no functor, as "graspObject".'])
        wanted = ARGUMENT_KINDS.get(self.functor)
        if wanted and (self.argument is None or self.argument.kind != wanted):
            example = f"{self.functor}({wanted}:{_EXAMPLES[self.functor]})"
            expected = f"{self.functor} needs {_article(wanted)}, as {example}"
            raise ValidationError([f"{expected}; found {self.argument or 'none'}."])
        if sum(atom.kind == "material" for atom in self.contexts) > 1:
            raise ValidationError(["A rule has at most one material; write a rule for each."])
        check_speaker(self.speaker)
        object.__setattr__(self, "interval", self.interval.rounded())
        if self.kind != "norm":
            return
        if self.context is None:
            raise ValidationError([f"{self.functor} needs the action that it is about as context."])
        allowed = ("part",) if self.functor == FORBIDDEN else ("part", "action")
        if not (self.argument.kind in allowed if self.argument else self.functor != OBLIGED):
            expected = " or ".join(map(_article, allowed))
            raise ValidationError([f"{self.functor} takes {expected}, not {self.argument}."])

    @property
    def kind(self) -> Kind:
        """Functional (usedFor), action (graspObject of a part), norm, or general."""
        return _KINDS.get(self.functor, "general")

    @property
    def object(self) -> str | None:
        """The object it is about; None where it is about any, or several."""
        return _only(self.features, "object")

    @property
    def context(self) -> str | None:
        """The action it applies to ("pass"); None where it applies to any."""
        return _only(self.contexts, "action")

    @property
    def material(self) -> str | None:
        """What the object is used on ("bread", for cutting); None where it is any material."""
        return _only(self.contexts, "material")

    @property
    def affordance(self) -> str | None:
        """The affordance it concludes; None for other rules."""
        return self.argument.name if self.argument and self.argument.kind == "affordance" else None

    @property
    def part(self) -> str | None:
        """The part it concludes; None for other rules."""
        return self.argument.name if self.argument and self.argument.kind == "part" else None

    @property
    def support(self) -> Interval:
        """The interval as evidence, discounted by the trust in the speaker."""
        return self.interval.discounted(self.trust)

    @property
    def asserts(self) -> bool:
        """Whether it supports its conclusion, rather than opposing it or neither."""
        return round(self.interval.lower + self.interval.upper, DIGITS) > 1.0

    def restated(
        self,
        features: frozenset[Atom],
        interval: Interval,
        utterance: int | None = None,
        time: datetime | None = None,
    ) -> Rule:
        """This rule with other features, rounded interval and source; checks nothing else."""
        if not features and not self.contexts:
            raise ValidationError(["A rule needs at least one feature or context."])
        rule, own = object.__new__(Rule), {"features": features, "interval": interval}
        source = {"utterance": utterance, "time": time, "id": self._id_with(features, interval)}
        vars(rule).update(vars(self), **own, **source)
        return rule

    def applies_to(self, material: Collection[str]) -> bool:
        """Whether it concerns a use on a material, given its name and those of its kinds.

        Without names it is about a use on anything: what is used for cutting bread is used for
        cutting; what is not used for cutting bread may be.
        """
        if self.material is None:
            return True
        return self.material in material if material else self.kind == "functional" and self.asserts

    @cached_property
    def id(self) -> str:
        """Its identifier, a hash of its content; what one speaker says twice is one rule."""
        return self._id_with(self.features, self.interval)

    @cached_property
    def _implied(self) -> str:
        return f"{_atoms_text(self.contexts)}\n{self.functor}({self.argument or ''})"

    @property
    def node(self) -> str:
        """The action-tree node it is attached to, the key by which it is found.

        A rule with several actions as contexts is attached to the first in alphabetical order:
        where it applies, all of them are above the node, so any of them finds it.
        """
        if self.functor == USED_FOR and self.argument:
            return f"{FIND_OBJECT}.{self.argument.name}"
        actions = sorted(atom.name for atom in self.contexts if atom.kind == "action")
        return ".".join((*actions[:1], self.functor))

    def as_json(self) -> dict[str, object]:
        """The rule in the JSON of every command; "*" is any object."""
        props = sorted(str(atom) for atom in self.features if atom.kind != "object")
        where = sorted(str(a) for a in self.contexts if a.kind not in {"action", "material"})
        general = {"functor": self.functor, "argument": str(self.argument or "") or None}
        return {
            "id": self.id,
            "kind": self.kind,
            "object": self.object or "*",
            "affordance": self.affordance,
            **({"material": self.material} if self.material else {}),
            "context": self.context,
            "part": self.part,
            "lower": self.interval.lower,
            "upper": self.interval.upper,
            "speaker": self.speaker,
            **({"props": [prop.partition(":")[2] for prop in props]} if props else {}),
            **({"contexts": where} if where else {}),
            **(general if self.kind in {"norm", "general"} else {}),
        }

    def _id_with(self, features: frozenset[Atom], interval: Interval) -> str:
        bounds = f"{interval.lower:.{DIGITS}f} {interval.upper:.{DIGITS}f}"
        content = f"{self.speaker}\n{_atoms_text(features)}\n{self._implied}\n{bounds}"
        return "rule/" + hashlib.sha256(content.encode()).hexdigest()[:16]

    def __repr__(self) -> str:
        left = sorted(self.contexts) + sorted(self.features)
        names = ", ".join(atom.name if atom.kind == "action" else str(atom) for atom in left)
        argument = self.argument.name if self.argument else ""
        return f"<Rule {names} => {self.functor}({argument}) {self.interval}>"


def functional(
    name: str,
    affordance: str,
    *,
    interval: Interval,
    material: str | None = None,
    properties: Iterable[str] = (),
    speaker: str = DEFAULT_SPEAKER,
) -> Rule:
    """The rule that an object ("*" for any), of these properties ("red"), is used for something.

    `affordance` is a gerund ("cutting"); `material` is what it is used on ("bread"), None for any.
    """
    contexts = frozenset([Atom("material", material)] if material else [])
    features, argument = _features(name, properties), Atom("affordance", affordance)
    return Rule(features, contexts, USED_FOR, argument, interval, speaker)


def grasping(
    name: str,
    part: str,
    context: str | None = None,
    *,
    interval: Interval,
    properties: Iterable[str] = (),
    speaker: str = DEFAULT_SPEAKER,
) -> Rule:
    """The rule that an object is grasped by a part, in the context of an action ("pass") or any."""
    contexts = frozenset([Atom("action", context)] if context else [])
    features, argument = _features(name, properties), Atom("part", part)
    return Rule(features, contexts, GRASP_OBJECT, argument, interval, speaker)


def kind_rule(name: str, above: str, *, interval: Interval, speaker: str = DEFAULT_SPEAKER) -> Rule:
    """The rule that an object is of a more general kind."""
    return Rule(_features(name, ()), frozenset(), KIND_OF, Atom("object", above), interval, speaker)


def norm(
    functor: str,
    action: str,
    name: str = "*",
    argument: Atom | None = None,
    *,
    interval: Interval,
    contexts: Iterable[Atom] = (),
    properties: Iterable[str] = (),
    speaker: str = DEFAULT_SPEAKER,
) -> Rule:
    """The rule that an action on an object is forbidden, obliged or permitted.

    `functor` is one of `NORMS`; `name` is the object ("*" for any), of these properties ("hot").
    `argument` is the part by which it is done; for an obligation, also the action that comes first.
    `contexts` are where, and to whom: places and roles.
    """
    where = frozenset((Atom("action", action), *contexts))
    return Rule(_features(name, properties), where, functor, argument, interval, speaker)


def check_speaker(name: str) -> None:
    """Raise a ValidationError for a name that no speaker can have."""
    if not _SPEAKER.fullmatch(name) or len(name) > MAX_NAME:
        problem = (
            f"{name[:MAX_NAME]!r} is no speaker's name; expected letters, digits, spaces and "
            f". ' @ + -, at most {MAX_NAME} characters."
        )
        raise ValidationError([problem])


def _features(name: str, properties: Iterable[str]) -> frozenset[Atom]:
    objects = () if name == "*" else (Atom("object", name),)
    return frozenset((*objects, *(Atom("property", prop) for prop in properties)))


@lru_cache(maxsize=2**18)
def _atoms_text(atoms: frozenset[Atom]) -> str:
    return " ".join(sorted(str(atom).replace(" ", "_") for atom in atoms))


def _only(atoms: frozenset[Atom], kind: str) -> str | None:
    names = [atom.name for atom in atoms if atom.kind == kind]
    return names[0] if len(names) == 1 else None


def _article(kind: str) -> str:
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"
