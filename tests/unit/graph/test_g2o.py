"""g2o files: round trips, planar files, and files that are not what they should be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.errors import DatabaseError
from slam.geometry import between, from_quat_xyzw, inverse, se3_log, to_euler_rpy
from slam.graph.g2o import read_edges, read_g2o, write_g2o
from slam.graph.graph import ascending
from slam.graph.optimizer import chi2
from slam.types import LinkType
from tests.graphs import circles, stacked

IDENTITY = "0 0 0 0 0 0 1"
UNIT = "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1"


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    graph = circles(30, 3)
    write_g2o(tmp_path / "a.g2o", graph)
    back = read_g2o(tmp_path / "a.g2o")
    assert np.allclose(stacked(back.poses), stacked(graph.poses), atol=1e-14)
    assert back.links.keys() == graph.links.keys()
    for pair, link in graph.links.items():
        link, other = ascending(link), back.links[pair]
        assert (other.from_id, other.to_id, other.type) == (link.from_id, link.to_id, link.type)
        assert np.allclose(other.T_from_to, link.T_from_to, atol=1e-14)
        assert np.array_equal(other.information, link.information)


def test_planar_files_lie_in_the_plane(tmp_path: Path) -> None:
    file = tmp_path / "flat.g2o"
    file.write_text("# a comment\nVERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 2 0.5\nFIX 0\nEDGE_SE2 0 1 1 2 0.5 4 1 2 5 3 6\n")
    graph = read_g2o(file)
    assert np.allclose(graph.poses[1][:3, 3], [1, 2, 0])
    assert np.allclose(to_euler_rpy(graph.poses[1]), [0, 0, 0.5])
    information = graph.links[0, 1].information[np.ix_([0, 1, 5], [0, 1, 5])]
    assert np.array_equal(information, [[4, 1, 2], [1, 5, 3], [2, 3, 6]])
    assert np.linalg.eigvalsh(graph.links[0, 1].information).min() > 0


def test_two_edges_of_a_pair_become_their_mean_whichever_way_they_point(tmp_path: Path) -> None:
    vertices = f"VERTEX_SE3:QUAT 0 {IDENTITY}\nVERTEX_SE3:QUAT 1 {IDENTITY}\n"
    edges = f"EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 {UNIT}\nEDGE_SE3:QUAT 1 0 -3 0 0 0 0 0 1 {UNIT}\n"
    (tmp_path / "a.g2o").write_text(vertices + edges)
    graph = read_g2o(tmp_path / "a.g2o")
    link = graph.links[0, 1]
    assert len(read_edges(tmp_path / "a.g2o")) == 2
    assert link.type is LinkType.NEIGHBOR
    assert link.T_from_to is not None
    assert link.T_from_to[0, 3] == pytest.approx(2.0)
    assert link.information[0, 0] == pytest.approx(2.0)


def test_an_edge_to_the_smaller_id_weighs_what_it_weighs_in_the_file(tmp_path: Path) -> None:
    upper = "9 2 0 0 1 0 4 0 0 0 0 7 0 1 0 5 0 0 3 0 8"
    file = tmp_path / "a.g2o"
    vertices = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 5 1 2 3 0.1 0.2 0.3 0.9\n"
    file.write_text(f"{vertices}EDGE_SE3:QUAT 5 0 -1 0.5 2 0.3 -0.2 0.1 0.9 {upper}\n")
    graph = read_g2o(file)
    T_5_0 = from_quat_xyzw(np.array([0.3, -0.2, 0.1, 0.9]), np.array([-1, 0.5, 2]))
    residual = se3_log(inverse(T_5_0) @ between(graph.poses[5], graph.poses[0]))
    information = np.zeros((6, 6))
    information[np.triu_indices(6)] = [float(v) for v in upper.split()]
    information += np.triu(information, 1).T
    link = graph.links[0, 5]
    assert (link.from_id, link.to_id) == (0, 5)
    assert chi2([link], graph.poses) == pytest.approx(residual @ information @ residual, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (f"VERTEX_SE3:QUAT 0 {IDENTITY} 7", "line 1: VERTEX_SE3:QUAT needs 8 finite numbers, has 9"),
        ("VERTEX_SE2 0 0 nan 0", "line 1: VERTEX_SE2 needs 4 finite numbers"),
        ("VERTEX_SE2 0 0 none 0", "line 1: VERTEX_SE2 needs numbers"),
        ("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 0 0 0 0", "line 2: vertex 0 is there already"),
        ("VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 0 0 0 1 0 0 1 0 1", "edge 0 1 needs two vertices"),
        ("VERTEX_XY 0 0 0", "line 1: VERTEX_XY is not supported"),
    ],
)
def test_bad_files_are_refused_with_the_line(tmp_path: Path, text: str, says: str) -> None:
    file = tmp_path / "bad.g2o"
    file.write_text(text)
    with pytest.raises(DatabaseError, match=f"bad.g2o.*{says}"):
        read_g2o(file)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DatabaseError, match="absent"):
        read_g2o(tmp_path / "absent.g2o")
