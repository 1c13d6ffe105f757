"""Laws of the parameter registry."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam.errors import ParameterError
from slam.params import Effect, Params, ParamSpec, Value, format_value, spec, specs

SPECS = list(specs())
NUMBERS = [entry for entry in SPECS if entry.type in ("int", "float")]
#: Where a type has no bound, numbers up to this are tried.
FAR = 10**6


def values(entry: ParamSpec) -> st.SearchStrategy[Value]:
    """Valid values of a parameter."""
    if entry.choices:
        return st.sampled_from(entry.choices)
    low = -FAR if entry.minimum is None else entry.minimum
    high = max(low, FAR) if entry.maximum is None else entry.maximum
    if entry.type == "bool":
        return st.booleans()
    if entry.type == "int":
        return st.integers(math.ceil(low), math.floor(high))
    if entry.type == "float":
        return st.floats(low, high)
    return st.just(entry.default)


changes = st.lists(st.sampled_from(SPECS), unique_by=lambda entry: entry.name).flatmap(
    lambda chosen: st.fixed_dictionaries({entry.name: values(entry) for entry in chosen})
)


@given(changes)
def test_what_is_set_is_got_and_nothing_else_moves(given_changes: dict[str, Value]) -> None:
    params = Params().changed(given_changes)
    for name, value in params.items():
        assert value == given_changes.get(name, spec(name).default)
    assert params.differing() == {n: v for n, v in given_changes.items() if v != spec(n).default}
    assert Params().differing() == {}, "a change makes a copy"


@given(changes)
def test_text_carries_every_value(given_changes: dict[str, Value]) -> None:
    params = Params().changed(given_changes)
    as_text = {name: format_value(value) for name, value in params.items()}
    assert Params().changed(as_text) == params


@given(changes, changes)
def test_changes_one_after_the_other_are_changes_together(a: dict[str, Value], b: dict[str, Value]) -> None:
    assert Params().changed(a).changed(b) == Params().changed({**a, **b})


@pytest.mark.parametrize("entry", NUMBERS, ids=lambda entry: entry.name)
def test_bounds_belong_to_the_range_and_what_lies_beyond_does_not(entry: ParamSpec) -> None:
    step = 1 if entry.type == "int" else 1e-3
    for bound, outwards in ((entry.minimum, -step), (entry.maximum, step)):
        if bound is None:
            continue
        assert Params().changed({entry.name: bound}).get(entry.name) == bound
        with pytest.raises(ParameterError, match="must be") as caught:
            Params().changed({entry.name: bound + outwards})
        assert entry.name in str(caught.value)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("entry", NUMBERS, ids=lambda entry: entry.name)
@pytest.mark.parametrize("value", ["", "many", "nan", "inf", "1e400", "0.5.1"])
def test_what_is_no_number_is_refused(entry: ParamSpec, value: str) -> None:
    with pytest.raises(ParameterError):
        Params().changed({entry.name: value})


@given(st.text(max_size=30))
def test_unknown_names_are_refused(name: str) -> None:
    if name in {entry.name for entry in SPECS}:
        return
    for ask in (lambda: spec(name), lambda: Params().get(name), lambda: Params().changed({name: 1})):
        with pytest.raises(ParameterError, match="unknown parameter"):
            ask()


def test_a_refused_change_changes_nothing() -> None:
    params = Params()
    with pytest.raises(ParameterError):
        params.changed({"Rtabmap/TimeThr": 500, "Rtabmap/LoopThr": 2})
    assert params == Params()


@pytest.mark.parametrize("entry", SPECS, ids=lambda entry: entry.name)
def test_every_parameter_is_described(entry: ParamSpec) -> None:
    assert entry.meaning.endswith(".")
    assert entry.effect in Effect
    assert entry.type in ("bool", "int", "float", "text")
    assert Params().changed({entry.name: entry.default}) == Params()
    assert type(Params().get(entry.name)).__name__ == entry.type.replace("text", "str")


def test_params_are_frozen() -> None:
    with pytest.raises(ValueError, match="frozen"):
        Params().Rtabmap.LoopThr = 0.5
