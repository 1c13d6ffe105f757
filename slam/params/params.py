"""All parameters as one frozen value, with RTAB-Map's names for people and files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from functools import cache
from typing import Any

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from slam.errors import ParameterError
from slam.params import groups as g
from slam.params.registry import Effect, Group, ParamSpec, Value


class Params(BaseModel):
    """Every registered parameter; ``params.Rtabmap.LoopThr`` is ``Rtabmap/LoopThr``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    Rtabmap: g.RtabmapGroup = g.RtabmapGroup()
    Mem: g.MemGroup = g.MemGroup()
    Kp: g.KpGroup = g.KpGroup()
    VhEp: g.VhEpGroup = g.VhEpGroup()
    Bayes: g.BayesGroup = g.BayesGroup()
    RGBD: g.RGBDGroup = g.RGBDGroup()
    Reg: g.RegGroup = g.RegGroup()
    Vis: g.VisGroup = g.VisGroup()
    Icp: g.IcpGroup = g.IcpGroup()
    GFTT: g.GFTTGroup = g.GFTTGroup()
    FAST: g.FASTGroup = g.FASTGroup()
    ORB: g.ORBGroup = g.ORBGroup()
    BRIEF: g.BRIEFGroup = g.BRIEFGroup()
    FREAK: g.FREAKGroup = g.FREAKGroup()
    BRISK: g.BRISKGroup = g.BRISKGroup()
    SIFT: g.SIFTGroup = g.SIFTGroup()
    KAZE: g.KAZEGroup = g.KAZEGroup()
    SURF: g.SURFGroup = g.SURFGroup()
    ALIKED: g.ALIKEDGroup = g.ALIKEDGroup()
    DISK: g.DISKGroup = g.DISKGroup()
    LightGlue: g.LightGlueGroup = g.LightGlueGroup()
    Odom: g.OdomGroup = g.OdomGroup()
    OdomF2M: g.OdomF2MGroup = g.OdomF2MGroup()
    Optimizer: g.OptimizerGroup = g.OptimizerGroup()
    GTSAM: g.GTSAMGroup = g.GTSAMGroup()
    Grid: g.GridGroup = g.GridGroup()
    GridGlobal: g.GridGlobalGroup = g.GridGlobalGroup()

    def items(self) -> Iterator[tuple[str, Value]]:
        """Full name and value of every parameter, in the registry's order."""
        for group_name in Params.model_fields:
            group: Group = getattr(self, group_name)
            for name in type(group).model_fields:
                yield f"{group_name}/{name}", getattr(group, name)

    def get(self, name: str) -> Value:
        """Value of a full name such as ``Rtabmap/LoopThr``; raises ParameterError when it isn't registered."""
        spec(name)
        group_name, _, field_name = name.partition("/")
        value: Value = getattr(getattr(self, group_name), field_name)
        return value

    def changed(self, changes: Mapping[str, Value]) -> Params:
        """A copy with these values (text is read as in RTAB-Map's files).

        Raises:
            ParameterError: a name is unknown, or a value has the wrong type or is out of bounds.
        """
        by_group: dict[str, dict[str, Value]] = {}
        for name, value in changes.items():
            spec(name)
            group_name, _, field_name = name.partition("/")
            by_group.setdefault(group_name, {})[field_name] = _checked(name, value)
        copies = {k: getattr(self, k).model_copy(update=v) for k, v in by_group.items()}
        return self.model_copy(update=copies)

    def differing(self) -> dict[str, Value]:
        """The values that differ from the defaults, by full name."""
        return {name: value for name, value in self.items() if value != spec(name).default}


def require_live(names: Iterable[str], when: str) -> None:
    """Raises ParameterError for a parameter that can't change ``when``, as it does not take effect at once."""
    for name in names:
        effect = spec(name).effect
        if effect is not Effect.LIVE:
            raise ParameterError(f"{name} takes effect with the {effect.value}, not {when}")


def specs() -> Iterator[ParamSpec]:
    """Every registered parameter, in the registry's order."""
    return iter(_registry().values())


def spec(name: str) -> ParamSpec:
    """The registry's entry of a full name; raises ParameterError, with the nearest names, when there is none."""
    found = _registry().get(name)
    if found is None:
        near = get_close_matches(name, _registry(), n=3, cutoff=0.5)
        hint = f"; did you mean {' or '.join(near)}?" if near else "; `slamdeck params` lists them all"
        raise ParameterError(f"unknown parameter {name!r}{hint}")
    return found


def format_value(value: Value) -> str:
    """Text of a value as in RTAB-Map's files (``true``, ``0.11``)."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value)


def _checked(name: str, value: Value) -> Value:
    group_name, _, field_name = name.partition("/")
    group_type = Params.model_fields[group_name].annotation
    assert group_type is not None
    try:
        model = group_type.model_validate({field_name: value})
    except ValidationError as error:
        said = spec(name)
        first = error.errors()[0]
        if said.type == "text" or first["type"] == "value_error":
            right = first["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
            raise ParameterError(f"{name}={value!r}: must be {right}") from error
        bounds = [f">= {said.minimum:g}"] if said.minimum is not None else []
        bounds += [f"<= {said.maximum:g}"] if said.maximum is not None else []
        right = " ".join([said.type, *([" and ".join(bounds)] if bounds else []), said.unit]).strip()
        raise ParameterError(f"{name}={value!r}: must be {right}") from error
    checked: Value = getattr(model, field_name)
    return checked


@cache
def _registry() -> dict[str, ParamSpec]:
    return {entry.name: entry for entry in _collect()}


def _collect() -> Iterator[ParamSpec]:
    for group_name, group_field in Params.model_fields.items():
        group_type: Any = group_field.annotation
        schema = TypeAdapter(group_type).json_schema()["properties"]
        for name, entry in schema.items():
            yield ParamSpec(
                name=f"{group_name}/{name}",
                type={"boolean": "bool", "integer": "int", "number": "float", "string": "text"}[entry["type"]],
                default=entry["default"],
                unit=entry["unit"],
                minimum=entry.get("minimum"),
                maximum=entry.get("maximum"),
                meaning=entry["description"],
                effect=Effect(entry["effect"]),
                choices=tuple(entry.get("choices") or entry.get("enum", ())),
            )
