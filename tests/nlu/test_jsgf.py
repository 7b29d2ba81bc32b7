"""The grammar for a speech recogniser allows only what is understood."""

from __future__ import annotations

import random
import re

import pytest

from hilt.nlu import Language
from hilt.nlu.jsgf import HEADER, grammar_of, sentences

RULE = re.compile(r"^(?:public )?<(\w+)> = (.*);$", re.MULTILINE)


def expanded(text: str, rules: dict[str, str], rng: random.Random) -> str:
    """One sentence of the grammar, by chance."""
    text = re.sub(r"\[([^\]]*)\]", lambda found: rng.choice(["", found[1]]), text)
    return re.sub(
        r"<(\w+)>",
        lambda found: expanded(rng.choice(rules[found[1]].split(" | ")), rules, rng),
        text,
    )


def test_every_rule_is_there(language: Language) -> None:
    """No rule is used that the grammar does not have."""
    text = grammar_of(language)

    rules = dict(RULE.findall(text))

    assert text.startswith(HEADER)
    assert {name for body in rules.values() for name in re.findall(r"<(\w+)>", body)} <= {*rules}


@pytest.mark.parametrize("seed", range(20))
def test_what_the_grammar_allows_is_understood(language: Language, seed: int) -> None:
    """Sentences by chance are never errors."""
    rules = dict(RULE.findall(grammar_of(language)))
    rng = random.Random(seed)  # noqa: S311 - no secret

    texts = [expanded("<utterance>", rules, rng) for _ in range(20)]

    assert [text for text in texts if language.understand(text).kind == "error"] == []


def test_plurals_are_words(language: Language) -> None:
    """No plural of a plural, and none of what is not counted."""
    rules = dict(RULE.findall(grammar_of(language)))

    assert not re.search(r"\b\w*(ss|[^o]os)s?\b", rules["objects"].replace("glasses", ""))
    assert "legss" not in rules["part"]
    assert not {"a", "an"} & {*rules}


def test_articles_fit(language: Language) -> None:
    """A vowel has "an" before it, anything else "a"."""
    rules = dict(RULE.findall(grammar_of(language)))

    for name in (*rules["an_object"].split(" | "), *rules["a_property"].split(" | ")):
        article, word = name.split(" ", 1)
        assert (article == "an") == (word[0] in "aeiou")


def test_adverbs_are_one_for_each_degree(language: Language) -> None:
    """Not all adverbs of the lexicon are in the grammar."""
    rules = dict(RULE.findall(grammar_of(language)))

    assert len(rules["often"].split(" | ")) <= len(language.builder.qualifiers)


def test_sentences_are_drawn_from_a_seed_and_understood(language: Language) -> None:
    """The same seed gives the same sentences, all of which are understood."""
    first, again = (list(sentences(language, 200, random.Random(7))) for _ in range(2))  # noqa: S311

    assert first == again
    assert [text for text in first if language.understand(text).kind == "error"] == []
