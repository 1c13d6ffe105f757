"""The typed registry of parameters, under RTAB-Map's names."""

from slam.params.params import Params, format_value, require_live, spec, specs
from slam.params.registry import Effect, ParamSpec, Value

__all__ = ["Effect", "ParamSpec", "Params", "Value", "format_value", "require_live", "spec", "specs"]
