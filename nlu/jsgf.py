# SPDX-License-Identifier: Apache-2.0
"""Grammar of a language for speech recognisers, in the JSpeech Grammar Format (W3C 2000).

It has the sentences that Hilt itself generates, with every name in every slot that it fits, so that
every text that a recogniser finds with it is understood. Hilt understands many other texts, too.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from .generation.templates import SLOT
from .language import Language

HEADER = "#JSGF V1.0 UTF-8;\ngrammar hilt;\n"

_SILENT = re.compile(r"[.,?!]")

# Names come from the entries of the lexicon: the rule, and the categories of its entries.
_NAMES: Mapping[str, frozenset[str]] = {
    "object": frozenset({"N"}),
    "objects": frozenset({"NS"}),
    "part": frozenset({"P"}),
    "affordance": frozenset({"K"}),
    "property": frozenset({"AP"}),
    "person": frozenset({"RN"}),
}

# What stands in a slot of `sentences.yaml`, by its name, or by name and form.
_FILLED: Mapping[str, str] = {
    "thing": "<article> [<property>] <object>",
    "object": "<object>",
    "object:a": "<article> <object>",
    "object:many": "<objects>",
    "patient": "<object>",
    "affordance": "<affordance>",
    "used_for": "<affordance>",
    "not_used_for": "<affordance>",
    "part": "<part>",
    "act": "<act>",
    "context:act": "<act>",
    "context:to": "<act>",
    "often": "[<often>]",
    "props": "[<property>]",
    "recipient:name": "<person>",
    "speaker:name": "<person>",
    "target": "<target>",
    "rule": "<rule>",
    "command": "<act> <target>",
}

# The acts of a command, by the first word of its shape; of all other shapes any act.
_ACTS: Mapping[str, str] = {"give": "<giving>", "patient": "<tool_act>"}


def grammar_of(language: Language) -> str:
    """Return the grammar of a language with the words that it knows now."""
    sections = language.realizer.sentences
    kinds = ("rule", "command", "question", "reply")
    lines = [HEADER, f"public <utterance> = {_either(f'<{kind}>' for kind in kinds)};"]
    rules = [sections["rules"][key] for key in ("functional", "action")]
    replies = (*sections["replies"].values(), sections["rules"]["last_taken_back"])
    lines += [
        _rule("rule", map(_filled, rules)),
        _rule("command", _commands(sections["commands"])),
        _rule("question", map(_filled, sections["questions"].values())),
        _rule(
            "reply",
            map(_filled, replies),
        ),
        _rule("target", _targets(sections["targets"])),
        _rule(
            "often", sorted(word for each in language.builder.qualifiers.values() for word in each)
        ),
        _rule("act", sorted({*language.answers.acts.values()} - {*_tools(language)})),
        _rule("giving", [language.answers.act(language.realizer.giving)]),
        _rule("tool_act", sorted(_tools(language))),
        _rule("article", sorted({"a", "an", "the"} & language.known_words)),
    ]
    lines += [_rule(name, _names(language, kinds)) for name, kinds in _NAMES.items()]
    return "\n".join(line for line in lines if line) + "\n"


def _commands(templates: Mapping[str, str]) -> Iterator[str]:
    for shape, text in templates.items():
        yield _filled(text).replace("<act>", _ACTS.get(shape.split()[0], "<act>"))


def _targets(templates: Mapping[str, str]) -> Iterator[str]:
    for shape, text in templates.items():
        # Something that has no property at all would be anything.
        filled = _filled(text)
        yield filled.replace("[<property>]", "<property>") if shape == "props" else filled


def _tools(language: Language) -> Iterator[str]:
    return (language.answers.act(name) for name in language.builder.tool_acts())


def _filled(template: str) -> str:
    def slot(found: re.Match[str]) -> str:
        return _FILLED.get(f"{found[1]}:{found[2]}") or _FILLED[found[1]]

    return " ".join(_SILENT.sub(" ", SLOT.sub(slot, template)).split())


def _names(language: Language, kinds: frozenset[str]) -> list[str]:
    return sorted(word for kind in kinds for word in language.lexicon.names.get(kind, ()))


def _rule(name: str, choices: Iterable[str]) -> str:
    listed = _either(choices)
    return f"<{name}> = {listed};" if listed else ""


def _either(choices: Iterable[str]) -> str:
    return " | ".join(dict.fromkeys(choices))
