"""Access tokens: in whose name something is asked, and what that one may do.

A token is `hilt_` and 32 random bytes. Kept is its SHA-256, in a file that only its owner can read,
beside the base and never in it: readers can query the graph.
"""

import hmac
import secrets
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime, timedelta, timezone
from hashlib import sha256
from pathlib import Path
from typing import Any

from filelock import FileLock
from pydantic import TypeAdapter

from ...kb.rule import check_speaker
from ...ontology.disk_cache import write_atomically
from ...ontology.errors import DataError, NotFoundError, UnknownNameError

ROLES = ("reader", "teacher", "operator", "admin")
OWNER_ONLY = 0o600  # the mode of files that nobody else can read
_NOTED = timedelta(minutes=1)  # between two notes of the last use


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
    """What is kept of a token."""

    id: str
    name: str
    speaker: str
    roles: tuple[str, ...]
    digest: str  # its SHA-256, in hexadecimal digits
    expires: datetime | None = None  # None for never
    used: datetime | None = None  # last, up to a minute; None for never

    @property
    def is_valid(self) -> bool:
        """Whether it has not ended."""
        return self.expires is None or self.expires > _now()

    @property
    def caller(self) -> Caller:
        """Who asks with it."""
        return Caller(self.id, self.speaker, frozenset(self.roles))

    def as_json(self) -> dict[str, Any]:
        """One entry of `hilt token list --json`."""
        return TypeAdapter(AccessToken).dump_python(self, mode="json", exclude={"digest"})


_TOKENS = TypeAdapter(list[AccessToken])


class TokenFile:
    """The tokens of one base, in a file that other processes may change; None for the memory."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._read: tuple[float, list[AccessToken]] = (0, [])

    def tokens(self) -> list[AccessToken]:
        """The tokens, oldest first; DataError if the file is damaged."""
        changed = self._path.stat().st_mtime_ns if self._path and self._path.exists() else 0
        if self._path and changed != self._read[0]:
            try:
                self._read = changed, _TOKENS.validate_json(self._path.read_bytes())
            except ValueError as error:
                raise DataError("is no list of tokens.", source=str(self._path)) from error
        return [*self._read[1]]

    def add(
        self, name: str, speaker: str, roles: Sequence[str], lasts: timedelta | None = None
    ) -> tuple[AccessToken, str]:
        """Make a token that stands for a speaker; return what is kept, and the token itself.

        UnknownNameError if there is no such role; ValidationError if nobody has such a name.
        """
        check_speaker(speaker)
        for role in set(roles).difference(ROLES):
            raise UnknownNameError("role", role, ROLES)
        id_, secret = f"t{secrets.token_hex(3)}", f"hilt_{secrets.token_urlsafe(32)}"
        expires = _now() + lasts if lasts else None
        made = AccessToken(id_, name, speaker, tuple(roles), _digest(secret), expires)
        with self._changing() as tokens:
            tokens.append(made)
        return made, secret

    def remove(self, name: str) -> AccessToken:
        """Remove a token, by its id or name, and return it; UnknownNameError if there is none."""
        with self._changing() as tokens:
            if not (found := [each for each in tokens if name in {each.id, each.name}]):
                raise NotFoundError("token", name, [each.id for each in tokens])
            tokens.remove(found[0])
        return found[0]

    def find(self, secret: str) -> AccessToken | None:
        """The token that somebody shows, unless it has expired; None if there is none."""
        digest, now = _digest(secret), _now()
        known = (e for e in self.tokens() if hmac.compare_digest(e.digest, digest) and e.is_valid)
        if (found := next(known, None)) and (found.used is None or found.used < now - _NOTED):
            with self._changing() as tokens:
                tokens[:] = [replace(e, used=now) if e.id == found.id else e for e in tokens]
        return found

    @contextmanager
    def _changing(self) -> Generator[list[AccessToken]]:
        if self._path is None:
            yield self._read[1]
            return
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with FileLock(f"{self._path}.lock", mode=OWNER_ONLY):
            yield (tokens := self.tokens())
            write_atomically(self._path, _TOKENS.dump_json(tokens, indent=1), mode=OWNER_ONLY)


def _now() -> datetime:
    return datetime.now(timezone.utc).replace(microsecond=0)


def _digest(secret: str) -> str:
    return sha256(secret.encode()).hexdigest()
