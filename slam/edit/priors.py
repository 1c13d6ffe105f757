"""Priors by hand: where a node of the map is, and how sure that is."""

from __future__ import annotations

import numpy as np

from slam.database import JournalEntry, SettingChange
from slam.edit.sigmas import information_of_sigmas
from slam.edit.wishes import PriorEdit
from slam.errors import DecisionError
from slam.graph.graph import PoseGraph
from slam.params import Params
from slam.types import Link, LinkType

#: The parameter that keeps priors from moving anything.
IGNORED = "Optimizer/PriorsIgnored"


def prior_of(graph: PoseGraph, node_id: int) -> Link | None:
    """The prior of a node, None where it has none; its transform is ``T_map_base``."""
    return graph.constraints.get((node_id, node_id, LinkType.POSE_PRIOR))


def placing(graph: PoseGraph, params: Params, wanted: PriorEdit) -> JournalEntry:
    """The entry that gives a node a prior, changes the one it has, or takes it away.

    With ``Optimizer/PriorsIgnored`` no prior moves a pose, and whoever asks must be told so; where priors are to count
    the entry switches it off, and undo switches it on again.

    Raises:
        DecisionError: the node is not in the map, has no prior to take away, or the numbers are none.
    """
    if wanted.node_id not in graph:
        raise DecisionError(f"node {wanted.node_id} is not in the map")
    here = prior_of(graph, wanted.node_id)
    if wanted.T_map_base is None and here is None:
        raise DecisionError(f"node {wanted.node_id} has no prior that could be taken away")
    after = None if wanted.T_map_base is None else _prior(wanted)
    return JournalEntry(
        action="prior",
        from_id=wanted.node_id,
        to_id=wanted.node_id,
        author=wanted.author,
        link_before=here,
        link_after=after,
        note="removed" if after is None else "added" if here is None else "changed",
        setting=SettingChange(IGNORED, "true", "false") if wanted.count and params.Optimizer.PriorsIgnored else None,
    )


def _prior(wanted: PriorEdit) -> Link:
    T, sigmas = wanted.T_map_base, wanted.sigmas
    if T is None or sigmas is None or not np.isfinite(T).all():
        raise DecisionError("a prior needs a pose of finite numbers and six sigmas")
    if (sigmas[:3] == 0).any():
        raise DecisionError("a prior needs a sigma above 0 for x, y and z; those of the angles may be 0 for unknown")
    if (sigmas[3:] == 0).any() and sigmas[3:].any():
        raise DecisionError("the angles of a prior are all known or none is: give three sigmas, or three zeros")
    return Link(wanted.node_id, wanted.node_id, LinkType.POSE_PRIOR, T, information_of_sigmas(sigmas))
