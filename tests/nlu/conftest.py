"""What the tests of the language part share."""

from __future__ import annotations

import pytest

from hilt.nlu import Language


@pytest.fixture(scope="session")
def language() -> Language:
    """English with the household words."""
    return Language.load()
