"""Parameters as RTAB-Map stores them."""

from __future__ import annotations

import pytest

from slam.database.parameter_text import differing, format_parameters, params_text, parse_parameters
from slam.errors import DatabaseError
from slam.params import Params


def test_text_is_sorted_and_commas_become_dots() -> None:
    assert format_parameters({"b/x": "1,5", "a/y": ""}) == "a/y:;b/x:1.5"


def test_values_may_hold_colons_and_nothing_is_nothing() -> None:
    assert parse_parameters("a/p:/tmp:1;b/q;;c/r:2") == {"a/p": "/tmp:1", "c/r": "2"}
    assert parse_parameters(None) == parse_parameters("") == {}


@pytest.mark.parametrize(("name", "value"), [("a", "1;2"), ("a", "it's"), ("a:b", "1"), ("", "1")])
def test_what_the_text_can_t_carry_is_refused(name: str, value: str) -> None:
    with pytest.raises(DatabaseError, match="can't be stored"):
        format_parameters({name: value})


def test_all_parameters_come_back_as_they_were() -> None:
    params = Params().changed({"Rtabmap/LoopThr": 0.15, "Kp/TfIdfLikelihoodUsed": False})
    stored = parse_parameters(params_text(params))
    assert Params().changed(stored) == params
    assert len(stored) == len(list(params.items()))


def test_differing_compares_values_not_texts() -> None:
    stored = {
        "Rtabmap/LoopThr": "0.110",
        "Kp/NndrRatio": "0.7",
        "Rtabmap/SaveWMState": "True",
        "Vis/MinInliers": "20.0",
    }
    assert differing(stored | {"GFTT/QualityLevel": "1e-3", "Some/Other": "1"}) == {"Kp/NndrRatio": "0.7"}
    assert differing({"Kp/NndrRatio": "much", "Mem/ImageCompressionFormat": ".png", "Rtabmap/SaveWMState": "0"}) == {
        "Kp/NndrRatio": "much",
        "Mem/ImageCompressionFormat": ".png",
        "Rtabmap/SaveWMState": "0",
    }
