# SPDX-License-Identifier: Apache-2.0
"""Inflection: how the words of a language change their form, by rules that are data.

A table per form ("plural", "ing", ...) has irregular words and then patterns, of which the first
that fits is used. The same tables run backwards find the dictionary form of a word never heard.
Of a multi-word verb the first word changes ("picking up"), of a noun the last ("wine glasses").
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

from ...ontology.errors import UnknownNameError
from ...ontology.yaml_reader import Field, read_yaml

VERB_FORMS = ("third", "ing", "participle")

Rule: TypeAlias = tuple[re.Pattern[str], str]


@dataclass(frozen=True)
class FormTable:
    """How one form is made.

    Attributes:
        irregular: words that follow no rule.
        rules: (pattern, replacement), the first that is found in the word counts.
        backwards: (pattern, replacement), guesses of the word from the form.
    """

    irregular: Mapping[str, str]
    rules: tuple[Rule, ...]
    backwards: tuple[Rule, ...] = ()

    def of(self, word: str) -> str:
        """This form of one word."""
        if word in self.irregular:
            return self.irregular[word]
        for pattern, replacement in self.rules:
            if pattern.search(word):
                return pattern.sub(replacement, word, count=1)
        return word

    def origins(self, form: str) -> list[str]:
        """The words whose form this may be, the likeliest first."""
        irregular = [word for word, changed in self.irregular.items() if changed == form]
        if irregular:
            return irregular
        guesses = [
            pattern.sub(replacement, form, count=1)
            for pattern, replacement in self.backwards
            if pattern.search(form)
        ]
        regular = (guess for guess in guesses if guess != form and self.of(guess) == form)
        return list(dict.fromkeys(regular))

    def choice(self, word: str) -> str:
        """The replacement of the first rule that fits, alone."""
        return next(
            (found for pattern, found in self.rules if pattern.search(word)), self.rules[-1][1]
        )


@dataclass(frozen=True)
class Inflection:
    """All forms of one language.

    Attributes:
        tables: by the name of the form.
    """

    tables: Mapping[str, FormTable]

    def form(self, word: str, form: str) -> str:
        """A form of a word; `base` is the word itself.

        Raises:
            UnknownNameError: the language has no such form.
        """
        if form == "base":
            return word
        if form not in self.tables:
            raise UnknownNameError("form", form, self.tables)
        words = word.split(" ")
        place = 0 if form in VERB_FORMS else -1
        words[place] = self.tables[form].of(words[place])
        return " ".join(words)

    def origins(self, word: str, form: str) -> list[str]:
        """The words that `word` may be this form of, the likelier first."""
        return self.tables[form].origins(word)

    def with_article(self, words: str) -> str:
        """A noun phrase with its indefinite article: "a mug", "an egg"."""
        return f"{self.tables['article'].choice(words)} {words}"


def load_inflection(path: Path) -> Inflection:
    """Read the tables of a language.

    Raises:
        DataError: the file is not as expected; says where.
    """
    tables = {name: _table(field) for name, field in read_yaml(path).entries().items()}
    return Inflection(MappingProxyType(tables))


def _table(field: Field) -> FormTable:
    entries = field.entries(required=("rules",), optional=("irregular", "origins"))
    irregular = entries["irregular"].entries() if "irregular" in entries else {}
    backwards = entries["origins"].items() if "origins" in entries else ()
    return FormTable(
        MappingProxyType({word: form.text() for word, form in irregular.items()}),
        tuple(_rule(rule) for rule in entries["rules"].items()),
        tuple(_rule(rule) for rule in backwards),
    )


def _rule(field: Field) -> Rule:
    pattern, replacement = (str(item.value) for item in field.items())
    try:
        return re.compile(pattern), replacement
    except re.error as error:
        raise field.fail(f"expected a regular expression: {error}.") from error
