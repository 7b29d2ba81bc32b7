"""The values of the inference."""

from __future__ import annotations

from dataclasses import is_dataclass
from importlib import import_module
from pkgutil import iter_modules

import pytest

import hilt.inference

MODULES = [each.name for each in iter_modules(hilt.inference.__path__)]


@pytest.mark.parametrize("name", MODULES)
def test_values_cannot_be_changed(name: str):
    """Each dataclass of the inference is frozen, so that results can be shared and kept."""
    found = vars(import_module(f"hilt.inference.{name}")).values()
    values = [each for each in found if isinstance(each, type) and is_dataclass(each)]

    assert [each.__name__ for each in values if not each.__dataclass_params__.frozen] == []
