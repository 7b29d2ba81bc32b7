"""Grammar of a language for speech recognisers, in the JSpeech Grammar Format (W3C 2000).

It has the sentences that Hilt itself generates, with every name in every slot that it fits, so that
every text that a recogniser finds with it is understood. Hilt understands many other texts, too.
"""

import random
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from .generation.templates import SLOT, AnswerTemplates
from .language import Language

HEADER = "#JSGF V1.0 UTF-8;\ngrammar hilt;\n"

_SILENT = re.compile(r"[.,?!]")
_OPTIONAL = re.compile(r"\[([^\]]*)\]")
_NAME = re.compile(r"<(\w+)>")

# The category of the names of each kind.
_CATEGORIES = {"object": "N", "part": "P", "affordance": "K", "property": "AP", "person": "RN"}

# What stands in a slot of `sentences.yaml`, by its name, or by name and form.
_FILLED: Mapping[str, str] = {
    "thing": "<thing>",
    **dict.fromkeys(("object", "patient", "kind_of"), "<object>"),
    "object:a": "<an_object>",
    "object:many": "<objects>",
    **dict.fromkeys(("affordance", "used_for", "not_used_for"), "<affordance>"),
    "part": "<part>",
    **dict.fromkeys(("act", "context:act", "context:to"), "<act>"),
    "often": "[<often>]",
    "props": "[<property>]",
    "property": "<property>",
    **dict.fromkeys(("recipient:name", "speaker:name"), "<person>"),
    "target": "<target>",
    "rule": "<rule>",
    "command": "<act> <target>",
}

# The acts of a command, by the first word of its shape; of all other shapes any act.
_ACTS: Mapping[str, str] = {"give": "<giving>", "patient": "<tool_act>"}

KINDS = {"command": 5, "rule": 2, "question": 2, "reply": 1}
"""The kinds of utterances, and how often people say each of them."""

_LEFT_OUT = 0.7  # how often people leave out what may be left out


def grammar_of(language: Language) -> str:
    """Return the grammar of a language with the words that it knows now."""
    lines = [
        f"<{name}> = {' | '.join(dict.fromkeys(choices))};\n"
        for name, choices in _rules(language).items()
        if choices
    ]
    return f"{HEADER}\npublic {''.join(lines)}"


def sentences(language: Language, count: int, rng: random.Random) -> Iterator[str]:
    """Sentences of the grammar by chance, as people speak.

    Commands are the commonest, few adjectives and adverbs are said, and of the words of a kind the
    first ones most often: the one at place n with a probability that goes with 1/n (Zipf).
    """
    rules = _rules(language)
    for _ in range(count):
        (kind,) = rng.choices([*KINDS], [*KINDS.values()])
        yield " ".join(_expanded(rng.choice(rules[kind]), rules, rng).split())


def _expanded(text: str, rules: Mapping[str, Sequence[str]], rng: random.Random) -> str:
    text = _OPTIONAL.sub(lambda found: "" if rng.random() < _LEFT_OUT else found[1], text)

    def chosen(found: re.Match[str]) -> str:
        choices = rules[found[1]]
        weights = [1 / place for place in range(1, len(choices) + 1)]
        return _expanded(rng.choices(choices, weights)[0], rules, rng)

    return _NAME.sub(chosen, text)


def _rules(language: Language) -> dict[str, list[str]]:
    sections, answers = language.realizer.sentences, language.answers
    an, many = language.inflection.with_article, language.inflection.form
    form = partial(_filled, answers=answers)
    said = [
        (each.says, str(each.category))
        for each in language.lexicon.senses()
        if each.says == each.name
    ]
    names = {
        name: list(dict.fromkeys(says for says, kind in said if kind == category))
        for name, category in _CATEGORIES.items()
    }
    objects = [  # not "scissors", which has no singular, nor "bread", which has no plural
        name
        for name in names["object"]
        if not (language.inflection.is_plural_only(name) or name in answers.words.nouns["mass"])
    ]
    tools = [answers.act(name) for name in language.builder.tool_acts]
    # Something that has no property at all would be anything.
    targets = dict(sections["targets"])
    targets["props"] = targets["props"].replace("{props}", "<property>")
    stated = [sections["rules"][key] for key in ("functional", "action")]
    replies = [*sections["replies"].values(), sections["rules"]["taken_back"]]
    return {
        "utterance": [f"<{kind}>" for kind in KINDS],  # the first one, which is public
        "rule": list(map(form, stated)),
        "command": [
            form(text).replace("<act>", _ACTS.get(shape.split()[0], "<act>"))
            for shape, text in sections["commands"].items()
        ],
        "question": list(map(form, sections["questions"].values())),
        "reply": list(map(form, replies)),
        "target": list(map(form, targets.values())),
        "thing": ["<an_object>", "<a_property> <object>", "the [<property>] <object>"],
        "often": [word for word in answers.adverbs.values() if word],
        "act": [act for act in dict.fromkeys(answers.words.act_names.values()) if act not in tools],
        "giving": [answers.act(language.realizer.giving)],
        "tool_act": tools,
        "object": objects,
        "an_object": list(map(an, objects)),
        "objects": [many(name, "plural") for name in objects],
        "a_property": list(map(an, names["property"])),
        **{name: names[name] for name in ("part", "affordance", "property", "person")},
    }


def _filled(template: str, answers: AnswerTemplates) -> str:
    # All things are singular here, so the words that agree with them are, too.
    agreeing = {key: answers.phrases[key] for key in ("be", "it")}

    def slot(found: re.Match[str]) -> str:
        agrees = agreeing.get(found[2] or "")
        return agrees or _FILLED.get(f"{found[1]}:{found[2]}") or _FILLED[found[1]]

    return " ".join(_SILENT.sub(" ", SLOT.sub(slot, template)).split())
