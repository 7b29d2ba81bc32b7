# ruff: noqa: RUF009 - `_option` returns a field
"""The configuration of an agent: each option declared once, with its default, type and help.

Python code writes `AgentConfig(scene="objects:knife,mug", simulate=False)`, files have the same
names as keys, and the command line makes its options from the same declarations. `config_files`
says where a command looks for the values of options that it is not given.
"""

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from ..ontology.errors import DataError, HiltError
from ..ontology.logs import timed
from ..ontology.plugins import plugin_names
from ..ontology.yaml_reader import YamlNode, read_toml, read_yaml

if TYPE_CHECKING:  # at run time only where they are needed, so that `hilt --help` is fast
    from ..inference.settings import Settings
    from ..kb.interval import Interval
    from ..kb.knowledge_base import KnowledgeBase
    from ..kb.rule import Atom
    from ..nlu.language import Language
    from ..ontology.actions import Actions
    from ..ontology.objects import Household

T = TypeVar("T")


@dataclass(frozen=True)
class ConfigOption:
    """One option of an agent: how it is declared in Python, YAML and on the command line."""

    kind: type  #: the type of its value: str, int, bool, Path, or tuple for several texts
    default: Any
    help: str
    flag: str = ""  #: its name on the command line; empty for the name of the field
    #: how the command line shows its value; None for the name in capitals
    metavar: str | None = None
    name: str = ""  #: the field of `AgentConfig`, and the key in a YAML file

    def is_file(self, value: str) -> bool:
        """Whether a value of this option names a file or folder."""
        files = {"scene": r".*\.ya?ml", "robot": r".*\.ya?ml(:.*)?", "base": r"(?!\w{2,}:).*"}
        return self.kind is Path or bool(re.fullmatch(files.get(self.name, "(?!)"), value))


def _option(default: Any, *declared: Any, **more: Any) -> Any:
    option = ConfigOption(Path if default is None else type(default), default, *declared, **more)
    return field(default=default, metadata={"option": option})


@dataclass(frozen=True)
class AgentConfig:
    """What an agent starts with: its scene, its robot, its language and its inference.

    The help of each option says what it is. The seed is at least 0; `settings` may also be a value;
    `overrides` replace single settings of it; files are YAML. DataError if a context is wrong.
    """

    scene: str = _option(
        "all", "What is on the table: a YAML file, objects:knife,mug, random:SEED, or all."
    )
    seed: int = _option(0, "The seed of everything random.")
    objects: Path | None = _option(None, "A YAML file with further objects.")
    actions: Path | None = _option(None, "A YAML file with further actions.")
    lexicon: Path | None = _option(None, "A lexicon file with further words and phrases.")
    robot: str = _option("panda", "The robot: panda, kuka, or one of a file, FILE.yaml:NAME.")
    vision: str = _option(
        "mask",
        "The source of percepts: the simulator's mask, a detector learned from pictures, or a "
        "plug-in.",
        metavar="mask|learned[:FILE]|NAME",
    )
    motion: str = _option("", "A plug-in that moves the robot, in place of the simulator.")
    noise: str = _option(
        "",
        "How perception fails: missed, confused, confidence (shares), depth_m (metres), camera.",
        metavar="KEY=VALUE,...",
    )
    simulate: bool = _option(True, "Move a simulated robot.", "--sim/--no-sim")
    gui: bool = _option(False, "Show the simulator's window.")
    induce: bool = _option(False, "Also act on rules that follow by similarity.")
    settings: "Settings | Path | None" = _option(None, "A YAML file with inference settings.")
    overrides: tuple[str, ...] = _option(
        (),
        "One setting of the inference: fusion=dempster, threshold.pass=0.1, ...",
        "--set",
        "NAME=VALUE",
    )
    contexts: tuple[str, ...] = _option(
        (),
        "What holds now: place:kitchen, role:guest; place:kitchen=0.9 where it is uncertain.",
        "--context",
        "KIND:NAME[=DEGREE]",
    )
    taxonomy: tuple[str, ...] = _option(
        (),
        "An ontology in the base whose kinds count as well (hilt import --as ontology).",
        metavar="NAME",
    )

    def __post_init__(self) -> None:
        self.context_intervals()

    @classmethod
    def from_yaml(cls, path: Path) -> "AgentConfig":
        """Read a configuration from a YAML file whose keys are the names of the options.

        Files that it names are looked up beside it. DataError says where a key or value is wrong.
        """
        return cls(**read_values(path))

    def context_intervals(self) -> "dict[Atom, Interval]":
        """Return each context with the interval to which it holds."""
        return dict(map(_context, self.contexts))


OPTIONS: Mapping[str, ConfigOption] = {
    each.name: replace(each.metadata["option"], name=each.name) for each in fields(AgentConfig)
}


def read_nodes(path: Path, known: Collection[str]) -> Mapping[str, YamlNode]:
    """Return the entries of a YAML or TOML file with known keys; errors as of `from_yaml`."""
    return (read_toml if path.suffix == ".toml" else read_yaml)(path).entries(optional=known)


def read_values(path: Path) -> dict[str, Any]:
    """Return the values of the options in a YAML or TOML file; errors as of `from_yaml`."""
    nodes = read_nodes(path, OPTIONS)
    return {name: read_value(node, OPTIONS[name], path.parent) for name, node in nodes.items()}


@cache
def _read_once(load: Callable[[], T]) -> T:
    return load()


def household(path: Path | None = None) -> "Household":
    """Return the object types of Hilt, and of a file; DataError says where the file is wrong."""
    from ..ontology.objects import load_household

    return load_household(path, added_to=household()) if path else _read_once(load_household)


def load_language(kinds: "Household", lexicon: Path | None = None) -> "Language":
    """Return the language for these types and a lexicon file; DataError says where it is wrong."""
    is_own = lexicon is None and kinds is household()
    return _read_once(_read_language) if is_own else _read_language(kinds, lexicon)


def _read_language(kinds: "Household | None" = None, lexicon: Path | None = None) -> "Language":
    from ..nlu.language import Language
    from ..nlu.lexicon.vocabulary import household_vocabulary

    vocabulary = household_vocabulary((kinds or household()).objects)
    with timed(__name__, "load the language"):
        return Language.load(vocabulary=vocabulary, extra_lexicon=lexicon)


def actions_with(path: Path | None) -> "Actions":
    """Return the actions of Hilt, and of a file; DataError says where the file is wrong."""
    from ..ontology.actions import load_actions

    return load_actions(path, added_to=actions_with(None)) if path else _read_once(load_actions)


def is_plugin(vision: str) -> bool:
    """Return whether a source of percepts is a plug-in of that name."""
    is_own = vision.partition(":")[0] in {"mask", "learned"}
    return not is_own and vision in plugin_names("hilt.vision")


def default_location() -> Path:
    """Return the folder of the user's own knowledge base."""
    from platformdirs import user_data_path

    return user_data_path("hilt") / "kb"


def open_base(
    location: str | None, kinds: "Household | None" = None, actions: "Actions | None" = None
) -> "KnowledgeBase":
    """Open a knowledge base and load the domain graph into it.

    The location is `memory:`, a folder or an endpoint, None for the user's own base; the domain is
    Hilt's own, unless object types or actions are given. StoreError if it cannot be opened.
    """
    from ..kb.knowledge_base import KnowledgeBase

    location = location or str(default_location())
    with timed(__name__, "open the knowledge base %s", location):
        base = KnowledgeBase.open(location)
        known = kinds or household()
        base.load_domain(known.objects, actions or actions_with(None), known.classes, known.people)
    return base


def read_value(value: YamlNode, option: ConfigOption, folder: Path) -> Any:
    """Return the value of an option; a file that it names is looked up in the folder.

    DataError if it is of the wrong type; with its place.
    """
    if option.kind is int:
        return value.integer(low=0)
    if option.kind is bool:
        return value.truth()
    if option.kind is tuple:
        texts = value.listed()
        for each in texts if option.name == "contexts" else ():
            try:
                _context(each.text())
            except DataError as error:
                raise each.fail(error.problem) from error
        return tuple(each.text() for each in texts)
    if option.kind is str and not option.is_file(value.text()):
        return value.text()
    return option.kind(folder / Path(value.text()).expanduser())


def _context(text: str) -> "tuple[Atom, Interval]":
    from ..kb.interval import Interval
    from ..kb.rule import Atom

    name, equals, degree = text.partition("=")
    try:
        return Atom.parse(name), Interval(float(degree) if equals else 1.0, 1.0)
    except (HiltError, ValueError) as error:
        problem = f'expected KIND:NAME or KIND:NAME=DEGREE, as "place:kitchen=0.9": {error}'
        raise DataError(problem, source=text) from error
