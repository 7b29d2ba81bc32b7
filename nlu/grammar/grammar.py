"""The grammar of a language: its categories, the names in its meanings, and what is an utterance.

Read from `grammar.yaml` of the language and `predicates.yaml` of all languages. Every line is
checked when it is read: each category must be declared and each term must have the type that its
category demands. A mistake is a `DataError`, which says where.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

from ...ontology.yaml_reader import YamlNode, read_yaml
from . import categories
from .categories import AtomicCategory, Category, Signature, Type
from .notation import read_entry, read_type, read_unary
from .terms import Term, Value, evaluate
from .word_patterns import compile_pattern, expand

PREDICATES_FILE = Path(__file__).parents[2] / "ontology" / "predicates.yaml"

SPEECH_ACTS = ("STATEMENT", "INSTRUCT", "QUESTION", "CORRECT", "FRAGMENT", "REPLY")


@dataclass(frozen=True)
class UnaryRule:
    """A change of category that needs no word; its term maps the old meaning to the new one."""

    source: Category
    target: Category
    term: Term
    value: Value
    cost: float = 0.0

    def __str__(self) -> str:
        return f"{self.source} => {self.target}"


@dataclass(frozen=True)
class Grammar:
    """What all words of a language share."""

    types: Mapping[str, Type]  #: the type of each atomic category
    descriptions: Mapping[str, str]  #: each atomic category in words, for messages
    signature: Signature  #: the types of the names that meanings are made of
    unary: tuple[UnaryRule, ...]  #: the changes of category
    roots: Mapping[Category, str]  #: the speech act of each category that is a whole utterance
    topic: Category  #: the category of what is only named, for "it" to stand for
    general: Category  #: the category of any object of a kind, like "a knife"
    answer: Category  #: the category of a short answer, like "the second one"
    #: the categories of the speaker as who is given something: "me", "to me"
    speaker: frozenset[Category]

    def entry(self, field: YamlNode, more: Signature | None = None) -> tuple[Category, Term, float]:
        """Read and check one line `category : term @cost`; `more` types constants of this line."""
        category, term, cost = read_entry(field)
        self.verify(category, term, field, more)
        return category, term, cost

    def verify(
        self, category: Category, term: Term, field: YamlNode, extra: Signature | None = None
    ) -> None:
        """Check the type of a term; `DataError` if it or an atom does not fit the category."""
        signature = {**self.signature, **extra} if extra else self.signature
        expected = self.type_of(category, field)
        try:
            categories.check_type(term, expected, signature)
        except categories.TypeMismatchError as error:
            raise field.fail(f"{category} : {term} does not fit its category: {error}.") from error

    def type_of(self, category: Category, field: YamlNode) -> Type:
        """The type of the meanings of a category; `DataError` for an atom that is not declared."""
        try:
            return categories.type_of(category, self.types)
        except KeyError as error:
            known = ", ".join(sorted(self.types))
            raise field.fail(
                f'the category "{error.args[0]}" is not declared; expected one of {known}.'
            ) from error

    def described(self, category: Category) -> str:
        """A category in words for messages; empty where nobody expects it."""
        said = self.descriptions.get(category.atom.name)
        if said is None:  # words of a construction, shown in the first of their spellings
            spellings = map(" ".join, expand(compile_pattern(category.atom.words)))
            said = f'"{next(filter(None, spellings))}"'
        return said


def load_grammar(
    path: Path, *, degrees: Mapping[str, object], predicates: Path = PREDICATES_FILE
) -> Grammar:
    """Read the grammar of a language; the names of the degrees become constants of type `d`."""
    keys = ("categories", "unary", "roots", "topic", "general", "answer", "speaker")
    entries = read_yaml(path).entries(required=keys, optional=())
    atoms = {name: _atom(field) for name, field in entries["categories"].entries().items()}
    types = {name: kind for name, (kind, _) in atoms.items()}
    signature: dict[str, list[Type]] = {name: ["d"] for name in degrees}
    names = read_yaml(predicates).entries(required=("types",))["types"].entries()
    signature |= {name: list(map(read_type, field.items())) for name, field in names.items()}
    named = {key: entries[key].text(choices=types) for key in ("topic", "general", "answer")}
    grammar = Grammar(
        types=types,
        descriptions={name: said for name, (_, said) in atoms.items()},
        signature=signature,
        unary=(),
        roots=_roots(entries["roots"], types),
        speaker=frozenset(map(AtomicCategory, entries["speaker"].texts(choices=types))),
        **{key: AtomicCategory(name) for key, name in named.items()},
    )
    unary = tuple(_unary(field, grammar) for field in entries["unary"].items())
    _refuse_cycles(unary, entries["unary"])
    return replace(grammar, unary=unary)


def _atom(field: YamlNode) -> tuple[Type, str]:
    if isinstance(field.value, str):
        return "e", field.text()
    parts = field.entries(required=("type",), optional=("means",))
    return read_type(parts["type"]), parts["means"].text() if "means" in parts else ""


def _roots(field: YamlNode, types: Mapping[str, Type]) -> Mapping[Category, str]:
    roots: dict[Category, str] = {}
    for name, act in field.entries().items():
        if types.get(name) != "t":
            raise act.fail(f'expected a category of type t, found "{name}".')
        roots[AtomicCategory(name)] = act.text(choices=SPEECH_ACTS)
    return roots


def _unary(field: YamlNode, grammar: Grammar) -> UnaryRule:
    source, target, term = read_unary(field)
    expected = categories.FunctionType(*(grammar.type_of(each, field) for each in (source, target)))
    try:
        categories.check_type(term, expected, grammar.signature)
    except categories.TypeMismatchError as error:
        raise field.fail(f"{term} does not turn {source} into {target}: {error}.") from error
    return UnaryRule(source, target, term, evaluate(term))


def _refuse_cycles(unary: tuple[UnaryRule, ...], field: YamlNode) -> None:
    order: TopologicalSorter[Category] = TopologicalSorter()
    for rule in unary:
        order.add(rule.target, rule.source)
    try:
        order.prepare()
    except CycleError as error:
        source, target, *_ = error.args[1]
        raise field.fail(
            f"expected changes that end, but {source} => {target} comes back to itself."
        ) from error
