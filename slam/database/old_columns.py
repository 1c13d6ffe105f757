"""Columns of older schemas whose meaning or form changed: SQL that makes today's values of them.

In this SQL the file's table is ``t``; the functions are those of ``old_blobs``. What changed in which version is in
the history of RTAB-Map's database: variances until 0.13.0, calibration of float32 from 0.10.0 to 0.17, and so on.
"""

from __future__ import annotations

from collections.abc import Mapping, Set

from slam.database.file_check import Version


def changed_columns(name: str, there: Set[str], version: Version) -> dict[str, str]:
    """Column of today -> SQL, of those whose values are not as they are in the table of that name."""
    if name == "Node" and _skewed(version):
        return {key: f"deck_orthonormal(t.{key})" for key in {"pose", "ground_truth_pose"} & there}
    if name == "Link":
        return _link(there, version)
    if name == "Data":
        return _data(there, version)
    if name == "Statistics" and version < (0, 15, 0):
        return {"data": "deck_text(t.data)"}
    if name == "Feature" and "octave" not in there:
        return {"octave": "0"}
    return {}


def image_and_depth(columns: Mapping[str, Set[str]]) -> tuple[str, dict[str, str]]:
    """The tables that came before Data (0.10.0), and what its columns of today are in theirs."""
    source, known = "main.Node AS n", {"id": "n.id"}
    if "user_data" in columns["Node"]:
        known["user_data"] = "deck_text(n.user_data)"
    if "Image" in columns:
        source += " LEFT JOIN main.Image AS i ON i.id = n.id"
        known["image"] = "i.data"
    if "Depth" in columns:
        source += " LEFT JOIN main.Depth AS t ON t.id = n.id"
        known |= _depth(columns["Depth"])
    return source, known


def _depth(there: Set[str]) -> dict[str, str]:
    known = {"depth": "t.data"}
    if "fx" in there:
        known["calibration"] = "deck_depth_calibration(t.fx, t.fy, t.cx, t.cy, t.local_transform)"
    elif "constant" in there:
        known["calibration"] = "deck_focal_calibration(t.constant, t.local_transform)"
    if "data2d" in there:
        known["scan"] = "t.data2d"
    if "data2d_max_pts" in there:
        known["scan_info"] = "deck_scan_limits(t.data2d_max_pts, 0)"
    return known


def _data(there: Set[str], version: Version) -> dict[str, str]:
    known = {}
    if version < (0, 18, 0):
        known["calibration"] = f"deck_calibration(t.calibration, {int(version >= (0, 11, 2))})"
        if "scan_info" in there:
            known["scan_info"] = "deck_scan_info(t.scan_info)"
        elif "scan_max_pts" in there:
            reach = "t.scan_max_range" if "scan_max_range" in there else "0"
            known["scan_info"] = f"deck_scan_limits(t.scan_max_pts, {reach})"
    return known


def _link(there: Set[str], version: Version) -> dict[str, str]:
    known = {}
    if version < (0, 7, 4):
        known["type"] = "(t.type <> 0)"
    if "information_matrix" not in there:
        known["information_matrix"] = f"deck_information({_variances(there)})"
    if _skewed(version):
        known["transform"] = "deck_orthonormal(t.transform)"
    return known


def _variances(there: Set[str]) -> str:
    if "rot_variance" in there:
        return "t.rot_variance, t.trans_variance"
    return "t.variance, t.variance" if "variance" in there else "1, 1"


def _skewed(version: Version) -> bool:
    return version < (0, 15, 2)
