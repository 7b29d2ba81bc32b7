# SPDX-License-Identifier: Apache-2.0
"""Reader of the word files of a language, and maker of entries for the names of a vocabulary.

`WordBook` is what the file says, checked: contractions, templates, the entries of all words, and
the templates that a new noun, part, use or act gets. One line of the file may stand for hundreds
of entries: the spellings of a pattern, or the frames and inflections of a verb.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

from ..ontology.source import Field, read_yaml
from .asides import Asides
from .categories import Category
from .combinators import Combinator
from .constructions import Construction, Gap, Piece, Run, category_of, pieces, runs
from .grammar import Grammar, Unary
from .inflection import Inflection
from .lexicon import Entry, Frame, Template
from .notation import read_entry, read_type
from .patterns import Group, factored, spellings
from .terms import Constant, evaluate, replace_constants
from .tokens import Tokens
from .vocabulary import ROLES, Vocabulary

NOUN_TEMPLATES = {"object": "object", "part": "part", "property": "property", "person": "person"}

_NOTHING = Constant("something")
_NOTHING_VALUE = evaluate(_NOTHING)
_NAMING = ("USE", "ACT", "THIS")
_KEYS = (
    *("contractions", "closed", "templates", "verbs", "qualifiers", "nouns", "words"),
    *("constructions", "asides", "endings"),
)


@dataclass(frozen=True)
class Verb:
    """A verb as one line of the file gives it.

    Attributes:
        verb: the bare form, with its particle.
        templates: names of its templates.
        means: the name of the act, None when it names none.
    """

    verb: str
    templates: tuple[str, ...]
    means: str | None


class WordBook:
    """The words of a language, and how entries are made for new ones.

    Args:
        grammar: what the lines are checked against.
        inflection: how forms are made.
        combinator: numbers the categories.
    """

    def __init__(self, grammar: Grammar, inflection: Inflection, combinator: Combinator) -> None:
        self._grammar, self._inflection, self._combinator = grammar, inflection, combinator
        self.templates: dict[str, Template] = {}
        self.contractions: dict[str, tuple[str, ...]] = {}
        self.closed: frozenset[str] = frozenset()
        self.verbs: list[Verb] = []
        self.qualifiers: dict[str, tuple[str, ...]] = {}
        self.nouns: dict[str, tuple[str, ...]] = {}
        self.asides = Asides()
        self.endings: dict[str, str] = {}
        self.entries: list[Entry] = []
        self.turns: list[Entry] = []

    def read(self, path: Path) -> None:
        """Add all that a file says; a second file adds to the first.

        Raises:
            DataError: a line is not as expected; says where.
        """
        parts = read_yaml(path).entries(optional=_KEYS)
        for short, field in _entries(parts, "contractions"):
            self.contractions[short] = tuple(field.text().split())
        for short, field in _entries(parts, "endings"):
            self.endings[short] = field.text()
        if "closed" in parts:
            self.closed |= set(parts["closed"].texts())
        for name, field in _entries(parts, "templates"):
            self.templates[name] = self._template(name, field)
        for field in _items(parts, "verbs"):
            self._read_verb(field)
        for degree, field in _entries(parts, "qualifiers"):
            self._read_qualifier(degree, field)
        for kind, field in _entries(parts, "nouns"):
            self._template_named(kind, field)
            self.nouns[kind] = (*self.nouns.get(kind, ()), *field.texts())
            for name in field.texts():
                self.entries += self.noun(kind, name)
        for field in _items(parts, "words"):
            self.entries += self._word(field)
        for field in _items(parts, "constructions"):
            self.turns += self._construction(field)
        for kind, field in _entries(parts, "asides"):
            self.asides = self.asides.reading(kind, field)

    def lengthened(self, tokens: Tokens) -> Tokens:
        """An utterance with its endings that may be short for a word written out: "a shoe's"."""
        items = tuple(replace(t, word=self.endings.get(t.word, t.word)) for t in tokens.items)
        return replace(tokens, items=items)

    def verb_entries(self, verb: Verb, *, role: str = "", cost: float = 0.0) -> Iterator[Entry]:
        """The entries of a verb: all frames of its templates in all inflections."""
        gerund = self._inflection.form(verb.verb, "ing")
        names = {"ACT": verb.means or _constant(verb.verb), "USE": _constant(gerund)}
        for name in verb.templates:
            yield from self._filled(self.templates[name], verb.verb, names, role=role, cost=cost)

    def noun(self, kind: str, name: str, *, role: str = "", cost: float = 0.0) -> Iterator[Entry]:
        """The entries of a noun, part, property or person, by the name of its template."""
        template = self.templates[kind]
        yield from self._filled(template, name, {"THIS": _constant(name)}, role=role, cost=cost)

    def vocabulary(self, vocabulary: Vocabulary) -> Iterator[Entry]:
        """The entries of all names of a vocabulary."""
        for role in ROLES:
            for name in vocabulary.names(role):
                yield from self.named(role, name)

    def named(self, role: str, name: str) -> Iterator[Entry]:
        """The entries of one name in a role, one of `ROLES`."""
        if role in NOUN_TEMPLATES:
            return self.noun(NOUN_TEMPLATES[role], name)
        if role == "affordance":
            bare = self.bare(name)
            templates = ("affordance",) if bare in self._known_verbs else ("affordance", "tool")
            return self.verb_entries(Verb(bare, templates, _constant(bare)))
        return self.verb_entries(Verb(name, ("new_act",), _constant(name)))

    def tool_acts(self) -> dict[str, str]:
        """The acts that need a tool, each with the affordance that the tool must have."""
        return {
            verb.means: self._inflection.form(verb.verb, "ing")
            for verb in self.verbs
            if verb.means and "tool" in verb.templates
        }

    def act_names(self) -> dict[str, str]:
        """What each act is called: the first verb that means it."""
        names: dict[str, str] = {}
        for verb in self.verbs:
            if verb.means:
                names.setdefault(verb.means, verb.verb)
        return names

    def tool_phrases(self) -> dict[str, str]:
        """What is done with a tool as the object: "cut with" for `cut`."""
        binder = next(
            (" ".join(entry.words) for entry in self.entries if str(entry.category) == "WITH/NP"),
            "",
        )
        return {act: f"{self.act_names()[act]} {binder}" for act in self.tool_acts()}

    @cached_property
    def only_in_turns(self) -> frozenset[str]:
        """Words that only occur in turns of phrase; they may name something new as well."""
        turns = {word for entry in self.turns for word in entry.words}
        return frozenset(turns - self.closed - {w for entry in self.entries for w in entry.words})

    @cached_property
    def degree_phrases(self) -> frozenset[tuple[str, ...]]:
        """All words of confidence."""
        return frozenset(tuple(each.split()) for said in self.qualifiers.values() for each in said)

    @property
    def _known_verbs(self) -> frozenset[str]:
        return frozenset(verb.verb for verb in self.verbs)

    def bare(self, gerund: str) -> str:
        """The verb of a gerund: "cut" for "cutting"."""
        for verb in self.verbs:
            if self._inflection.form(verb.verb, "ing") == gerund:
                return verb.verb
        return next(iter(self._inflection.origins(gerund, "ing")), gerund)

    def _filled(
        self, template: Template, word: str, names: dict[str, str], *, role: str, cost: float
    ) -> Iterator[Entry]:
        named = next((names[one] for one in _NAMING if one in template.constants), "")
        for form, frames in template.forms.items():
            tokens = tuple(self._inflection.form(word, form).split(" "))
            for frame in frames:
                term = replace_constants(frame.term, names)
                yield Entry(
                    tokens,
                    frame.category,
                    term,
                    evaluate(term),
                    self._combinator.sign(frame.category),
                    frame.cost + cost,
                    named.replace("_", " "),
                    role,
                )

    def _template(self, name: str, field: Field) -> Template:
        parts = field.entries(required=("constants", "forms"), optional=())
        constants = {
            constant: [read_type(item) for item in types.items()]
            for constant, types in parts["constants"].entries().items()
        }
        forms = {
            form: tuple(Frame(*self._grammar.entry(line, constants)) for line in lines.items())
            for form, lines in parts["forms"].entries().items()
        }
        for form, lines in parts["forms"].entries().items():
            if form != "base" and form not in self._inflection.tables:
                known = ", ".join(("base", *self._inflection.tables))
                raise lines.fail(f'there is no form "{form}"; expected one of {known}.')
        return Template(name, tuple(constants), MappingProxyType(forms))

    def _template_named(self, name: str, field: Field) -> Template:
        if name not in self.templates:
            known = ", ".join(sorted(self.templates))
            raise field.fail(f'there is no template "{name}"; expected one of {known}.')
        return self.templates[name]

    def _read_verb(self, field: Field) -> None:
        parts = field.entries(required=("verb", "templates"), optional=("means",))
        for item in parts["templates"].items():
            self._template_named(item.text(), item)
        means = parts["means"].text() if "means" in parts else None
        verb = Verb(parts["verb"].text(), parts["templates"].texts(), means)
        self.verbs.append(verb)
        self.entries += self.verb_entries(verb)

    def _read_qualifier(self, degree: str, field: Field) -> None:
        if degree not in self._grammar.signature:
            raise field.fail(f'"{degree}" is no degree of confidence.')
        template = self._template_named("qualifier", field)
        self.qualifiers[degree] = field.texts()
        for word in field.texts():
            self.entries += self._filled(template, word, {"DEG": degree}, role="", cost=0.0)

    def _word(self, field: Field) -> Iterator[Entry]:
        parts = field.entries(required=("says",), optional=("is", "like"))
        if not parts.keys() & {"is", "like"}:
            raise field.fail('expected the key "is" or "like" beside "says".')
        lines = parts["is"].items() if "is" in parts else ()
        frames = [Frame(*self._grammar.entry(line)) for line in lines]
        for name in parts["like"].items() if "like" in parts else ():
            frames += self._template_named(name.text(), name).forms["base"]
        signs = [self._combinator.sign(frame.category) for frame in frames]
        values = [evaluate(frame.term) for frame in frames]
        for says in parts["says"].items():
            for words in spellings(says):
                for frame, sign, value in zip(frames, signs, values, strict=True):
                    yield Entry(words, frame.category, frame.term, value, sign, frame.cost)

    def _construction(self, field: Field) -> Iterator[Entry]:
        parts = field.entries(required=("says", "is"), optional=())
        patterns = [(words, says) for says in parts["says"].items() for words in factored(says)]
        spelt = dict.fromkeys(pieces(words, says) for words, says in patterns)
        for line in parts["is"].items():
            category, term, cost = read_entry(line)
            heads: dict[tuple[Piece, ...], Entry] = {}
            for found in spelt:
                construction = Construction(found, category, term)
                key = construction.without_head()
                if key not in heads:
                    self._grammar.verify(*construction.to_be_checked(), line)
                    heads[key] = self._headed(construction, cost)
                head = construction.head
                if isinstance(head, Run):
                    yield heads[key]._replace(words=head.words)
        for group in {each for words, _ in patterns for each in words if isinstance(each, Group)}:
            for words in group.choices:
                yield self._plain(words, category_of(group))
        for run in {run for found in spelt for run in runs(found)[1:]}:
            yield self._plain(run.words, run.category)

    def _plain(self, words: tuple[str, ...], category: Category) -> Entry:
        """Words that only have to be there."""
        return Entry(words, category, _NOTHING, _NOTHING_VALUE, self._combinator.sign(category))

    def _headed(self, construction: Construction, cost: float) -> Entry:
        category, term = construction.functor()
        value, head = evaluate(term), construction.head
        if isinstance(head, Gap):
            self._combinator.add(Unary(head.category, category, term, value, cost))
        return Entry((), category, term, value, self._combinator.sign(category), cost)


def _constant(name: str) -> str:
    return name.replace(" ", "_")


def _entries(parts: Mapping[str, Field], key: str) -> Iterator[tuple[str, Field]]:
    if key in parts:
        yield from parts[key].entries().items()


def _items(parts: Mapping[str, Field], key: str) -> Iterator[Field]:
    if key in parts:
        yield from parts[key].items()
