"""Refining the link to the node before: with success it is the registration's, without it odometry's in doubt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slam.geometry import Pose, between, inverse, se3_exp, translation_norm
from slam.params import Params
from slam.registration.refining import refine
from slam.types import Link, LinkType, Node
from tests.clouds import CORNER, scan
from tests.scenes import CAMERA
from tests.unit.registration.test_visual import two_views

REFINING = Params().changed({"RGBD/NeighborLinkRefining": True})


def pair(seed: int = 1) -> tuple[Node, Node, Link, Pose]:
    """The new node, the last one, odometry's link between them that is 3 cm off, and the true ``T_new_last``."""
    new, last, T_new_last = two_views(seed)
    clouds = scan(CORNER, np.eye(4), 1), scan(CORNER, T_new_last, 2)
    made = [
        Node(i, 0, 0, float(i), np.eye(4), items, np.ones(len(items), np.int32), CAMERA, scan=cloud)
        for i, items, cloud in zip((8, 7), (new, last), clouds, strict=True)
    ]
    off = np.asarray(T_new_last @ se3_exp(np.array([0.02, -0.02, 0.01, 0.005, 0.0, 0.01])))
    return made[0], made[1], Link(8, 7, LinkType.NEIGHBOR, off, np.eye(6) * 400.0), T_new_last


@pytest.mark.parametrize("strategy", [0, 1, 2])
def test_a_link_becomes_better_and_says_how_sure_it_is(strategy: int) -> None:
    new, last, link, T_new_last = pair()
    found = refine(link, new, last, REFINING.changed({"Reg/Strategy": strategy}))
    assert found.refined
    assert found.link is not None
    assert found.link.T_from_to is not None
    assert found.refining is not None
    assert translation_norm(between(T_new_last, found.link.T_from_to)) < 0.01
    np.testing.assert_allclose(found.link.information @ found.refining.covariance, np.eye(6), atol=1e-9)
    assert (found.link.from_id, found.link.to_id, found.link.type) == (8, 7, LinkType.NEIGHBOR)
    assert (found.refining.icp is None) == (strategy == 0)
    T_map_last = se3_exp(np.arange(6) * 0.1)
    np.testing.assert_allclose(found.placed(T_map_last), T_map_last @ inverse(found.link.T_from_to))


def test_a_refused_one_stays_as_it_was_and_is_doubted() -> None:
    new, last, link, _ = pair()
    found = refine(link, new, replace(last, scan=None), REFINING.changed({"Reg/Strategy": 1}))
    assert not found.refined
    assert found.link is not None
    assert found.link.T_from_to is link.T_from_to
    np.testing.assert_allclose(found.link.information, np.eye(6) * 4.0)


def test_odometry_alone_is_the_default() -> None:
    new, last, link, _ = pair()
    found = refine(link, new, last, Params())
    assert found.links == (link,)
    assert found.refining is None
    assert not found.refined
