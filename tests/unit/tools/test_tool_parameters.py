"""Parameters of map files compared."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam.params import Params, format_value, specs
from slam.tools.parameters import changes_features, changes_words, differences, same_value

DEFAULTS = {entry.name: format_value(entry.default) for entry in specs()}


def test_one_file_is_compared_with_the_defaults() -> None:
    found = differences({**DEFAULTS, "Rtabmap/LoopThr": "0.2", "Mem/STMSize": "10.0"})
    assert [(one.name, one.values, one.default) for one in found] == [("Rtabmap/LoopThr", ("0.2",), "0.11")]


def test_only_what_differs_between_two_files_is_told_and_the_default_stands_for_what_is_missing() -> None:
    first = {"Rtabmap/LoopThr": "0.11", "RGBD/Enabled": "true", "Mem/STMSize": "30"}
    second = {"Mem/STMSize": "8", "Vis/MinInliers": "15"}
    found = {one.name: one.values for one in differences(first, second)}
    assert found == {"Mem/STMSize": ("30", "8"), "Vis/MinInliers": (None, "15")}


@given(st.dictionaries(st.sampled_from(sorted(DEFAULTS)), st.text("01.", max_size=3)))
def test_a_file_does_not_differ_from_itself_and_the_order_does_not_matter(values: dict[str, str]) -> None:
    assert differences(values, values) == []
    there = {one.name for one in differences(values, DEFAULTS)}
    assert there == {one.name for one in differences(DEFAULTS, values)}


@pytest.mark.parametrize(
    ("a", "b", "same"), [("1", "1.0", True), ("true", "1", True), ("True", "true", True), ("x", "y", False)]
)
def test_values_are_compared_by_what_they_mean(a: str, b: str, same: bool) -> None:
    assert same_value(a, b) is same


def test_what_asks_for_other_key_points_or_words() -> None:
    params = Params()
    assert changes_features({"GFTT/QualityLevel": 0.05, "Rtabmap/LoopThr": 0.3}, params) == ["GFTT/QualityLevel"]
    assert changes_features({"Vis/FeatureType": params.Vis.FeatureType}, params) == []
    assert changes_words({"Kp/NndrRatio": 0.7}, params) and not changes_words({"Vis/MinInliers": 9}, params)
