"""Shapes of parameters."""

from __future__ import annotations

from typing import Literal

from server.schemas.base import ParameterValue, Schema
from slam.params import Effect


class ParameterChoice(Schema):
    """A value that a parameter may have, where only a few are right."""

    value: int | str
    label: str


class Parameter(Schema):
    """A registered parameter with its value in this map."""

    name: str
    group: str
    type: Literal["bool", "int", "float", "text"]
    default: ParameterValue
    value: ParameterValue
    unit: str
    minimum: float | None
    maximum: float | None
    choices: list[ParameterChoice]
    """All values, where only a few are right; empty otherwise."""
    meaning: str
    effect: Effect
    front: bool
    """One of the dozen that matter first."""


class ParameterSet(Schema):
    """All parameters of a map."""

    parameters: list[Parameter]
    unused: dict[str, str]
    """Names stored in the file that slamdeck doesn't use."""
    live: bool
    """Whether they can be changed now."""


class ParameterChanges(Schema):
    """New values by name."""

    changes: dict[str, ParameterValue]
