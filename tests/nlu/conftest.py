"""What the tests of the language part share."""

from __future__ import annotations

from typing import cast

import pytest

from hilt.nlu import Language
from hilt.nlu.grammar.notation import parse
from hilt.nlu.grammar.terms import Term
from hilt.ontology.yaml_reader import YamlNode


@pytest.fixture(scope="session")
def language() -> Language:
    """English with the household words."""
    return Language.load()


def parse_term(text: str) -> Term:
    """The lambda term that a text stands for."""
    return cast("Term", parse(YamlNode(text, "<text>", 1, 0), "term"))
