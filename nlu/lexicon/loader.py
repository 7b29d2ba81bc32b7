# SPDX-License-Identifier: Apache-2.0
"""Reader of the word files of a language, and maker of entries for the names of a vocabulary.

`LexiconBuilder` is what the file says, checked: contractions, templates, the entries of all words, and
the templates that a new noun, part, use or act gets. One line of the file may stand for hundreds
of entries, the frames and inflections of a verb: all lines are checked when they are read, and what
follows from them is worked out when it is heard.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from types import MappingProxyType

from ...ontology.yaml_reader import Field, read_yaml
from ..grammar.categories import AtomicCategory, Functor
from ..grammar.combinators import Combinator
from ..grammar.constructions import Construction, Run, pieces_of, runs
from ..grammar.grammar import Grammar, Unary
from ..grammar.notation import read_entry, read_type
from ..grammar.patterns import variants, words_in
from ..grammar.terms import Constant, evaluate
from .discourse_markers import DiscourseMarkers
from .inflection import Inflection
from .lexicon import Entry, EntryTemplate, Lexicon, Template
from .senses import ConstructionSense, TemplateSense
from .tokenizer import Tokens
from .vocabulary import ROLES, Vocabulary

NOUN_TEMPLATES = {"object": "object", "part": "part", "property": "property", "person": "person"}

_NOTHING = Constant("something")
_NOTHING_VALUE = evaluate(_NOTHING)
_BINDER = Functor(AtomicCategory("WITH"), AtomicCategory("NP"), forward=True)
_NAMING = ("USE", "ACT", "THIS")
_KEYS = (
    *("contractions", "closed", "templates", "verbs", "qualifiers", "nouns", "words"),
    *("constructions", "asides", "endings", "names_too", "denying", "denied"),
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


class LexiconBuilder:
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
        self.discourse_markers = DiscourseMarkers()
        self.endings: dict[str, str] = {}
        self.names_too: frozenset[str] = frozenset()
        self.denying: frozenset[str] = frozenset()
        self.denied: frozenset[str] = frozenset()
        self.turns = Lexicon()
        self.lexicon = Lexicon(base=self.turns)

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
        for key in ("closed", "names_too", "denying", "denied"):
            if key in parts:
                setattr(self, key, getattr(self, key) | set(parts[key].texts()))
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
                self.lexicon.add_all(self.noun(kind, name))
        for field in _items(parts, "words"):
            self._read_word(field)
        for field in _items(parts, "constructions"):
            self._read_construction(field)
        for kind, field in _entries(parts, "asides"):
            self.discourse_markers = self.discourse_markers.with_phrases(kind, field)

    def expand_endings(self, tokens: Tokens) -> Tokens:
        """An utterance with its endings that may be short for a word written out: "a shoe's"."""
        items = tuple(replace(t, word=self.endings.get(t.word, t.word)) for t in tokens.items)
        return replace(tokens, items=items)

    def verb_forms(
        self, verb: Verb, *, role: str = "", cost: float = 0.0
    ) -> Iterator[TemplateSense]:
        """What a verb is: all frames of its templates in all inflections."""
        gerund = self._inflection.form(verb.verb, "ing")
        names = {"ACT": verb.means or _constant(verb.verb), "USE": _constant(gerund)}
        for name in verb.templates:
            yield from self._filled(self.templates[name], verb.verb, names, role=role, cost=cost)

    def noun(
        self, kind: str, name: str, *, role: str = "", cost: float = 0.0
    ) -> Iterator[TemplateSense]:
        """What a noun, part, property or person is, by the name of its template."""
        template = self.templates[kind]
        yield from self._filled(template, name, {"THIS": _constant(name)}, role=role, cost=cost)

    def vocabulary(self, vocabulary: Vocabulary) -> Iterator[TemplateSense]:
        """What all names of a vocabulary are."""
        for role in ROLES:
            for name in vocabulary.names(role):
                yield from self.named(role, name)

    def named(self, role: str, name: str) -> Iterator[TemplateSense]:
        """What one name is in a role, one of `ROLES`."""
        if role in NOUN_TEMPLATES:
            return self.noun(NOUN_TEMPLATES[role], name)
        if role == "affordance":
            bare = self.bare(name)
            templates = ("affordance",) if bare in self._known_verbs else ("affordance", "tool")
            return self.verb_forms(Verb(bare, templates, _constant(bare)))
        return self.verb_forms(Verb(name, ("new_act",), _constant(name)))

    def tool_acts(self) -> dict[str, str]:
        """The acts that need a tool, each with the affordance that the tool must have."""
        acts: dict[str, str] = {}
        for verb in self.verbs:
            if verb.means and "tool" in verb.templates:
                acts.setdefault(verb.means, self._inflection.form(verb.verb, "ing"))
        return acts

    def act_names(self) -> dict[str, str]:
        """What each act is called: the first verb that means it."""
        names: dict[str, str] = {}
        for verb in self.verbs:
            if verb.means:
                names.setdefault(verb.means, verb.verb)
        return names

    def tool_phrases(self) -> dict[str, str]:
        """What is done with a tool as the object: "cut with" for `cut`."""
        senses = self.lexicon.senses()
        binder = next((sense.says for sense in senses if sense.category == _BINDER), "")
        return {act: f"{self.act_names()[act]} {binder}" for act in self.tool_acts()}

    @cached_property
    def qualifier_phrases(self) -> frozenset[tuple[str, ...]]:
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
        self,
        template: Template,
        word: str,
        names: Mapping[str, str],
        *,
        role: str = "",
        cost: float = 0.0,
    ) -> Iterator[TemplateSense]:
        named = next((names[one] for one in _NAMING if one in template.constants), "")
        name = named.replace("_", " ")
        for form, frames in template.forms.items():
            says = self._inflection.form(word, form)
            for frame in frames:
                yield TemplateSense(says, frame, names, self._combinator, name, role, cost)

    def _template(self, name: str, field: Field) -> Template:
        parts = field.entries(required=("constants", "forms"), optional=())
        constants = {
            constant: [read_type(item) for item in types.items()]
            for constant, types in parts["constants"].entries().items()
        }
        forms = {
            form: tuple(
                EntryTemplate(*self._grammar.entry(line, constants)) for line in lines.items()
            )
            for form, lines in parts["forms"].entries().items()
        }
        for form, lines in parts["forms"].entries().items():
            if form != "base" and form not in self._inflection.tables:
                known = ", ".join(("base", *self._inflection.tables))
                raise lines.fail(f'there is no form "{form}"; expected one of {known}.')
        for frame in chain.from_iterable(forms.values()):
            self._combinator.sign(frame.category)
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
        self.lexicon.add_all(self.verb_forms(verb))

    def _read_qualifier(self, degree: str, field: Field) -> None:
        if degree not in self._grammar.signature:
            raise field.fail(f'"{degree}" is no degree of confidence.')
        template = self._template_named("qualifier", field)
        self.qualifiers[degree] = field.texts()
        for word in field.texts():
            self.lexicon.add_all(self._filled(template, word, {"DEG": degree}))

    def _read_word(self, field: Field) -> None:
        parts = field.entries(required=("says",), optional=("is", "like"))
        if not parts.keys() & {"is", "like"}:
            raise field.fail('expected the key "is" or "like" beside "says".')
        lines = parts["is"].items() if "is" in parts else ()
        frames = [EntryTemplate(*self._grammar.entry(line)) for line in lines]
        for name in parts["like"].items() if "like" in parts else ():
            frames += self._template_named(name.text(), name).forms["base"]
        values = [evaluate(frame.term) for frame in frames]
        signs = [self._combinator.sign(frame.category) for frame in frames]
        for says in parts["says"].items():
            text = words_in(says)
            for frame, value, sign in zip(frames, values, signs, strict=True):
                self.lexicon.add(
                    Entry(frame.category, frame.term, value, sign, frame.cost, says=text)
                )

    def _read_construction(self, field: Field) -> None:
        parts = field.entries(required=("says", "is"), optional=())
        spelt = dict.fromkeys(
            pieces_of(variant, says) for says in parts["says"].items() for variant in variants(says)
        )
        for line in parts["is"].items():
            category, term, cost = read_entry(line)
            found = [Construction(pieces, category, term) for pieces in spelt]
            for gaps in dict.fromkeys(construction.gaps for construction in found):
                self._grammar.verify(category, term, line, self._grammar.types_of(gaps, line))
            for construction in found:
                self._add_head(construction, cost)
        for run in dict.fromkeys(run for pieces in spelt for run in runs(pieces)[1:]):
            sign = self._combinator.sign(run.category)
            self.turns.add(Entry(run.category, _NOTHING, _NOTHING_VALUE, sign, says=run.text))

    def _add_head(self, construction: Construction, cost: float) -> None:
        head, category = construction.head, construction.category
        self._combinator.sign(category)
        if isinstance(head, Run):
            self.turns.add(ConstructionSense(construction, cost, self._combinator, head.text))
        else:
            term = construction.functor()
            self._combinator.add(Unary(head.category, category, term, evaluate(term), cost))


def _constant(name: str) -> str:
    return name.replace(" ", "_")


def _entries(parts: Mapping[str, Field], key: str) -> Iterator[tuple[str, Field]]:
    if key in parts:
        yield from parts[key].entries().items()


def _items(parts: Mapping[str, Field], key: str) -> Iterator[Field]:
    if key in parts:
        yield from parts[key].items()
