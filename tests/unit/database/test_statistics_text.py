"""Statistics to the byte."""

from __future__ import annotations

import zlib

import numpy as np
import pytest

from slam.database.statistics_text import format_statistics, pack_statistics, parse_statistics, unpack_statistics
from slam.errors import DatabaseError

VALUES = {"Timing/Total/ms": 33.25, "Loop/Accepted_hypothesis_id/": 0.0, "Memory/RAM_usage/MB": 1234567.0}
TEXT = "Loop/Accepted_hypothesis_id/:0;Memory/RAM_usage/MB:1.23457e+06;Timing/Total/ms:33.25"


def test_text_is_sorted_with_six_digits() -> None:
    assert format_statistics(VALUES) == TEXT


def test_the_blob_is_zero_ended_text_as_one_row_of_signed_bytes() -> None:
    blob = pack_statistics(VALUES)
    assert blob is not None
    assert zlib.decompress(blob[:-12]) == TEXT.encode() + b"\0"
    assert np.frombuffer(blob[-12:], dtype="<i4").tolist() == [1, len(TEXT) + 1, 1]
    assert pack_statistics({}) is None
    assert unpack_statistics(None) == {}


def test_pairs_that_are_none_are_left_out() -> None:
    assert parse_statistics("a/b/:1;no value;c:d:2;e/:x;:3;f/:nan;;") == pytest.approx(
        {"a/b/": 1.0, "f/": np.nan}, nan_ok=True
    )


@pytest.mark.parametrize("name", ["", "a:b", "a;b", "a\0b"])
def test_names_that_the_text_can_t_carry_are_refused(name: str) -> None:
    with pytest.raises(DatabaseError, match="can't be stored"):
        format_statistics({name: 1.0})
