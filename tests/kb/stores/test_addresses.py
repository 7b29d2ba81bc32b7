# SPDX-License-Identifier: Apache-2.0
"""Claims about where an endpoint takes queries, updates and graphs."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.kb.stores.http import PASSWORD, TOKEN, USER, parse_address
from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import StoreError


@pytest.mark.parametrize(
    ("location", "query", "update", "graphs"),
    [
        ("http://h/sparql", "http://h/sparql", "http://h/sparql", None),
        ("http://h:7878/query", "http://h:7878/query", "http://h:7878/update", None),
        ("http://h/d/query#update,data", "http://h/d/query", "http://h/d/update", "http://h/d/data"),
        ("https://h/r/kb#kb/statements", "https://h/r/kb", "https://h/r/kb/statements", None),
        ("http://h/sparql#/sparql-auth", "http://h/sparql", "http://h/sparql-auth", None),
        ("http://h/sparql#,/store", "http://h/sparql", "http://h/sparql", "http://h/store"),
        ("http://h/a#http://other/b", "http://h/a", "http://other/b", None),
    ],
)  # fmt: skip
def test_one_address_names_all(location: str, query: str, update: str, graphs: str | None):
    """What follows "#" is relative to where queries go."""
    found = parse_address(location, {})

    assert (found.query, found.update, found.graphs) == (query, update, graphs)


def test_credentials_are_taken_and_never_shown():
    """From the address, or from the environment; the shown address has none."""
    found = parse_address("http://sam:s%40fe@h/sparql", {})
    other = parse_address("http://h/sparql", {USER: "anna", PASSWORD: "secret", TOKEN: "t0ken"})

    assert (found.user, found.password, found.query) == ("sam", "s@fe", "http://h/sparql")
    assert (other.user, other.password, other.token) == ("anna", "secret", "t0ken")
    assert found.has_credentials and other.has_credentials
    assert not any(one in f"{found}{other}" for one in ("s@fe", "s%40fe", "secret", "t0ken"))


@pytest.mark.parametrize("location", ["http://", "http:///x", "https://h:port/", "ftp://h/x"])
def test_what_is_no_address_is_told(location: str):
    """The text itself is not repeated: it may hold a password."""
    with pytest.raises(StoreError, match="expected http"):
        parse_address(location, {})


@pytest.mark.parametrize("location", ["http:/h/x", "mem:", "memory:x", "sqlite:rules"])
@pytest.mark.parametrize("read_only", [True, False])
def test_mistyped_address_is_no_folder(
    location: str, read_only: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """None of that name is made."""
    monkeypatch.chdir(tmp_path)

    with pytest.raises(StoreError, match="expected memory:, a folder, or http"):
        open_store(location, read_only=read_only)

    assert not [*tmp_path.iterdir()]
