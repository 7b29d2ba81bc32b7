# SPDX-License-Identifier: Apache-2.0
"""Where an endpoint takes queries, updates and whole graphs, from one address.

`http://host/path` is where queries go. What follows a `#` says where updates go and, behind a
comma, where the Graph Store Protocol is spoken; both relative to the query address:

    http://host:3030/ds/query#update,data         Fuseki: /ds/update and /ds/data
    http://host:7200/repositories/kb#kb/statements    GraphDB

Without `#` updates go where queries go, but to `.../update` where queries go to `.../query`.
Credentials stand in the address (`http://name:password@host/...`) or in the environment, and are
never shown.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from urllib.parse import SplitResult, unquote, urldefrag, urljoin, urlsplit, urlunsplit

from ...ontology.errors import StoreError

USER, PASSWORD, TOKEN = "HILT_KB_USER", "HILT_KB_PASSWORD", "HILT_KB_TOKEN"


@dataclass(frozen=True)
class Address:
    """The addresses of one endpoint, and who asks.

    Attributes:
        query: where queries go; without credentials, as it is shown.
        update: where updates go.
        graphs: where whole graphs are put (Graph Store Protocol); None where that is not known.
        is_update_given: whether somebody said where updates go.
        user: name for basic or digest authentication; empty for none.
        password: the password of that name.
        token: for bearer authentication; empty for none.
    """

    query: str
    update: str
    graphs: str | None = None
    is_update_given: bool = False
    user: str = ""
    password: str = field(default="", repr=False)
    token: str = field(default="", repr=False)

    @property
    def has_credentials(self) -> bool:
        """Whether there is anything to log in with."""
        return bool(self.user or self.token)


def parse_address(location: str, environment: Mapping[str, str] | None = None) -> Address:
    """The addresses that a location stands for.

    >>> found = parse_address("http://localhost:3030/ds/query#update,data", {})
    >>> found.update, found.graphs
    ('http://localhost:3030/ds/update', 'http://localhost:3030/ds/data')

    Args:
        location: what was given to `--kb`.
        environment: where credentials are looked up; the process's by default.

    Raises:
        StoreError: it is no http or https address.
    """
    known = os.environ if environment is None else environment
    bare, fragment = urldefrag(location)
    parts = _split(bare)
    query = urlunsplit((parts.scheme, parts.netloc.rpartition("@")[2], parts.path, parts.query, ""))
    update, _, graphs = (one.strip() for one in fragment.partition(","))
    return Address(
        query,
        urljoin(query, update) if update else _update_beside(query),
        urljoin(query, graphs) if graphs else None,
        bool(update),
        unquote(parts.username or "") or known.get(USER, ""),
        unquote(parts.password or "") or known.get(PASSWORD, ""),
        known.get(TOKEN, ""),
    )


def _split(location: str) -> SplitResult:
    try:
        parts = urlsplit(location)
        valid = parts.scheme in {"http", "https"} and bool(parts.hostname) and parts.port != 0
    except ValueError:
        parts, valid = urlsplit(""), False
    if not valid:
        # Not shown: what cannot be read may hold a password all the same.
        raise StoreError("The address of the endpoint is none: expected http(s)://host:port/path.")
    return parts


def _update_beside(query: str) -> str:
    is_query = urlsplit(query).path.endswith("/query")
    return query.removesuffix("query") + "update" if is_query else query
