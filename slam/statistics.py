"""The statistics of one update under RTAB-Map's names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slam.clock import StageClock
from slam.geometry import Pose, rotation_angle, to_euler_rpy, translation_norm
from slam.graph.graph import PoseGraph
from slam.loop.closing import Closed
from slam.loop.detector import Belief
from slam.memory.memory import Memory
from slam.memory.rehearsal import Rehearsal
from slam.memory.tiers import Transfer
from slam.registration.refining import Neighbor
from slam.types import Candidate, LinkType, Node, Odometry, Registration


@dataclass(frozen=True, slots=True, eq=False)
class Facts:
    """What the stages of one update found out."""

    node: Node
    belief: Belief
    closed: Closed
    rehearsal: Rehearsal | None
    odometry: Odometry
    retrieved: Sequence[int]
    transferred: Transfer
    travelled_m: float
    neighbor: Neighbor


def describe(facts: Facts, memory: Memory, graph: PoseGraph, T_map_odom: Pose, clock: StageClock) -> dict[str, float]:
    """All statistics of an update, name -> value; ``Timing/Total/ms`` is what has passed when this is called."""
    return {
        **_loop(facts),
        **_closure(facts.closed),
        **_removed(facts.closed),
        **_pose(graph.poses[facts.node.id], T_map_odom),
        **_memory(facts, memory, graph),
        **_odometry(facts.odometry),
        **_refining(facts.neighbor.refining),
        **clock.values,
        "Timing/Total/ms": clock.elapsed_ms,
    }


def _loop(facts: Facts) -> dict[str, float]:
    candidates = facts.closed.candidates
    proximity = [c for c in candidates if c.type is LinkType.LOCAL_SPACE_CLOSURE]
    hypothesis = next((c for c in candidates if c.type is LinkType.GLOBAL_CLOSURE), None)
    accepted = 0 if hypothesis is None or hypothesis.refusal is not None else hypothesis.to_id
    shown = _most_telling(candidates)
    posterior = facts.belief.posterior
    near = [c.to_id for c in proximity if c.refusal is None and not c.by_scans]
    by_scans = [c for c in proximity if c.by_scans]
    scanned = [c.to_id for c in by_scans if c.refusal is None]
    return {
        "Loop/Id/": float(accepted),
        "Loop/Map_id/": float(facts.node.map_id),
        "Loop/Accepted_hypothesis_id/": float(accepted),
        "Loop/RejectedHypothesis/": float(hypothesis is not None and not accepted),
        "Loop/Highest_hypothesis_id/": 0.0 if posterior is None else float(posterior.best_id),
        "Loop/Highest_hypothesis_value/": 0.0 if posterior is None else posterior.value,
        "Loop/Vp_hypothesis/": 0.0 if posterior is None else posterior.virtual_place,
        "Loop/Visual_matches/": 0.0 if shown is None else float(shown.matches),
        "Loop/Visual_inliers/": 0.0 if shown is None else float(shown.inliers),
        "Loop/Visual_words/": float((facts.node.word_ids > 0).sum()),
        "Proximity/Space_visual_paths_checked/": float(len(proximity) - len(by_scans)),
        "Proximity/Space_scan_paths_checked/": float(len(by_scans)),
        "Proximity/Space_detections_added_visually/": float(len(near)),
        "Proximity/Space_detections_added_icp_multi/": float(len(scanned)),
        "Proximity/Space_last_detection_id/": float([0, *near, *scanned][-1]),
    }


def _most_telling(candidates: Sequence[Candidate]) -> Candidate | None:
    return max((c for c in candidates if not c.by_scans), key=lambda c: c.inliers, default=None)


def _refining(found: Registration | None) -> dict[str, float]:
    """What refining the link to the node before came to; nothing where it was not tried."""
    if found is None:
        return {}
    values = {
        "Accepted/": float(found.T_from_to is not None),
        "Inliers/": float(found.inliers.sum()),
        "Variance/": float(found.covariance[0, 0]),
    }
    if found.icp is not None:
        values |= {
            "ICP_inliers_ratio/": found.icp.ratio,
            "ICP_translation/m": found.icp.translation_m,
            "ICP_rotation/rad": found.icp.rotation_rad,
            "ICP_complexity/": found.icp.complexity,
            "Pts/": float(found.icp.points),
        }
    return {f"NeighborLinkRefining/{name}": value for name, value in values.items()}


def _closure(closed: Closed) -> dict[str, float]:
    if closed.closure is None:
        return {}
    worst, optimized = closed.closure.worst, closed.closure.optimized
    return {
        "Loop/Optimization_max_error/m": worst.linear_m,
        "Loop/Optimization_max_error_ratio/": worst.linear,
        "Loop/Optimization_max_ang_error/deg": float(np.degrees(worst.angular_rad)),
        "Loop/Optimization_max_ang_error_ratio/": worst.angular,
        "Loop/Optimization_error/": optimized.chi2_after,
        "Loop/Optimization_iterations/": float(optimized.iterations),
    }


def _removed(closed: Closed) -> dict[str, float]:
    """The old loop that was found to be wrong, and how many went with it; nothing where none was."""
    if not closed.removed:
        return {}
    first = closed.removed[0]
    values = {"from_id": first.from_id, "to_id": first.to_id, "count": len(closed.removed)}
    return {f"Loop/Optimization_max_error_removed_{what}/": float(value) for what, value in values.items()}


def _pose(T_map_base: Pose, T_map_odom: Pose) -> dict[str, float]:
    values = {
        "Loop/MapToOdom_norm/m": translation_norm(T_map_odom),
        "Loop/MapToOdom_angle/deg": float(np.degrees(rotation_angle(T_map_odom))),
    }
    for frame, T in (("MapToBase", T_map_base), ("MapToOdom", T_map_odom)):
        values.update({f"Loop/{frame}_{axis}/m": float(T[k, 3]) for k, axis in enumerate("xyz")})
        angles = np.degrees(to_euler_rpy(T))
        values.update(
            {f"Loop/{frame}_{axis}/deg": float(a) for axis, a in zip(("roll", "pitch", "yaw"), angles, strict=True)}
        )
    return values


def _memory(facts: Facts, memory: Memory, graph: PoseGraph) -> dict[str, float]:
    rehearsal, immunity = facts.rehearsal, facts.transferred.immunity
    return {
        "Memory/Short_time_memory_size/": float(len(memory.stm)),
        "Memory/Working_memory_size/": float(len(memory.wm)),
        "Memory/Short_time_memory_inter_size/": float(len(memory.with_between(memory.stm)) - len(memory.stm)),
        "Memory/Working_memory_inter_size/": float(len(memory.with_between(memory.wm)) - len(memory.wm)),
        "Memory/Long_term_memory_size/": float(len(memory.ltm)),
        "Memory/Local_graph_size/": float(len(graph)),
        "Memory/Signatures_removed/": float(len(facts.transferred.ids)),
        "Memory/Immunized_globally/": float(len(immunity.globally)),
        "Memory/Immunized_locally/": float(len(immunity.locally)),
        "Memory/Immunized_locally_max/": float(immunity.most_locally),
        "Memory/Signatures_retrieved/": float(len(facts.retrieved)),
        "Memory/Rehearsal_id/": 0.0 if rehearsal is None else float(rehearsal.node_id),
        "Memory/Rehearsal_sim/": 0.0 if rehearsal is None else rehearsal.similarity,
        "Memory/Distance_travelled/m": facts.travelled_m,
        "Keypoint/Dictionary_size/words": float(len(memory.dictionary)),
        "Keypoint/Current_frame/words": float((facts.node.word_ids > 0).sum()),
    }


def _odometry(odometry: Odometry) -> dict[str, float]:
    return {
        "Odometry/Features/": float(len(odometry.features)),
        "Odometry/Inliers/": float(odometry.inliers),
        "Odometry/KeyFrameAdded/": float(odometry.keyframe),
        "Odometry/TotalTime/ms": odometry.time_ms,
        "Memory/Odometry_variance_lin/": float(odometry.covariance[0, 0]),
        "Memory/Odometry_variance_ang/": float(odometry.covariance[3, 3]),
    }
