"""The one JSON shape that every refusal has for the page."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException

from server.errors import EngineError, NotFoundError, QueryError, SettingsError, UnknownMapError
from server.schemas import ErrorBody, ErrorDetail
from slam.errors import (
    DamagedRowError,
    DatabaseError,
    DecisionError,
    MapBusyError,
    OptimizationError,
    ParameterError,
    SlamError,
    SourceError,
)

#: Most special first.
_STATUS: tuple[tuple[type[SlamError], int], ...] = (
    (UnknownMapError, 404),
    (NotFoundError, 404),
    (EngineError, 409),
    (MapBusyError, 409),
    (DecisionError, 409),
    (OptimizationError, 409),
    (ParameterError, 422),
    (SourceError, 422),
    (DatabaseError, 422),
    (SettingsError, 422),
    (QueryError, 422),
)

#: What a route declares, so that the page's types know the shape of errors.
ERRORS: dict[int | str, dict[str, Any]] = {
    401: {"model": ErrorBody, "description": "No token."},
    403: {"model": ErrorBody, "description": "Asked by another site."},
    404: {"model": ErrorBody, "description": "There is none of this name or id."},
    409: {"model": ErrorBody, "description": "Not possible in the present state."},
    422: {"model": ErrorBody, "description": "Not understood, or out of bounds."},
}


def describe(error: SlamError) -> ErrorDetail:
    """The error as the page gets it."""
    status = next((status for kind, status in _STATUS if isinstance(error, kind)), 422)
    row = {}
    if isinstance(error, DamagedRowError):
        row = {"table": error.table, "row": error.row, "reason": error.reason}
    return ErrorDetail(code=code_of(type(error)), message=str(error), status=status, **row)


def code_of(kind: type[SlamError]) -> str:
    """``unknown_map`` of UnknownMapError."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", kind.__name__.removesuffix("Error")).lower()


def install_handlers(app: FastAPI) -> None:
    """Turn everything that routes raise into the one shape."""

    @app.exception_handler(SlamError)
    async def refused(request: Request, error: SlamError) -> JSONResponse:
        del request
        return error_response(describe(error))

    @app.exception_handler(HTTPException)
    async def by_status(request: Request, error: HTTPException) -> JSONResponse:
        message = f"{request.method} {request.url.path}: {error.detail}"
        return error_response(ErrorDetail(code="http_error", message=message, status=error.status_code))

    @app.exception_handler(RequestValidationError)
    async def not_valid(request: Request, error: RequestValidationError) -> JSONResponse:
        del request
        message = "; ".join(_told(found) for found in error.errors())
        return error_response(ErrorDetail(code="invalid_request", message=message, status=422))


def error_response(detail: ErrorDetail) -> JSONResponse:
    """The response of an error."""
    return JSONResponse(ErrorBody(error=detail).model_dump(), detail.status)


def _told(found: dict[str, Any]) -> str:
    where: Sequence[Any] = found["loc"]
    place = ".".join(str(part) for part in where[1:]) or str(where[0])
    return f"{place}: {found['msg'].removeprefix('Value error, ')}"
