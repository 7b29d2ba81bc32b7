"""Claims about the package as a whole."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import subprocess
import sys

import pytest

import hilt.kb
import hilt.ontology.vocabulary

MODULES = [f"hilt.kb.{module.name}" for module in pkgutil.walk_packages(hilt.kb.__path__)]


@pytest.mark.parametrize("name", ["hilt.kb", "hilt.ontology.vocabulary", *MODULES])
def test_examples_in_docstrings_are_true(name: str):
    """Every example in a docstring gives what it shows."""
    assert doctest.testmod(importlib.import_module(name)).failed == 0


def test_every_public_name_is_there():
    """`__all__` is sorted and complete, the lazy one included."""
    assert all(getattr(hilt.kb, name) for name in hilt.kb.__all__)
    with pytest.raises(AttributeError):
        _ = hilt.kb.Nonsense


def test_values_do_not_bring_the_engine():
    """Who needs intervals and rules only does not pay for stores, RDF libraries or numpy."""
    program = "import sys, hilt.kb; print(sorted({'pyoxigraph','rdflib','numpy'} & {*sys.modules}))"

    said = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    ).stdout

    assert said == "[]\n"


def test_base_does_not_bring_the_validator():
    """The libraries for it are loaded when something is validated, not when a base is opened."""
    program = (
        "import sys; from hilt.kb import KnowledgeBase; KnowledgeBase.open('memory:')\n"
        "print(sorted({'pyshacl','rdflib','networkx','numpy','yaml'} & {*sys.modules}))"
    )

    said = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    ).stdout

    assert said == "[]\n"
