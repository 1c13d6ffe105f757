"""Parameters as RTAB-Map stores them: ``Group/Name:value;...``, sorted."""

from __future__ import annotations

from collections.abc import Mapping

from slam.errors import DatabaseError
from slam.params import Params, Value, format_value, spec, specs


def format_parameters(values: Mapping[str, str]) -> str:
    """Text of parameters; commas become dots, as RTAB-Map writes them.

    Raises:
        DatabaseError: a name or value holds a mark that the text can't carry.
    """
    for name, value in values.items():
        if not name or ":" in name or ";" in name + value or "'" in name + value:
            raise DatabaseError(
                f"parameter {name}={value!r} can't be stored: RTAB-Map's text allows no ';' and no quote"
            )
    return ";".join(f"{name}:{values[name].replace(',', '.')}" for name in sorted(values))


def parse_parameters(text: str | None) -> dict[str, str]:
    """Values by name; a value may hold colons, a pair without one is left out."""
    pairs = (pair.partition(":") for pair in (text or "").split(";"))
    return {name: value for name, colon, value in pairs if name and colon}


def params_text(params: Params) -> str:
    """Text of every registered parameter."""
    return format_parameters({name: format_value(value) for name, value in params.items()})


def differing(stored: Mapping[str, str]) -> dict[str, str]:
    """The stored values of registered parameters that differ from the defaults."""
    known = {entry.name for entry in specs()}
    return {name: text for name, text in sorted(stored.items()) if name in known and _differs(text, spec(name).default)}


def _differs(text: str, default: Value) -> bool:
    if isinstance(default, bool):
        return text.strip().lower() not in (("true", "1") if default else ("false", "0"))
    if isinstance(default, str):
        return text != default
    try:
        return float(text) != default
    except ValueError:
        return True
