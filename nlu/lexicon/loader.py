"""Loader of the word files of a language, and builder of entries for new names.

One line of a file may stand for hundreds of entries: the frames and inflections of a verb. All
lines are checked when they are read; the entries are made when their words are first heard.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import chain
from pathlib import Path
from typing import TypeAlias

from ...ontology.yaml_reader import YamlNode, read_yaml
from ..grammar import word_patterns
from ..grammar.categories import AtomicCategory, Category, Functor
from ..grammar.combinators import CombinationTable
from ..grammar.constructions import Construction, ConstructionPiece, pieces_of
from ..grammar.grammar import Grammar, UnaryRule
from ..grammar.notation import read_entry, read_type
from ..grammar.terms import Constant, Term, evaluate, replace_constants
from .discourse_markers import DiscourseMarkers
from .inflection import Inflection
from .lexicon import Entry, LazyEntry, Lexicon
from .tokenizer import Tokens
from .vocabulary import ROLES, Vocabulary

NOUN_ROLES = frozenset({"object", "part", "property", "person", "place"})
"""The roles whose names are nouns or adjectives, each with a template of its own name."""

_NOTHING = Constant("something")
_WITH = Functor(AtomicCategory("WITH"), AtomicCategory("NP"), forward=True)
_N = AtomicCategory("N")
_DETERMINERS = tuple(Functor(AtomicCategory(each), _N, forward=True) for each in ("NP", "NPG"))
_NAMING = ("USE", "ACT", "THIS")
_KEYS = (
    *("contractions", "closed", "templates", "verbs", "qualifiers", "nouns", "words"),
    *("constructions", "discourse_markers", "endings", "naming", "joining", "denying", "denied"),
    *("insisting", "classes", "varies", "homographs", "doers"),
)


Line: TypeAlias = tuple[Category, Term, float]
"""The category, term and cost of an entry."""


@dataclass(frozen=True)
class WordTemplate:
    """The lines for a kind of word, by form, with constants that are to be replaced."""

    constants: tuple[str, ...]
    forms: Mapping[str, tuple[Line, ...]]


@dataclass(frozen=True)
class Verb:
    """A verb in its bare form with particle, its templates, and the name of its act, if any."""

    verb: str
    templates: tuple[str, ...]
    means: str | None


class LexiconBuilder:
    """The words of a language, and the builder of entries for new ones."""

    def __init__(self, grammar: Grammar, inflection: Inflection, table: CombinationTable) -> None:
        self._grammar, self.inflection, self.combinator = grammar, inflection, table
        self._templates: dict[str, WordTemplate] = {}
        self._endings: dict[str, str] = {}
        #: short forms and the words that they stand for
        self.contractions: dict[str, tuple[str, ...]] = {}
        #: words of grammar (closed-class words), which are no names
        self.closed: frozenset[str] = frozenset()
        self.verbs: list[Verb] = []  #: the verbs, in the order of the files
        self.qualifiers: dict[str, tuple[str, ...]] = {}  #: the words for each degree of confidence
        self.discourse_markers = DiscourseMarkers()
        #: words after which any word may be a name, but a word of grammar
        self.naming: frozenset[str] = frozenset()
        self.doers: frozenset[str] = frozenset()  #: words after which a noun may name an act, too
        #: words of lists, after which a plural may be a name
        self.joining: frozenset[str] = frozenset()
        #: how one insists on a word that was taken for a slip of another
        self.insisting: word_patterns.Steps = ()
        self.denying: frozenset[str] = frozenset()  #: words that deny the object named after them
        #: words for any object, which `denying` words may precede
        self.denied: frozenset[str] = frozenset()
        #: words of grammar that end names of things: "watering can"
        self.homographs: frozenset[str] = frozenset()
        #: names by template, as `mass` for what is not counted ("bread"), `human` for people
        self.nouns: defaultdict[str, frozenset[str]] = defaultdict(frozenset)
        self._constructions = Lexicon()
        self.lexicon = Lexicon(base=self._constructions)  #: the entries of all files

    def read(self, path: Path) -> None:
        """Add all words of a file; `DataError` says where a line is not as expected."""
        parts = read_yaml(path).entries(optional=_KEYS)
        self._read_contractions(parts)
        for short, field in _entries(parts, "endings"):
            self._endings[short] = field.text()
        for key in ("closed", "naming", "doers", "joining", "denying", "denied", "homographs"):
            if key in parts:
                setattr(self, key, getattr(self, key) | set(parts[key].texts()))
        for name, field in _entries(parts, "templates"):
            self._templates[name] = self._template(field)
        for field in _items(parts, "verbs"):
            self._read_verb(field)
        insisting = map(word_patterns.read_patterns, _items(parts, "insisting"))
        self.insisting += tuple(chain.from_iterable(insisting))
        for degree, field in _entries(parts, "qualifiers"):
            self._read_qualifier(degree, field)
        for kind, field in _entries(parts, "nouns", self._templates):
            self.nouns[kind] |= set(field.texts())
            self.lexicon.add(chain.from_iterable(self.noun(kind, name) for name in field.texts()))
        for field in _items(parts, "words"):
            self._read_word(field)
        for field in _items(parts, "constructions"):
            self._read_construction(field)
        for name, field in _entries(parts, "classes"):
            # The spellings of a word class mean nothing of their own.
            self._add_constructions(self._spelt(field), AtomicCategory(name), _NOTHING, 0.0, field)
        for kind, field in _entries(parts, "discourse_markers"):
            self.discourse_markers = self.discourse_markers.with_phrases(kind, field)
        alone = (phrase for phrase in self.discourse_markers.anywhere if len(phrase) == 1)
        self.closed |= {word for (word,) in alone}

    def _read_contractions(self, parts: Mapping[str, YamlNode]) -> None:
        for short, field in _entries(parts, "contractions"):
            for phrase in word_patterns.expand(word_patterns.compile_pattern(short)):
                self.contractions[" ".join(phrase)] = tuple(field.text().split())
        for short, words in tuple(self.contractions.items()):
            if not short.startswith("'"):  # people leave the apostrophe out
                self.contractions.setdefault(short.replace("'", ""), words)

    def insists_on(self, word: str, words: tuple[str, ...]) -> bool:
        """Whether some words insist on one that was taken for a slip: "no, lifting"."""
        return any(
            end == len(words) and words[slice(*slots.get("WORD", (0, 0)))] in ((), (word,))
            for end, slots in word_patterns.match_pattern(self.insisting, words, 0)
        )

    def expand_endings(self, tokens: Tokens) -> Tokens:
        """Write out the ambiguous short forms of an utterance: "a shoe's" becomes "a shoe is"."""
        items = tuple(replace(t, word=self._endings.get(t.word, t.word)) for t in tokens.items)
        return replace(tokens, items=items)

    def verb_forms(self, verb: Verb, role: str = "", cost: float = 0.0) -> Iterator[LazyEntry]:
        """The senses of a verb: all lines of its templates in all inflections."""
        gerund = self.inflection.form(verb.verb, "ing")
        names = {"ACT": verb.means or _constant(verb.verb), "USE": _constant(gerund)}
        for name in verb.templates:
            yield from self._senses(name, verb.verb, names, role, cost)

    def noun(self, kind: str, name: str, role: str = "", cost: float = 0.0) -> Iterator[LazyEntry]:
        """The senses of a noun, part, property or person, by the name of its template."""
        constant = _constant(name)
        if constant in self._grammar.signature:
            constant += "_"  # a speaker that plays music is not who speaks
        yield from self._senses(kind, name, {"THIS": constant}, role, cost)

    def vocabulary(self, vocabulary: Vocabulary) -> Iterator[LazyEntry]:
        """The senses of all names of a vocabulary."""
        for role in ROLES:
            for name in vocabulary.names(role):
                yield from self.name(role, name)

    def name(self, role: str, name: str) -> Iterator[LazyEntry]:
        """The senses of a name in a role, one of `ROLES`."""
        word, templates = self._inflected(role, name)
        if role in NOUN_ROLES:
            return self.noun(templates[0], word)
        return self.verb_forms(Verb(word, templates, _constant(word)))

    def forms(self, role: str, name: str) -> list[str]:
        """All forms in which a name is said in a role, one of `ROLES`, each once."""
        word, templates = self._inflected(role, name)
        kinds = dict.fromkeys(form for each in templates for form in self._templates[each].forms)
        return list(dict.fromkeys(self.inflection.form(word, kind) for kind in kinds))

    def categories(self, role: str) -> frozenset[str]:
        """The categories of the names of things that have a role; none for acts and uses."""
        if role not in NOUN_ROLES:
            return frozenset()
        lines = chain.from_iterable(self._templates[role].forms.values())
        return frozenset(str(category) for category, _, _ in lines)

    @cached_property
    def tool_acts(self) -> Mapping[str, str]:
        """The acts that need a tool, each with the affordance that the tool must have."""
        acts: dict[str, str] = {}
        for verb in self.verbs:
            if verb.means and "tool" in verb.templates:
                acts.setdefault(verb.means, self.inflection.form(verb.verb, "ing"))
        return acts

    @cached_property
    def act_names(self) -> Mapping[str, str]:
        """What each act is called: the first verb that means it."""
        names: dict[str, str] = {}
        for verb in self.verbs:
            if verb.means:
                names.setdefault(verb.means, verb.verb)
        return names

    @cached_property
    def tool_phrases(self) -> Mapping[str, str]:
        """The words for each act whose object is the tool: "cut with" for `cut`."""
        senses = self.lexicon.senses()
        preposition = next((each.says for each in senses if each.category == _WITH), "")
        return {act: f"{self.act_names[act]} {preposition}" for act in self.tool_acts}

    def is_of_grammar(self, word: str) -> bool:
        """Whether a word is a function word: closed, or with an entry that names nothing."""
        if word in self.closed or word in self.denied:
            return True
        return any(not entry.name for entry in self.lexicon.own_entries(word))

    def is_determiner(self, word: str) -> bool:
        """Whether the name of one thing must follow a word: "a", "the"."""
        return any(each.category in _DETERMINERS for each in self.lexicon.own_entries(word))

    @cached_property
    def degree_of(self) -> Mapping[tuple[str, ...], str]:
        """The degree of confidence of each phrase for one."""
        said = self.qualifiers.items()
        return {tuple(each.split()): degree for degree, phrases in said for each in phrases}

    def bare_verb(self, gerund: str) -> str:
        """The verb of a gerund: "cut" for "cutting"."""
        known = self._verb_of.get(gerund)
        return known or next(iter(self.inflection.origins(gerund, "ing")), gerund)

    @cached_property
    def _verb_of(self) -> Mapping[str, str]:
        verbs = [verb.verb for verb in reversed(self.verbs)]
        return {self.inflection.form(verb, "ing"): verb for verb in verbs}

    def _inflected(self, role: str, name: str) -> tuple[str, tuple[str, ...]]:
        if role in NOUN_ROLES:
            return name, (role,)
        if role != "affordance":
            return name, ("new_act",)
        is_known = name in self._verb_of
        return self.bare_verb(name), ("affordance",) if is_known else ("affordance", "tool")

    def _senses(
        self, kind: str, word: str, names: Mapping[str, str], role: str, cost: float
    ) -> Iterator[LazyEntry]:
        template = self._templates[kind]
        named = next((names[one] for one in _NAMING if one in template.constants), "")
        name = named.replace("_", " ").rstrip()
        for form, lines in template.forms.items():
            says = self.inflection.form(word, form)
            for line in lines:
                make = partial(self._filled, line, names, says, cost, name=name, role=role)
                yield LazyEntry(says, line[0], name, make)

    def _filled(
        self, line: Line, names: Mapping[str, str], says: str, cost: float, **named: str
    ) -> Entry:
        category, term, own_cost = line
        term = replace_constants(term, names)
        return self._entry(category, term, own_cost + cost, says)._replace(**named)

    def _entry(self, category: Category, term: Term, cost: float, says: str) -> Entry:
        sign = self.combinator.sign(category)
        return Entry(category, term, evaluate(term), sign, cost, says=says)

    def _template(self, field: YamlNode) -> WordTemplate:
        parts = field.entries(required=("constants", "forms"), optional=())
        known_forms = ("base", *self.inflection.tables)
        constants = {
            constant: [read_type(item) for item in types.items()]
            for constant, types in parts["constants"].entries().items()
        }
        forms = {
            form: tuple(self._grammar.entry(line, constants) for line in lines.items())
            for form, lines in parts["forms"].entries(optional=known_forms).items()
        }
        for category, _, _ in chain.from_iterable(forms.values()):
            self.combinator.sign(category)
        return WordTemplate(tuple(constants), forms)

    def _read_verb(self, field: YamlNode) -> None:
        parts = field.entries(required=("verb", "templates"), optional=("means",))
        names = tuple(each.text(choices=self._templates) for each in parts["templates"].listed())
        means = parts["means"].text() if "means" in parts else None
        for item in parts["verb"].listed():
            verb = Verb(item.text(), names, means)
            self.verbs.append(verb)
            self.lexicon.add(self.verb_forms(verb))

    def _read_qualifier(self, degree: str, field: YamlNode) -> None:
        if degree not in self._grammar.signature:
            raise field.fail(f'"{degree}" is no degree of confidence.')
        words = (" ".join(each) for item in field.items() for each in word_patterns.spellings(item))
        self.qualifiers[degree] = tuple(dict.fromkeys(words))
        for word in self.qualifiers[degree]:
            self.lexicon.add(self._senses("qualifier", word, {"DEG": degree}, "", 0.0))

    def _read_word(self, field: YamlNode) -> None:
        parts = field.entries(required=("says",), optional=("is", "like"))
        if not parts.keys() & {"is", "like"}:
            raise field.fail('expected the key "is" or "like" beside "says".')
        given = parts["is"].listed() if "is" in parts else ()
        lines = [self._grammar.entry(line) for line in given]
        for name in parts["like"].listed() if "like" in parts else ():
            lines += self._templates[name.text(choices=self._templates)].forms["base"]
        for says in parts["says"].listed():
            text = word_patterns.read_words(says)
            for line in lines:
                self._add(self.lexicon, line, text)

    def _read_construction(self, field: YamlNode) -> None:
        parts = field.entries(required=("says", "is"), optional=())
        spelt = self._spelt(parts["says"])
        for line in parts["is"].listed():
            self._add_constructions(spelt, *read_entry(line), line)

    def _spelt(self, says: YamlNode) -> Iterable[tuple[ConstructionPiece, ...]]:
        spelt = dict.fromkeys(
            pieces_of(each, one) for one in says.listed() for each in word_patterns.variants(one)
        )
        kinds = ([piece.category for piece in pieces] for pieces in spelt)
        runs = ([kind for kind in each if kind.is_words][1:] for each in kinds)
        for run in dict.fromkeys(chain.from_iterable(runs)):
            self._add(self._constructions, (run, _NOTHING, 0.0), run.words)
        return spelt

    def _add_constructions(
        self,
        spelt: Iterable[tuple[ConstructionPiece, ...]],
        category: Category,
        term: Term,
        cost: float,
        line: YamlNode,
    ) -> None:
        for gaps in dict.fromkeys(tuple(each for each in pieces if each.name) for pieces in spelt):
            types = {gap.name: [self._grammar.type_of(gap.category, line)] for gap in gaps}
            self._grammar.verify(category, term, line, types)
        for construction in (Construction(pieces, category, term) for pieces in spelt):
            head, taking = construction.head.category, construction.category
            functor = construction.functor()
            if head.is_words:
                self._add(self._constructions, (taking, functor, cost), head.words)
            else:
                self.combinator.sign(taking)
                self.combinator.add(UnaryRule(head, taking, functor, evaluate(functor), cost))

    def _add(self, lexicon: Lexicon, line: Line, says: str) -> None:
        self.combinator.sign(line[0])
        lexicon.add([LazyEntry(says, line[0], "", partial(self._entry, *line, says))])


def _constant(name: str) -> str:
    return name.replace(" ", "_")


def _entries(
    parts: Mapping[str, YamlNode], key: str, known: Collection[str] | None = None
) -> Iterator[tuple[str, YamlNode]]:
    if key in parts:
        yield from parts[key].entries(optional=known).items()


def _items(parts: Mapping[str, YamlNode], key: str) -> Iterator[YamlNode]:
    if key in parts:
        yield from parts[key].items()
