"""How well the links of a small graph determine one of its poses."""

from __future__ import annotations

import numpy as np

from slam.geometry import Array, adjoint, between
from slam.graph.graph import PoseGraph, ascending


def marginal_covariance(graph: PoseGraph, node_id: int, *, root: int) -> Array:
    """(6, 6) covariance of a pose with ``root`` held fixed: x y z roll pitch yaw in its own axes, m^2 and rad^2.

    The inverse of the Gauss-Newton information of all links (Dellaert and Kaess 2017, section 2.4), dense: for tens of
    nodes. Residuals are small at the optimum, so that the Jacobian of the logarithm counts as one.
    """
    row = {i: 6 * k for k, i in enumerate(sorted(graph.component(root) - {root}))}
    information = np.zeros((6 * len(row), 6 * len(row)))
    for pair in sorted(graph.links):
        link = ascending(graph.links[pair])
        if link.from_id not in row and link.to_id not in row:
            continue
        parts = {link.from_id: -adjoint(between(graph.poses[link.to_id], graph.poses[link.from_id]))}
        parts[link.to_id] = np.eye(6)
        for a, J_a in parts.items():
            for b, J_b in parts.items():
                if a in row and b in row:
                    information[row[a] : row[a] + 6, row[b] : row[b] + 6] += J_a.T @ link.information @ J_b
    at = slice(row[node_id], row[node_id] + 6)
    return np.asarray(np.linalg.inv(information)[at, at])
