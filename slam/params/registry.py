"""What a parameter is: default, unit, bounds, meaning, and when a change takes effect."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

Value = bool | int | float | str


class Effect(StrEnum):
    """When a change takes effect."""

    LIVE = "live"
    SESSION = "next session"
    REPROCESS = "reprocess"


@dataclass(frozen=True, slots=True)
class ParamSpec:
    """One registered parameter.

    ``minimum`` and ``maximum`` are inclusive, None where unbounded; ``choices`` are all values, where only a few are
    allowed.
    """

    name: str
    type: str
    default: Value
    unit: str
    minimum: float | None
    maximum: float | None
    meaning: str
    effect: Effect
    choices: tuple[int | str, ...] = ()


class Group(BaseModel):
    """One group of parameters, ``Kp`` of ``Kp/MaxFeatures``; attributes have RTAB-Map's names."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True, allow_inf_nan=False)


def param(
    default: Value,
    meaning: str,
    *,
    unit: str = "",
    ge: float | None = None,
    le: float | None = None,
    effect: Effect = Effect.LIVE,
    choices: tuple[int, ...] = (),
) -> Any:
    """Field of a group, with all that the registry says of a parameter."""
    extra: dict[str, Any] = {"unit": unit, "effect": effect.value, "choices": list(choices)}
    return Field(default, ge=ge, le=le, description=meaning, json_schema_extra=extra)
