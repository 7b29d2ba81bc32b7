# SPDX-License-Identifier: Apache-2.0
"""The grammar for a speech recogniser allows only what is understood."""

from __future__ import annotations

import random
import re

import pytest

from hilt.nlu import Language
from hilt.nlu.jsgf import HEADER, grammar_of

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
