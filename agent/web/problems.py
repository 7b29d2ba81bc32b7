"""Errors as `application/problem+json` (RFC 9457)."""

from typing import Any

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse

from ...ontology import errors

_KINDS: tuple[tuple[type[Exception], int, str, str], ...] = (  # the first that fits
    (errors.NotFoundError, 404, "not-found", "Not found"),
    (errors.UnknownNameError, 422, "unknown-name", "Unknown name"),
    (errors.ValidationError, 409, "invalid", "Breaks the laws of the base"),
    (errors.BusyError, 503, "busy", "Busy"),
    (errors.QueryLimitError, 400, "limit", "Stopped at its limit"),
    (errors.QueryError, 400, "query", "Cannot be asked"),
    (errors.StoreError, 503, "store", "The knowledge base cannot do that now"),
    (errors.MissingExtraError, 409, "not-installed", "Not installed"),
    (errors.SimulationError, 409, "simulation", "The simulator cannot do that"),
    (errors.HiltError, 422, "wrong", "Cannot be used"),
)
_MORE = ("source", "line", "findings")  # attributes of errors
MEDIA_TYPE = "application/problem+json"
_KEYS = {"type": "string", "title": "string", "status": "integer", "detail": "string"}
_PROPERTIES = {key: {"type": kind} for key, kind in _KEYS.items()}
_SCHEMA: dict[str, Any] = {"type": "object", "required": [*_KEYS], "properties": _PROPERTIES}
_REFUSED: dict[str, Any] = {
    "description": "A problem: what was refused, and why",
    "content": {MEDIA_TYPE: {"schema": _SCHEMA}},
}
RESPONSES: dict[int | str, dict[str, Any]] = {422: _REFUSED, "4XX": _REFUSED, "5XX": _REFUSED}


class Problem(HTTPException):
    """A refusal: the status of HTTP, a short name for programs, and a sentence for people."""

    def __init__(
        self,
        status: int,
        kind: str,
        title: str,
        detail: str,
        *,
        headers: dict[str, str] | None = None,
        **more: Any,
    ) -> None:
        super().__init__(status, detail, headers)
        self.document = {"type": f"urn:hilt:{kind}", "title": title, "status": status}
        self.document |= {"detail": detail, **more}

    @property
    def answer(self) -> JSONResponse:
        """The answer of the server, to a WebSocket too, which is not accepted."""
        return JSONResponse(self.document, self.status_code, self.headers, MEDIA_TYPE)


def forbidden(detail: str, **more: Any) -> Problem:
    """The refusal of what somebody may not do."""
    return Problem(403, "forbidden", "Not allowed", detail, **more)


def problem_of(error: Exception) -> Problem:
    """The answer to an exception of Hilt, of Starlette, or of the check of a body."""
    if isinstance(error, Problem):
        return error
    if isinstance(error, HTTPException):
        headers = dict(error.headers or {})
        return Problem(error.status_code, "http", error.detail, error.detail, headers=headers)
    if isinstance(error, RequestValidationError):
        found = [{"where": list(each["loc"]), "problem": each["msg"]} for each in error.errors()]
        detail = "; ".join(f"{'.'.join(map(str, e['where']))}: {e['problem']}" for e in found)
        return Problem(422, "wrong-form", "Not of the expected form", detail, expected=found)
    kind = next(kind for kind in _KINDS if isinstance(error, kind[0]))
    more = {name: value for name in _MORE if (value := getattr(error, name, None))}
    return Problem(*kind[1:], str(error), **more)


async def _answer(_: Request, error: Exception) -> JSONResponse:
    return problem_of(error).answer


# How an app answers every exception that is foreseen.
HANDLERS: dict[Any, Any] = dict.fromkeys(
    (HTTPException, RequestValidationError, errors.HiltError), _answer
)
