"""Inference settings: operators, fusion stage, detection model and thresholds per context.

`ontology/settings.yaml` holds the defaults; a file in the same form overrides them, and
`Settings.with_choices` takes single settings in the form of the command line.
"""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from pathlib import Path

from ..kb.rule import Atom
from ..ontology.errors import DataError, UnknownNameError, ValidationError
from ..ontology.yaml_reader import YamlNode, read_yaml
from .interval_operators import Operators

SETTINGS_FILE = Path(__file__).parents[1] / "ontology" / "settings.yaml"
STAGES = ("rules", "conclusions")
DETECTIONS = ("open", "point")
OPERATORS = tuple(each.name for each in fields(Operators))
THRESHOLD, CONTRADICTION = NUMBERS = "threshold", "contradiction"
TEXTS = ("stage", "detection")


@dataclass(frozen=True)
class Settings:
    """The settings of the inference; UnknownNameError if there is no such stage or detection."""

    #: conjunction, modus ponens, fusion, ranking and acceptance
    operators: Operators = field(default_factory=Operators)
    #: fuse "rules" with the same antecedent before modus ponens (default); or fuse the
    #: "conclusions" of single rules, literally as in the paper
    stage: str = "rules"
    #: a detection with confidence d is [d, 1] ("open", default) or [d, d] ("point")
    detection: str = "open"
    threshold: float = 0.005  #: Λ in [0, 1], which lambda must exceed before the robot acts
    #: the mass in [0, 1] above which experience contradicts what was told so much that Hilt asks
    contradiction: float = 0.25
    #: Λ by context: that of an action ("pass") replaces the general one; that of a place or role
    #: ("place:hospital") can only raise it
    thresholds: Mapping[str, float] = field(default_factory=dict[str, float])

    def __post_init__(self) -> None:
        if self.stage not in STAGES:
            raise UnknownNameError("fusion stage", self.stage, STAGES)
        if self.detection not in DETECTIONS:
            raise UnknownNameError("detection", self.detection, DETECTIONS)

    @classmethod
    def load(cls, path: Path = SETTINGS_FILE) -> "Settings":
        """Return the settings of a file; a DataError says where what was expected."""
        settings = cls()
        choices = read_yaml(path).entries(optional=[*OPERATORS, *TEXTS, *NUMBERS])
        if THRESHOLD in choices:
            keys = choices[THRESHOLD].entries(required={"default"}, optional={"contexts"})
            contexts = keys["contexts"].entries() if "contexts" in keys else {}
            choices = {**choices, THRESHOLD: keys["default"]}
            choices |= {f"{THRESHOLD}.{name}": each for name, each in contexts.items()}
        for name, value in choices.items():
            settings = settings._with(name, value)
        return settings

    def with_choices(self, choices: Iterable[str]) -> "Settings":
        """Return a copy with some settings replaced; DataError if one is malformed or unknown.

        >>> Settings().with_choices(["fusion=dempster", "threshold.pass=0.9"]).thresholds
        {'pass': 0.9}
        """
        settings = self
        for choice in choices:
            name, equals, text = choice.partition("=")
            if not equals:
                raise DataError('expected NAME=VALUE, as "fusion=dempster".', source=choice)
            value: object = text.strip()
            with suppress(ValueError):
                value = float(text)
            settings = settings._with(name.strip(), YamlNode(value, choice, 0, 0))
        return settings

    def threshold_of(self, actions: Iterable[str], others: Iterable[Atom] = ()) -> float:
        """Return Λ: that of the first (nearest) action that has one, raised by places and roles."""
        own = (self.thresholds[name] for name in actions if name in self.thresholds)
        asked = (self.thresholds[str(a)] for a in others if str(a) in self.thresholds)
        return max((next(own, self.threshold), *asked))

    def _with(self, name: str, value: YamlNode) -> "Settings":
        first, _, context = name.partition(".")
        if name in NUMBERS:
            return replace(self, **{name: value.number(low=0, high=1)})
        try:
            if name in OPERATORS:
                return replace(self, operators=replace(self.operators, **{name: value.text()}))
            if name in TEXTS:
                return replace(self, **{name: value.text()})
            if first != THRESHOLD:
                known = (*OPERATORS, *TEXTS, *NUMBERS, f"{THRESHOLD}.CONTEXT")
                raise UnknownNameError("choice", name, known)
            if ":" in context:
                Atom.parse(context)
        except (UnknownNameError, ValidationError) as error:
            raise value.fail(str(error)) from error
        return replace(self, thresholds={**self.thresholds, context: value.number(low=0, high=1)})
