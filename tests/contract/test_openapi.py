"""The API's description is complete enough to make the page's types from, and the same each time."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

from server.app import create_app
from server.openapi import openapi_text
from server.settings import Settings

DESCRIPTION: dict[str, Any] = json.loads(openapi_text())
OPERATIONS = [
    (f"{method.upper()} {path}", operation)
    for path, methods in DESCRIPTION["paths"].items()
    for method, operation in methods.items()
]


def test_it_is_the_same_each_time_and_knows_nothing_of_this_machine() -> None:
    assert openapi_text() == openapi_text()
    assert "/tmp" not in openapi_text() and "/home" not in openapi_text()


@pytest.mark.parametrize(("name", "operation"), OPERATIONS, ids=[name for name, _ in OPERATIONS])
def test_every_operation_is_named_typed_and_says_its_errors(name: str, operation: dict[str, Any]) -> None:
    assert re.fullmatch(r"[a-z]+(_[a-z]+)+", operation["operationId"]), name
    assert operation["description"].endswith(".")
    for status in ("401", "403", "404", "409", "422"):
        schema = operation["responses"][status]["content"]["application/json"]["schema"]
        assert schema == {"$ref": "#/components/schemas/ErrorBody"}
    answers = operation["responses"]["200"]["content"]
    for kind, answer in answers.items():
        is_file = kind != "application/json" and answer.get("schema") == {"type": "string", "format": "binary"}
        assert kind.startswith(("image/", "text/")) or is_file or "$ref" in answer["schema"], name


def test_names_of_operations_are_unique() -> None:
    names = [operation["operationId"] for _, operation in OPERATIONS]
    assert len(names) == len(set(names))


def test_shapes_have_no_unknown_parts() -> None:
    for name, schema in DESCRIPTION["components"]["schemas"].items():
        for field, part in schema.get("properties", {}).items():
            assert part.keys() & {"type", "$ref", "anyOf", "allOf", "enum", "const"}, f"{name}.{field} is untyped"


def test_routes_that_the_page_relies_on() -> None:
    app = create_app(Settings(roots=()))
    paths = set(app.openapi()["paths"])
    assert {"/api/maps/{map}/graph", "/api/session/{command}", "/api/scene/{map}", "/api/maps/{map}/loops"} <= paths
