"""Spoken answers: templates from `answers.yaml`, filled with names in the form that fits.

The file lists every answer; a slot in it may ask for a form, as in `{object:a}` for "a red mug".
Forms come from the inflection of the language, and how an act is called from its verbs.
"""

import re
from bisect import bisect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeAlias

from ...ontology.confidence import distance
from ...ontology.errors import UnknownNameError
from ...ontology.yaml_reader import read_yaml
from ..lexicon.loader import LexiconBuilder
from ..semantics import meaning

Slot: TypeAlias = str | int | float | Sequence[str] | meaning.Confidence
MOST_OF_NEVER = 0.1  # the upper bound up to which a rule is said to hold never, and above it seldom

SLOT = re.compile(r"\{(\w+)(?::(\w+))?\}")
"""A slot of a template: its name, and its form if it asks for one."""
_LISTED: dict[str, str | None] = {
    **dict.fromkeys(("list", "clauses")),
    **{"those": "the", "things": "a", "kinds": "many", "acts": "to", "quotes": "quote"},
    "names": "name",
}
"""The forms for several things, each with that of one of them."""
_SLOT_FORMS = {"a", "act", "the", "be", "it", "many", "to", "done", "name", "use", *_LISTED}

PHRASES = (
    *("functional", "negative", "seldom", "possible"),  # rules on uses
    *("action", "holding", "forbidden", "seldom_by"),  # rules on holding
    *("kind", "no_kind"),  # relations of kinds
    *("robot", "must_not", "may", "only_by", "must_first", "may_without"),  # norms
    *("by_part", "in_place", "to_whom", "with_tool"),  # what is added to an act
    *("for_material", "noted", "source", "any_object", "any_with", "joined"),
    *("be", "be_many", "it", "it_many"),
)
"""The keys of the templates of rules and norms, and of small words that all answers share."""


@dataclass(frozen=True)
class AnswerTemplates:
    """The answers of one language, and the words for rules, things and acts."""

    answers: Mapping[str, str]  #: the text of each by its key, with `{slot}` or `{slot:form}`
    phrases: Mapping[str, str]  #: how rules are put into words, by `PHRASES`
    words: LexiconBuilder  #: the forms of words, and the verbs of acts
    #: the usual adverb of each confidence, empty for the default one
    adverbs: Mapping[meaning.Confidence, str]

    def say(self, key: str, **slots: Slot) -> str:
        """Return an answer with its slots filled, beginning with a capital letter.

        It raises `UnknownNameError` without such an answer, or for a slot missing or one too many.
        """
        wanted = self.slots(key)
        for name in {*wanted} ^ {*slots}:
            raise UnknownNameError(f'slot of the answer "{key}"', name, wanted)
        text = self.fill(self.answers[key], slots)
        return text[:1].upper() + text[1:]

    def offer(self, choices: Sequence[str]) -> str:
        """Return the question which of some sentences was meant; several are numbered."""
        if len(choices) == 1:
            return self.say("offer", choice=choices[0])
        numbered = (f"{number}. {each}." for number, each in enumerate(choices, start=1))
        return self.say("offers", choices=" ".join(numbered))

    def slots(self, key: str) -> tuple[str, ...]:
        """The names of the slots of an answer; `UnknownNameError` if there is no such answer."""
        if key not in self.answers:
            raise UnknownNameError("answer", key, self.answers)
        return tuple(dict.fromkeys(name for name, _ in SLOT.findall(self.answers[key])))

    def rule_phrase(self, rule: meaning.Rule) -> str:
        """Return a rule in words: "to pass a knife, grab it by the blade"."""
        said = self.phrases
        slots: dict[str, Slot] = {"object": self.noun_phrase(rule.object, rule.props)}
        at = bisect((MOST_OF_NEVER, 0.5), rule.confidence[1])
        slots["often"] = self.adverb(rule.confidence)
        if isinstance(rule, meaning.FunctionalRule):
            text = said[("negative", "seldom", "functional")[at]]
            text = said["possible"] if rule.confidence == (0, 1) else text
            slots["affordance"] = self.use_phrase(rule.affordance, rule.material)
        else:
            text = said[("forbidden", "seldom_by", "action")[at]]
            text = said["holding"] if rule.context == "grasp" else text
            slots |= {"act": self.act_with(rule.context), "part": rule.part}
        return " ".join(self.fill(text, slots).split())

    def kind_phrase(self, relation: meaning.KindRelation) -> str:
        """Return of which kind an object is in words: "a bread knife is a kind of knife"."""
        kinds: dict[str, Slot] = {"object": relation.object, "kind": relation.kind_of}
        return self.fill(self.phrases["no_kind" if relation.denies else "kind"], kinds)

    def norm_phrase(self, norm: meaning.Norm, who: str = "") -> str:
        """Return a norm in words: "I must not pass a knife to a child in the kitchen"."""
        said, act = self.phrases, self._act_phrase(norm.act)
        key = {"forbidden": "must_not", "permitted": "may"}.get(norm.norm, "only_by")
        part = getattr(norm.act, "part", None) or ""
        slots = {"who": who or said["robot"], "act": act, "part": part}
        if norm.before:
            key = "may_without" if norm.norm == "permitted" else "must_first"
            slots["first"] = self._act_phrase(norm.before)
        elif slots["part"] and norm.norm != "obliged":
            slots["act"] = self.fill(said["by_part"], slots)
        text = self.fill(said[key], slots)
        if not norm.place:
            return text
        return self.fill(said["in_place"], {"act": text, "place": norm.place})

    def _act_phrase(self, act: meaning.SimpleCommand) -> str:
        said, verb = self.phrases, self.act(act.goal)
        if isinstance(act, meaning.ToolCommand):
            is_any = act.patient == meaning.ANY_OBJECT
            patient = said["any_object"] if is_any else self._in_general(act.patient)
            if act.tool.object in {None, meaning.ANY_OBJECT} and not act.tool.props:
                return f"{verb} {patient}"
            tool = self.noun_phrase(act.tool.object or meaning.ANY_OBJECT, act.tool.props)
            return self.fill(said["with_tool"], {"act": f"{verb} {patient}", "tool": tool})
        target = self.noun_phrase(act.target.object or meaning.ANY_OBJECT, act.target.props)
        text = f"{verb} {target}"
        if act.recipient is None:
            return text
        is_role = act.recipient in self.words.nouns["human"]
        named = self.words.inflection.with_article if is_role else proper_name
        return self.fill(said["to_whom"], {"act": text, "recipient": named(act.recipient)})

    def use_phrase(self, affordance: str, *materials: str | None) -> str:
        """Return what something is used for: "cutting", "cutting bread", "painting walls"."""
        names = self.join([self._in_general(name) for name in materials if name])
        return f"{affordance} {names}".rstrip()

    def object_for(self, name: str, material: str) -> str:
        """Return an object that is used on a material: "brush for walls"."""
        slots = {"object": name, "material": self._in_general(material)}
        return self.fill(self.phrases["for_material"], slots)

    def _in_general(self, material: str) -> str:
        is_mass = not self.words.nouns["mass"].isdisjoint((material, material.rpartition(" ")[2]))
        return material if is_mass else self.words.inflection.form(material, "plural")

    def adverb(self, confidence: meaning.Confidence) -> str:
        """Return the adverb of the degree that is closest to a confidence, which may be empty."""
        return self.adverbs[min(self.adverbs, key=partial(distance, confidence))]

    def with_notes(self, what: str, often: str, speaker: str) -> str:
        """Return words with how often they hold and who said it, if given: "cutting (often)"."""
        source = self.fill(self.phrases["source"], {"speaker": speaker}) if speaker else ""
        notes = ", ".join(filter(None, (often, source)))
        return self.fill(self.phrases["noted"], {"what": what, "notes": notes}) if notes else what

    def noun_phrase(self, name: str, props: Sequence[str] = ()) -> str:
        """Return a kind of object with its properties and the indefinite article."""
        if name != meaning.ANY_OBJECT:
            words = " ".join([*props, name])
            is_mass = name in self.words.nouns["mass"]
            return words if is_mass else self.words.inflection.with_article(words)
        if not props:
            return self.phrases["any_object"]
        return self.phrases["any_with"].replace("{props}", " ".join(props))

    def act(self, name: str) -> str:
        """Return the verb of an act: "pick up" for `pickUp`."""
        return self.words.act_names.get(name, name)

    def act_with(self, name: str) -> str:
        """Return the verb of an act on what is held: "cut with" for `cut`."""
        return self.words.tool_phrases.get(name) or self.act(name)

    def act_on(self, act: str, *objects: str, links: Sequence[str] = ()) -> str:
        """Return an act on some objects of a kind each: "swap a knife and a spoon"."""
        named = [self.noun_phrase(each) for each in objects]
        linked = [f"{link} {name}" for link, name in zip(links, named[1:], strict=False)]
        return " ".join((self.act(act), *named[:1], *linked))

    def join(self, items: Sequence[str], comma: str = "") -> str:
        """Join several items: "a knife, a mug and a shoe"; clauses have a `comma` before "and"."""
        if len(items) < 2:
            return "".join(items)
        return f"{', '.join(items[:-1])}{comma} {self.phrases['joined']} {items[-1]}"

    def fill(self, text: str, slots: Mapping[str, Slot]) -> str:
        """Fill the slots of a template."""
        return SLOT.sub(lambda found: self._form(slots[found[1]], found[2]), text)

    def _form(self, value: Slot, form: str | None) -> str:
        said, inflection, roles = self.phrases, self.words.inflection, self.words.nouns["human"]
        plural = inflection.is_plural_only
        forms: Mapping[str, Callable[[str], str]] = {
            "a": self.noun_phrase,
            "the": lambda word: f"the {word}",
            "be": lambda word: said["be_many" if plural(word) else "be"],
            "it": lambda word: said["it_many" if plural(word) else "it"],
            "many": lambda word: inflection.form(word, "plural"),
            "act": self.act_with,
            "to": self.act,
            "done": lambda word: inflection.form(self.act(word), "participle"),
            "name": lambda who: f"the {who}" if who in roles else proper_name(who),
            "quote": lambda text: f'"{text.removesuffix(".")}"',
        }
        if form == "use":
            return value if isinstance(value, str) else self.use_phrase(*map(str, _items(value)))
        if form in _LISTED:
            comma = "," if form == "clauses" else ""
            return self.join([self._form(str(e), _LISTED[form]) for e in _items(value)], comma)
        return forms[form](str(value)) if form else str(value)


def proper_name(person: str) -> str:
    """Return the name of a person with capital letters.

    >>> proper_name("zoë ünal"), proper_name("Ada de la Cruz")
    ('Zoë Ünal', 'Ada de la Cruz')
    """
    return person.title() if person.islower() else person[:1].upper() + person[1:]


def load_answers(
    path: Path, words: LexiconBuilder, adverbs: Mapping[meaning.Confidence, str]
) -> AnswerTemplates:
    """Load the answers of a language; `DataError` where the file or a form in it is wrong."""
    entries = read_yaml(path).entries(required=("answers", "phrases"), optional=())
    phrases = entries["phrases"].entries(required=PHRASES, optional=())
    answers = entries["answers"].entries()
    for field in answers.values():
        for _, form in SLOT.findall(field.text()):
            if form and form not in _SLOT_FORMS:
                known = ", ".join(sorted(_SLOT_FORMS))
                raise field.fail(f'there is no form "{form}"; expected one of {known}.')
    texts, said = ({key: f.text() for key, f in each.items()} for each in (answers, phrases))
    return AnswerTemplates(texts, said, words, adverbs)


def _items(value: Slot) -> Sequence[object]:
    return (value,) if isinstance(value, (str, int, float)) else value
