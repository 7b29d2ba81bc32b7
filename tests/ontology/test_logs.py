"""Claims about log messages."""

import logging

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.ontology.logs import MOST_CHARACTERS, shown, timed


def test_time_of_a_block_is_logged_when_somebody_listens(caplog: pytest.LogCaptureFixture):
    """The message says what was done, with which details, and how long it took."""
    with timed("hilt.test", "unheard"):
        pass
    caplog.set_level(logging.DEBUG, logger="hilt")

    with timed("hilt.test", "look for %s", "a knife"):
        pass

    (message,) = caplog.messages
    assert message.startswith("look for a knife [")
    assert message.endswith(" ms]")


def test_block_that_fails_is_logged_too(caplog: pytest.LogCaptureFixture):
    """The error goes on to the caller."""
    caplog.set_level(logging.DEBUG, logger="hilt")

    with pytest.raises(ValueError, match="no"), timed("hilt.test", "try"):
        raise ValueError("no")

    assert caplog.messages[0].startswith("try [")


@given(st.text(st.characters(min_codepoint=0x21, max_codepoint=0x7E, exclude_characters='<>"')))
def test_credentials_of_an_address_are_not_shown(password: str):
    """Whatever the password holds, what stands before the "@" is replaced."""
    assert shown(f"open http://anna:{password}@host/kb") == "open http://***@host/kb"


def test_text_for_a_log_is_one_short_line():
    """Lines are joined, comments of SPARQL left out, and long texts cut."""
    assert shown("# all of it\nASK {\n  ?s ?p ?o }") == "ASK { ?s ?p ?o }"
    assert len(shown("x" * 10_000)) == MOST_CHARACTERS
