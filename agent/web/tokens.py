"""Access tokens: in whose name something is asked, and what that one may do.

A token is `hilt_` and 32 random bytes. Kept is its SHA-256, in a file that only its owner can read,
beside the base and never in it: readers can query the graph.
"""

from __future__ import annotations

import hmac
import json
import os
import secrets
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from datetime import datetime, timedelta, timezone
from hashlib import sha256
from pathlib import Path
from threading import Lock
from typing import Any

from ...kb.rule import check_speaker
from ...ontology.errors import DataError, NotFoundError, UnknownNameError

ROLES = ("reader", "teacher", "operator", "admin")
PREFIX = "hilt_"
_USED = timedelta(minutes=1)  # between two notes of the last use


@dataclass(frozen=True)
class Caller:
    """Who asks: the token or session, the speaker that it stands for, and its roles."""

    id: str
    speaker: str
    roles: frozenset[str]

    def may(self, role: str) -> bool:
        """Whether it has a role; everybody reads, and an admin has all."""
        return role == "reader" or not self.roles.isdisjoint({role, "admin"})


@dataclass(frozen=True)
class AccessToken:
    """What is kept of a token.

    Attributes:
        digest: the SHA-256 of the token, in hexadecimal digits.
        expires: when it ends, as an ISO time; None for never.
        used: when it was used last, up to a minute; None for never.
    """

    id: str
    name: str
    speaker: str
    roles: tuple[str, ...]
    digest: str
    expires: str | None = None
    used: str | None = None

    @property
    def is_expired(self) -> bool:
        """Whether it has ended."""
        return self.expires is not None and datetime.fromisoformat(self.expires) <= _now()

    @property
    def caller(self) -> Caller:
        """Who asks with it."""
        return Caller(self.id, self.speaker, frozenset(self.roles))

    def as_json(self) -> dict[str, Any]:
        """One entry of `hilt token list --json`."""
        return {key: value for key, value in asdict(self).items() if key != "digest"}


class TokenFile:
    """The tokens of one base, in a file that other processes may change; None for the memory."""

    def __init__(self, path: Path | None) -> None:
        self._path, self._lock = path, Lock()
        self._read: tuple[float, list[AccessToken]] = (-1.0, [])

    def tokens(self) -> list[AccessToken]:
        """The tokens, oldest first; DataError if the file is damaged."""
        changed = self._path.stat().st_mtime_ns if self._path and self._path.exists() else 0
        if self._path and changed != self._read[0]:
            self._read = (changed, _parse(self._path) if changed else [])
        return [*self._read[1]]

    def add(
        self, name: str, speaker: str, roles: Sequence[str], lasts: timedelta | None = None
    ) -> tuple[AccessToken, str]:
        """Make a token that stands for a speaker; return what is kept, and the token itself.

        UnknownNameError if there is no such role; ValidationError if nobody has such a name.
        """
        check_speaker(speaker)
        for role in roles:
            if role not in ROLES:
                raise UnknownNameError("role", role, ROLES)
        secret = PREFIX + secrets.token_urlsafe(32)
        expires = (_now() + lasts).isoformat() if lasts else None
        kept = (f"t{secrets.token_hex(3)}", name, speaker, tuple(roles), _digest(secret), expires)
        with self._changing() as tokens:
            tokens.append(made := AccessToken(*kept))
        return made, secret

    def remove(self, id: str) -> AccessToken:  # noqa: A002 - its name in JSON
        """Remove a token, by its id or name; UnknownNameError if there is none."""
        with self._changing() as tokens:
            found = [each for each in tokens if id in {each.id, each.name}]
            if not found:
                raise NotFoundError("token", id, [each.id for each in tokens])
            tokens.remove(found[0])
        return found[0]

    def find(self, secret: str) -> AccessToken | None:
        """The token that somebody shows, unless it has expired; None if there is none."""
        digest = _digest(secret)
        matching = [each for each in self.tokens() if hmac.compare_digest(each.digest, digest)]
        if not matching or matching[0].is_expired:
            return None
        if not matching[0].used or datetime.fromisoformat(matching[0].used) < _now() - _USED:
            with self._changing() as tokens:
                tokens[:] = [_used(each) if each.digest == digest else each for each in tokens]
        return matching[0]

    @contextmanager
    def _changing(self) -> Generator[list[AccessToken]]:
        with self._lock, _locked(self._path):
            tokens = self.tokens()
            yield tokens
            if self._path:
                _write(self._path, json.dumps([asdict(each) for each in tokens], indent=1))
            else:
                self._read = (0, tokens)


def _used(token: AccessToken) -> AccessToken:
    return replace(token, used=_now().isoformat())


def _now() -> datetime:
    return datetime.now(timezone.utc).replace(microsecond=0)


def _digest(secret: str) -> str:
    return sha256(secret.encode()).hexdigest()


def _parse(path: Path) -> list[AccessToken]:
    try:
        kept: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))
        return [AccessToken(**(each | {"roles": tuple(each["roles"])})) for each in kept]
    except (ValueError, TypeError, KeyError) as error:
        raise DataError("is no list of tokens.", source=str(path)) from error


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(text)
    beside.replace(path)


@contextmanager
def _locked(path: Path | None) -> Generator[None]:
    if path is None or os.name == "nt":
        yield
        return
    import fcntl

    path.parent.mkdir(parents=True, exist_ok=True)
    with path.with_name(f".{path.name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
