"""Inflection: the forms of words, by rules that are data.

Each form ("plural", "ing", ...) has a table of irregular words and of patterns, of which the first
that matches is used. Applied backwards, a table gives the dictionary form of an unknown word.
The first word of a multi-word verb changes ("picking up"), the last of a noun ("wine glasses").
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from ...ontology.errors import UnknownNameError
from ...ontology.yaml_reader import YamlNode, read_yaml

VERB_FORMS = ("third", "ing", "participle")

Rule: TypeAlias = tuple[re.Pattern[str], str]


@dataclass(frozen=True)
class FormTable:
    """The irregular words and the rules (pattern, replacement) of one form.

    The first rule applies whose pattern is found in the word; those `backwards` guess the word.
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
        """The words that may have this form, the likeliest first."""
        irregular = [word for word, changed in self.irregular.items() if changed == form]
        if irregular or form in self.irregular:  # "lens" is no plural of "len"
            return irregular
        guesses = dict.fromkeys(
            pattern.sub(replacement, form, count=1) for pattern, replacement in self.backwards
        )
        return [guess for guess in guesses if guess != form and self.of(guess) == form]

    def choice(self, word: str) -> str:
        """The replacement of the first rule that matches, without the word."""
        found = (replacement for pattern, replacement in self.rules if pattern.search(word))
        return next(found, self.rules[-1][1])


@dataclass(frozen=True, eq=False)
class Inflection:
    """The tables of all forms of a language, by name."""

    tables: Mapping[str, FormTable]

    def form(self, word: str, form: str) -> str:
        """A form of a word, `base` for the word itself; `UnknownNameError` for an unknown form."""
        if form == "base":
            return word
        if form not in self.tables:
            raise UnknownNameError("form", form, self.tables)
        words = word.split(" ")
        place = 0 if form in VERB_FORMS else -1
        words[place] = self.tables[form].of(words[place])
        return " ".join(words)

    def origins(self, word: str, form: str) -> list[str]:
        """The words of which `word` may be this form, the likeliest first."""
        return self.tables[form].origins(word)

    def is_plural_only(self, words: str) -> bool:
        """Whether a noun phrase names what is one thing in the plural, like "red scissors"."""
        return any(self.tables["plural"].irregular.get(word) == word for word in words.split(" "))

    def with_article(self, words: str) -> str:
        """A noun phrase with its indefinite article, if it has one: "a mug", "an egg"."""
        if self.is_plural_only(words):
            return words
        return f"{self.tables['article'].choice(words)} {words}"


def load_inflection(path: Path) -> Inflection:
    """Read the tables of a language; `DataError` says where the file is not as expected."""
    tables: dict[str, FormTable] = {}
    for name, field in read_yaml(path).entries().items():
        entries = field.entries(required=("rules",), optional=("irregular", "origins"))
        irregular = entries["irregular"].entries() if "irregular" in entries else {}
        backwards = entries["origins"].items() if "origins" in entries else ()
        forms = {word: form.text() for word, form in irregular.items()}
        rules = tuple(map(_rule, entries["rules"].items()))
        tables[name] = FormTable(forms, rules, tuple(map(_rule, backwards)))
    return Inflection(tables)


def _rule(field: YamlNode) -> Rule:
    pattern, replacement = (str(item.value) for item in field.items())
    try:
        return re.compile(pattern), replacement
    except re.error as error:
        raise field.fail(f"expected a regular expression: {error}.") from error
