"""Covariances of small graphs: what each link adds, and what two ways to a pose know together."""

from __future__ import annotations

import numpy as np

from slam.geometry import adjoint, between, inverse
from slam.graph.marginal import marginal_covariance
from slam.types import LinkType
from tests.nodes import INFORMATION, at, chain, join

SIGMAS = np.linalg.inv(INFORMATION)


def test_one_link_gives_its_own_covariance() -> None:
    np.testing.assert_allclose(marginal_covariance(chain(2), 2, root=1), SIGMAS, rtol=1e-9)


def test_a_chain_adds_up_with_its_lever() -> None:
    graph = chain(3, spacing=2.0)
    T_three_two = between(graph.poses[3], graph.poses[2])
    expected = adjoint(T_three_two) @ SIGMAS @ adjoint(T_three_two).T + SIGMAS
    np.testing.assert_allclose(marginal_covariance(graph, 3, root=1), expected, rtol=1e-9)


def test_two_ways_know_more_than_one() -> None:
    graph = chain(3)
    alone = marginal_covariance(graph, 3, root=1)
    join(graph, 3, 1, LinkType.GLOBAL_CLOSURE)
    both = marginal_covariance(graph, 3, root=1)
    assert np.linalg.eigvalsh(alone - both).min() > 0
    direct = adjoint(inverse(at(0.0))) @ SIGMAS
    assert np.linalg.eigvalsh(direct - both).min() > 0
