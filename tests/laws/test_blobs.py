"""What is packed into a blob comes back from it, for every blob of the map file."""

from __future__ import annotations

import tracemalloc
import zlib
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database import blobs
from slam.database.calibration import pack_camera, unpack_cameras
from slam.database.depth_codec import decode_rvl, encode_rvl
from slam.database.parameter_text import format_parameters, parse_parameters
from slam.database.statistics_text import format_statistics, pack_statistics, parse_statistics, unpack_statistics
from slam.errors import DatabaseError
from slam.geometry import from_quat_xyzw

finite = st.floats(-1e6, 1e6, width=32)
matrices = st.sampled_from(["u1", "i1", "<u2", "<i2", "<i4", "<f4", "<f8"]).flatmap(
    lambda code: hnp.arrays(np.dtype(code), hnp.array_shapes(min_dims=2, max_dims=2, max_side=9))
)
channelled = hnp.arrays(np.float32, st.tuples(st.integers(1, 3), st.integers(1, 9), st.integers(2, 7)))
depths = hnp.arrays(
    np.uint16,
    hnp.array_shapes(min_dims=2, max_dims=2, max_side=17),
    elements=st.one_of(st.just(0), st.integers(0, 65535)),
)
poses = st.builds(
    lambda q, t: from_quat_xyzw(np.array(q), np.array(t)),
    st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: float(np.linalg.norm(q)) > 0.1),
    st.tuples(*[st.floats(-1e3, 1e3)] * 3),
)


@given(st.one_of(matrices, channelled))
def test_matrices_come_back(matrix: NDArray[np.generic]) -> None:
    blob = blobs.pack_matrix(matrix)
    found = blobs.unpack_matrix(blob)
    assert found is not None
    assert found.dtype == matrix.dtype
    np.testing.assert_array_equal(found, matrix)


@given(matrices, st.data())
def test_a_changed_byte_is_refused_or_harmless(matrix: NDArray[np.generic], data: st.DataObject) -> None:
    blob = bytearray(blobs.pack_matrix(matrix) or b"")
    blob[data.draw(st.integers(0, len(blob) - 1))] ^= data.draw(st.integers(1, 255))
    try:
        blobs.unpack_matrix(bytes(blob))
    except DatabaseError as error:
        assert "matrix blob" in str(error)


def test_a_matrix_has_the_layout_of_the_format() -> None:
    blob = blobs.pack_matrix(np.array([[1, 2, 3]], dtype=np.int32))
    assert blob is not None
    assert zlib.decompress(blob[:-12]) == bytes([1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0])
    assert blob[:2] == b"\x78\x9c"
    assert blob[-12:] == bytes([1, 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0])


def test_type_codes_are_opencv_s() -> None:
    kinds = {("f4", 1): 5, ("f4", 2): 13, ("f4", 7): 53, ("i1", 1): 1, ("u2", 1): 2, ("f8", 1): 6}
    for (code, channels), kind in kinds.items():
        matrix = np.zeros((1, 2, channels) if channels > 1 else (1, 2), dtype=code)
        assert (blobs.pack_matrix(matrix) or b"")[-4] == kind


def test_nothing_is_null_and_null_is_nothing() -> None:
    assert blobs.pack_row(np.zeros((0, 2), dtype=np.float32)) is None
    assert blobs.unpack_matrix(None) is None
    assert blobs.unpack_matrix(bytes(4)) is None


def test_a_bomb_is_refused_before_it_is_inflated() -> None:
    bomb = zlib.compress(bytes(1 << 20)) + np.array([1, 4, 0], dtype="<i4").tobytes()
    with pytest.raises(DatabaseError, match="or more where its size says 4"):
        blobs.unpack_matrix(bomb)
    large = zlib.compress(bytes(1 << 26)) + np.array([1, 4, 0], dtype="<i4").tobytes()
    tracemalloc.start()
    with pytest.raises(DatabaseError, match="or more"):
        blobs.unpack_matrix(large)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1 << 20
    absurd = zlib.compress(b"") + np.array([1 << 30, 1 << 30, 6], dtype="<i4").tobytes()
    with pytest.raises(DatabaseError, match="more than the"):
        blobs.unpack_matrix(absurd)


@given(poses)
def test_transforms_come_back_as_float32(T_a_b: NDArray[np.float64]) -> None:
    found = blobs.unpack_transform(blobs.pack_transform(T_a_b))
    assert found is not None
    np.testing.assert_array_equal(found, T_a_b.astype(np.float32))
    exact = blobs.unpack_pose(blobs.pack_pose(T_a_b))
    assert exact is not None
    np.testing.assert_array_equal(exact, T_a_b)


@given(st.lists(poses, min_size=1, max_size=5))
def test_stacks_of_transforms_are_the_transforms(T_a_b: list[NDArray[np.float64]]) -> None:
    expected = np.array(T_a_b).astype(np.float32)
    np.testing.assert_array_equal(blobs.stack_rows(blobs.pack_transforms(T_a_b)), expected)
    blob_stack = blobs.stack_transforms([*map(blobs.pack_transform, T_a_b), None, bytes(48), b"short"])
    np.testing.assert_array_equal(blob_stack[:-3], expected)
    assert np.isnan(blob_stack[-3:]).all()


def test_the_null_transform_is_none() -> None:
    assert blobs.pack_transform(None) == bytes(48)
    assert blobs.unpack_transform(bytes(48)) is None
    broken = np.eye(4)
    broken[0, 3] = np.nan
    assert blobs.unpack_transform(blobs.pack_transform(broken)) is None


@given(hnp.arrays(np.float64, (6, 6), elements=st.floats(-1e9, 1e9)))
def test_information_comes_back_or_is_refused(information: NDArray[np.float64]) -> None:
    if np.all(np.diag(information) > 0):
        np.testing.assert_array_equal(blobs.unpack_information(blobs.pack_information(information)), information)
    else:
        with pytest.raises(DatabaseError, match="positive diagonal"):
            blobs.pack_information(information)


@settings(deadline=None)  # the first call compiles
@given(depths)
def test_rvl_loses_nothing(depth_mm: NDArray[np.uint16]) -> None:
    np.testing.assert_array_equal(decode_rvl(encode_rvl(depth_mm)), depth_mm)


@settings(deadline=None)  # the first call compiles
@given(depths, st.data())
def test_damaged_rvl_is_refused_or_an_image(depth_mm: NDArray[np.uint16], data: st.DataObject) -> None:
    blob = encode_rvl(depth_mm)
    cut = blob[: data.draw(st.integers(0, len(blob) - 1))]
    with pytest.raises(DatabaseError):
        decode_rvl(cut[: len(cut) - len(cut) % 4])
    noise = blob[:16] + data.draw(st.binary(max_size=64))
    with suppress(DatabaseError):
        assert decode_rvl(noise).shape == depth_mm.shape


@given(
    st.tuples(st.integers(1, 9999), st.integers(1, 9999)),
    st.tuples(st.floats(0.1, 1e4), st.floats(0.1, 1e4), st.floats(0.1, 1e4), st.floats(0.1, 1e4)),
    st.lists(poses, min_size=1, max_size=3),
)
def test_cameras_come_back(
    size: tuple[int, int], intrinsics: tuple[float, float, float, float], T_base_cam: list[NDArray[np.float64]]
) -> None:
    cameras = [Camera(*size, *intrinsics, T) for T in T_base_cam]
    found = unpack_cameras(b"".join(map(pack_camera, cameras)))
    assert len(found) == len(cameras)
    for camera, expected in zip(found, cameras, strict=True):
        assert (camera.width, camera.height) == size
        np.testing.assert_array_equal(camera.K, expected.K)
        np.testing.assert_array_equal(camera.T_base_cam, expected.T_base_cam.astype(np.float32))


names = st.text(st.characters(exclude_characters=":;\0", exclude_categories=["Cs"]), min_size=1)


@given(st.dictionaries(names, st.floats(allow_nan=False)))
def test_statistics_come_back_with_six_digits(values: dict[str, float]) -> None:
    expected = {name: float(f"{value:.6g}") for name, value in values.items()}
    assert parse_statistics(format_statistics(values)) == expected
    assert unpack_statistics(pack_statistics(values)) == expected


texts = st.text(st.characters(exclude_characters=";,'", exclude_categories=["Cs"]))
keys = st.text(st.characters(exclude_characters=":;,'", exclude_categories=["Cs"]), min_size=1)


@given(st.dictionaries(keys, texts))
def test_parameters_come_back(values: dict[str, str]) -> None:
    assert parse_parameters(format_parameters(values)) == values
