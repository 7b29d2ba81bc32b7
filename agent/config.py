# SPDX-License-Identifier: Apache-2.0
"""The configuration of an agent: each option declared once, with its default, type and help.

Python code writes `AgentConfig(scene="objects:knife,mug", simulate=False)`, a YAML file has the
same names as keys, and the command line makes its options from the same declarations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..ontology.errors import DataError, HiltError
from ..ontology.yaml_reader import Field, read_yaml

if TYPE_CHECKING:  # at run time only where they are needed, so that `hilt --help` is fast
    from ..inference.settings import Settings
    from ..kb.interval import Interval
    from ..kb.knowledge_base import KnowledgeBase
    from ..kb.rule import Atom
    from ..nlu.language import Language
    from ..ontology.actions import Actions
    from ..ontology.objects import Household

FILES = (".yaml", ".yml")


@dataclass(frozen=True)
class Option:
    """One option of an agent.

    Attributes:
        name: the field of `AgentConfig`, and the key in a YAML file.
        kind: the type of its value: str, int, bool, Path, or tuple for several texts.
        default: its value when nobody gives one.
        help: one line for the command line.
        flag: its name on the command line.
        metavar: how the command line shows its value; None for the name in capitals.
    """

    name: str
    kind: type
    default: Any
    help: str
    flag: str
    metavar: str | None = None


def _about(kind: type, text: str, *, flag: str = "", metavar: str | None = None) -> dict[str, Any]:
    """What the command line needs to know of a field, beside its name and default."""
    return {"kind": kind, "help": text, "flag": flag, "metavar": metavar}


@dataclass(frozen=True)
class AgentConfig:
    """What an agent starts with: its scene, its robot, its language and its inference.

    Attributes:
        scene: what is on the table: a YAML file, `objects:knife,mug`, `random:SEED`, or `all`.
        seed: the seed of everything random, at least 0.
        objects: a YAML file with further object types.
        actions: a YAML file with further actions.
        lexicon: a YAML file with further words and phrases.
        robot: `panda`, `kuka`, or `FILE.yaml:NAME`.
        vision: the source of percepts: `mask`, `learned`, or `learned:FILE`.
        noise: how perception fails, as `missed=0.1,confused=0.05`; empty for not at all.
        simulate: whether there is a simulated robot; without one the agent only decides.
        gui: whether the simulator shows a window.
        induce: whether the agent also acts on rules that follow by similarity.
        settings: the settings of the inference, or a YAML file with them.
        overrides: single settings, as `fusion=dempster`; they replace those in `settings`.
        contexts: what holds in this situation, as `place:kitchen` or `role:child=0.9`.

    Raises:
        DataError: a value is of the wrong type, or out of its range.
    """

    scene: str = field(
        default="all",
        metadata=_about(
            str, "What is on the table: a YAML file, objects:knife,mug, random:SEED, or all."
        ),
    )
    seed: int = field(default=0, metadata=_about(int, "The seed of everything random."))
    objects: Path | None = field(
        default=None, metadata=_about(Path, "A YAML file with further objects.")
    )
    actions: Path | None = field(
        default=None, metadata=_about(Path, "A YAML file with further actions.")
    )
    lexicon: Path | None = field(
        default=None, metadata=_about(Path, "A lexicon file with further words and phrases.")
    )
    robot: str = field(
        default="panda",
        metadata=_about(str, "The robot: panda, kuka, or one of a file, FILE.yaml:NAME."),
    )
    vision: str = field(
        default="mask",
        metadata=_about(
            str,
            "The source of percepts: the simulator's mask, or a detector learned from pictures.",
            metavar="mask|learned[:FILE]",
        ),
    )
    noise: str = field(
        default="",
        metadata=_about(
            str,
            "How perception fails: missed, confused, confidence (shares), depth_m (metres).",
            metavar="KEY=VALUE,...",
        ),
    )
    simulate: bool = field(
        default=True, metadata=_about(bool, "Move a simulated robot.", flag="--sim/--no-sim")
    )
    gui: bool = field(default=False, metadata=_about(bool, "Show the simulator's window."))
    induce: bool = field(
        default=False, metadata=_about(bool, "Also act on rules that follow by similarity.")
    )
    settings: Settings | Path | None = field(
        default=None, metadata=_about(Path, "A YAML file with settings of the inference.")
    )
    overrides: tuple[str, ...] = field(
        default=(),
        metadata=_about(
            tuple,
            "One setting of the inference: fusion=dempster, threshold.pass=0.1, ...",
            flag="--set",
            metavar="NAME=VALUE",
        ),
    )
    contexts: tuple[str, ...] = field(
        default=(),
        metadata=_about(
            tuple,
            "What holds now: place:kitchen, role:guest; place:kitchen=0.9 where it is uncertain.",
            flag="--context",
            metavar="KIND:NAME[=DEGREE]",
        ),
    )

    def __post_init__(self) -> None:
        for option in OPTIONS.values():
            value = getattr(self, option.name)
            if not _fits(value, option) and not (option.name == "settings" and _is_settings(value)):
                raise DataError(
                    f"expected {_EXPECTED[option.kind]}, found {value!r}.",
                    source=f"AgentConfig.{option.name}",
                )
        self.context_intervals()

    @classmethod
    def from_yaml(cls, path: Path) -> AgentConfig:
        """Read a configuration from a YAML file whose keys are the names of the options.

        Files that it names are looked up beside it.

        Raises:
            DataError: an unknown key or a wrong value; with file, line and column.
        """
        entries = read_yaml(path).entries(optional=OPTIONS)
        values = {name: _read(each, OPTIONS[name], path.parent) for name, each in entries.items()}
        return cls(**values)

    def load_household(self) -> Household:
        """Return the object types: those that come with Hilt, and those of `objects`.

        Raises:
            DataError: the file is wrong.
        """
        from ..ontology.objects import load_household

        return load_household(self.objects, added_to=household()) if self.objects else household()

    def load_actions(self) -> Actions:
        """Return the actions that come with Hilt, and those of `actions`.

        Raises:
            DataError: the file is wrong.
        """
        return actions_with(self.actions)

    def load_language(self, kinds: Household) -> Language:
        """Return the language, with the names of these object types and the words of `lexicon`.

        Raises:
            DataError: the file is wrong.
        """
        return load_language(kinds, self.lexicon)

    def load_settings(self) -> Settings:
        """Return the settings of the inference, with the overrides applied.

        Raises:
            DataError: the file or an override is wrong.
        """
        from ..inference.settings import SETTINGS_FILE, Settings

        given = self.settings
        loaded = given if isinstance(given, Settings) else Settings.load(given or SETTINGS_FILE)
        return loaded.with_choices(self.overrides)

    def context_intervals(self) -> dict[Atom, Interval]:
        """Return each context with the interval to which it holds."""
        return dict(map(_context, self.contexts))


OPTIONS: Mapping[str, Option] = {
    each.name: Option(
        each.name,
        each.metadata["kind"],
        each.default,
        each.metadata["help"],
        each.metadata["flag"] or f"--{each.name}",
        each.metadata["metavar"],
    )
    for each in fields(AgentConfig)
}


@cache
def household() -> Household:
    """Return the object types that come with Hilt."""
    from ..ontology.objects import load_household

    return load_household()


@cache
def _own_actions() -> Actions:
    from ..ontology.actions import load_actions

    return load_actions()


@cache
def _own_language() -> Language:
    return _read_language(household(), None)


def _read_language(kinds: Household, lexicon: Path | None) -> Language:
    from ..nlu.language import Language
    from ..nlu.lexicon.vocabulary import household_vocabulary

    vocabulary = household_vocabulary(kinds.objects)
    return Language.load(vocabulary=vocabulary, extra_lexicon=lexicon)


def load_language(kinds: Household, lexicon: Path | None = None) -> Language:
    """Return the language, with the names of these object types.

    Args:
        kinds: the object types.
        lexicon: a lexicon file with further words.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    is_own = lexicon is None and kinds is household()
    return _own_language() if is_own else _read_language(kinds, lexicon)


def actions_with(path: Path | None) -> Actions:
    """Return the actions that come with Hilt, and those of a file.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    from ..ontology.actions import load_actions

    return load_actions(path, added_to=_own_actions()) if path else _own_actions()


def default_location() -> Path:
    """Return the folder of the user's own knowledge base."""
    from platformdirs import user_data_path

    return user_data_path("hilt") / "kb"


def open_base(
    location: str | None, kinds: Household | None = None, actions: Actions | None = None
) -> KnowledgeBase:
    """Open a knowledge base and load the domain graph into it.

    Args:
        location: `memory:`, a folder, or an endpoint; None for the user's own base.
        kinds: the object types; None for those that come with Hilt.
        actions: the actions; None for those that come with Hilt.

    Raises:
        StoreError: it cannot be opened.
    """
    from ..kb.knowledge_base import KnowledgeBase

    base = KnowledgeBase.open(location or default_location())
    base.load_domain((kinds or household()).objects, actions or _own_actions())
    return base


_EXPECTED = {
    str: "a text",
    int: "a whole number of at least 0",
    bool: "True or False",
    Path: "a path",
    tuple: "a tuple of texts",
}


def _fits(value: object, option: Option) -> bool:
    if option.kind is int:
        return isinstance(value, int) and not isinstance(value, bool) and value >= 0
    if option.kind is tuple:
        return isinstance(value, tuple) and all(isinstance(each, str) for each in value)
    return isinstance(value, option.kind) or (value is None and option.default is None)


def _is_settings(value: object) -> bool:
    from ..inference.settings import Settings

    return isinstance(value, Settings)


def _read(value: Field, option: Option, folder: Path) -> Any:
    """Return the value of a key, as the option's type."""
    if option.kind is int:
        return value.integer(low=0)
    if option.kind is bool:
        return value.truth()
    if option.kind is Path:
        return folder / value.text()
    if option.kind is tuple:
        return _read_texts(value, option)
    is_scene_file = option.name == "scene" and value.text().endswith(FILES)
    return str(folder / value.text()) if is_scene_file else value.text()


def _read_texts(value: Field, option: Option) -> tuple[str, ...]:
    texts = value.items() if isinstance(value.value, tuple) else (value,)
    for each in texts if option.name == "contexts" else ():
        try:
            _context(each.text())
        except DataError as error:
            raise each.fail(error.problem) from error
    return tuple(each.text() for each in texts)


def _context(text: str) -> tuple[Atom, Interval]:
    """Parse a context and the degree to which it holds: "place:kitchen=0.9"."""
    from ..kb.interval import Interval
    from ..kb.rule import Atom

    name, equals, degree = text.partition("=")
    try:
        return Atom.parse(name), Interval(float(degree) if equals else 1.0, 1.0)
    except (HiltError, ValueError) as error:
        raise DataError(
            f'expected KIND:NAME or KIND:NAME=DEGREE, as "place:kitchen=0.9": {error}', source=text
        ) from error
