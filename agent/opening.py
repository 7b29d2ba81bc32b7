# SPDX-License-Identifier: Apache-2.0
"""What a program opens first: objects, actions, language and knowledge base.

What comes with Hilt never changes, so it is read once. Who only opens a base does not pay for the
language, nor for eyes and hands.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from platformdirs import user_data_path

from ..kb.knowledge_base import KnowledgeBase
from ..ontology.actions import Actions, load_actions
from ..ontology.objects import Household, load_household

if TYPE_CHECKING:
    from ..nlu.language import Language

household = cache(load_household)
_actions = cache(load_actions)


def default_location() -> Path:
    """The folder of the user's own knowledge base."""
    return user_data_path("hilt") / "kb"


def language_of(kinds: Household, lexicon: Path | None = None) -> Language:
    """The language, with the names of the objects there are.

    Args:
        kinds: the objects.
        lexicon: a lexicon file of the user's own, added to that of the language.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    is_own = lexicon is not None or kinds is not household()
    return _loaded(kinds, lexicon) if is_own else _language()


@cache
def _language() -> Language:
    return _loaded(household(), None)


def _loaded(kinds: Household, lexicon: Path | None) -> Language:
    from ..nlu.language import Language
    from ..nlu.lexicon.vocabulary import household_vocabulary

    vocabulary = household_vocabulary(kinds.objects)
    return Language.load(vocabulary=vocabulary, extra_lexicon=lexicon)


def actions_with(path: Path | None) -> Actions:
    """The actions that Hilt comes with, and those of a file.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    return load_actions(path, added_to=_actions()) if path else _actions()


def open_base(
    location: str | None, kinds: Household | None = None, actions: Actions | None = None
) -> KnowledgeBase:
    """Open a knowledge base.

    Args:
        location: `memory:`, a folder, or an endpoint; None is the user's own base.
        kinds: the objects there are; Hilt's own when None.
        actions: what the robot can do, for the domain graph; what Hilt comes with when None.

    Raises:
        StoreError: it cannot be opened.
    """
    base = KnowledgeBase.open(location or default_location())
    base.load_domain((kinds or household()).objects, actions or _actions())
    return base
