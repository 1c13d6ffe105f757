"""Parameters of a map, or those in force in its engine."""

from __future__ import annotations

from collections.abc import Mapping

from server.schemas import Parameter, ParameterChoice, ParameterSet
from slam.params import ParamSpec, Value, specs
from slam.params.feature_types import feature_name

#: The dozen that matter first, in the order in which the page shows them.
FRONT = (
    "Rtabmap/LoopThr",
    "Rtabmap/TimeThr",
    "Rtabmap/MemoryThr",
    "Rtabmap/DetectionRate",
    "Mem/STMSize",
    "Mem/RehearsalSimilarity",
    "Vis/MinInliers",
    "Vis/MaxFeatures",
    "Kp/MaxFeatures",
    "RGBD/OptimizeMaxError",
    "RGBD/LinearUpdate",
    "RGBD/ProximityBySpace",
)


def parameter_set(values: Mapping[str, Value], stored: Mapping[str, str], *, live: bool) -> ParameterSet:
    """All registered parameters with these values; ``stored`` names the ones that slamdeck doesn't use."""
    known = {entry.name for entry in specs()}
    ordered = sorted(specs(), key=lambda entry: FRONT.index(entry.name) if entry.name in FRONT else len(FRONT))
    return ParameterSet(
        parameters=[_parameter(entry, values[entry.name]) for entry in ordered],
        unused={name: text for name, text in sorted(stored.items()) if name not in known},
        live=live,
    )


def _parameter(entry: ParamSpec, value: Value) -> Parameter:
    return Parameter(
        name=entry.name,
        group=entry.name.partition("/")[0],
        type=entry.type,
        default=entry.default,
        value=value,
        unit=entry.unit,
        minimum=entry.minimum,
        maximum=entry.maximum,
        choices=[ParameterChoice(value=value, label=_label(entry.name, value)) for value in entry.choices],
        meaning=entry.meaning,
        effect=entry.effect,
        front=entry.name in FRONT,
    )


def _label(name: str, value: int | str) -> str:
    """What a choice is called: feature types have names."""
    if name in ("Vis/FeatureType", "Kp/DetectorStrategy") and isinstance(value, int):
        return f"{value} {feature_name(value)}"
    return str(value)
