"""Registration of two scans by ICP, with RTAB-Map's tests and covariance."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose, between, flattened, normalized, rotation_angle, transform, translation_norm
from slam.params import Params
from slam.registration.align import align
from slam.registration.cells import Cells, nearest, normals, sort, thinned
from slam.registration.complexity import Complexity, complexity, limited
from slam.registration.scan import normal_cell
from slam.registration.view import View, refused
from slam.types import IcpEvidence, Refusal, Registration, Scan

Array = NDArray[np.float64]
#: Converts a squared median deviation to a variance (1.4826 squared, Rousseeuw and Croux 1993).
_MEDIAN_TO_VARIANCE = 2.1981
#: RTAB-Map takes a pose to be so much surer than one pair of points, and a turn once more.
_SURER = 10.0
_LINEAR_FLOOR = 1e-8
_ANGULAR_FLOOR = 3e-8
_FEWEST_POINTS = 10
#: Thinning that leaves this share of the points found them thin already.
_AS_THIN = 0.95


@dataclass(frozen=True, slots=True, eq=False)
class _Cloud:
    """A scan as ICP uses it: (N, 3) points and unit normals, both in its own frame; no normals where none are used.

    ``most`` is the number that its pairs are measured by.
    """

    points: Array
    normals: Array
    most: int


class IcpRegistration:
    """Aligns two scans around a guess (identity without one)."""

    def register(self, view_from: View, view_to: View, guess: Pose | None, params: Params) -> Registration:
        """``T_from_to`` with its evidence, or the test that refused it: scan, complexity, or one of the Icp group."""
        if view_from.scan is None or view_to.scan is None:
            which = "first" if view_from.scan is None else "second"
            return refused(Refusal("scan", 0.0, float(_FEWEST_POINTS), f"the {which} node has no cloud to compare"))
        a, b = _prepared(view_from.scan, params), _prepared(view_to.scan, params)
        fewest = min(len(a.points), len(b.points))
        if fewest < _FEWEST_POINTS:
            text = f"a cloud of {fewest} points, fewer than {_FEWEST_POINTS}"
            return refused(Refusal("scan", float(fewest), float(_FEWEST_POINTS), text))
        start = np.eye(4) if guess is None else guess
        start = flattened(start) if params.Reg.Force3DoF else start
        return _aligned(a, b, start, params)


def _prepared(scan: Scan, params: Params) -> _Cloud:
    icp = params.Icp
    points = np.ascontiguousarray(scan.points_base[:: icp.DownsamplingStep], np.float64)
    given = None if scan.normals_base is None else scan.normals_base[:: icp.DownsamplingStep]
    if icp.RangeMin > 0 or icp.RangeMax > 0:
        distance = np.linalg.norm(points, axis=1)
        kept = (distance >= icp.RangeMin) & (distance <= (icp.RangeMax or np.inf))
        points, given = points[kept], None if given is None else given[kept]
    if icp.VoxelSize > 0:
        fewer = thinned(points, icp.VoxelSize)
        # Normals of the scan hold as long as its points are as thin already.
        if given is None or len(fewer) < _AS_THIN * len(points):
            points, given = fewer, None
    if not icp.PointToPlane:
        return _Cloud(points, np.zeros((0, 3)), _most(scan, points))
    if given is None:
        normal = normals(sort(points, normal_cell(icp.VoxelSize)), icp.PointToPlaneK)
    else:
        normal = np.ascontiguousarray(given, np.float64)
    known = np.isfinite(normal[:, 0])
    return _Cloud(points[known], normal[known], _most(scan, points[known]))


def _most(scan: Scan, points: Array) -> int:
    return min(scan.most, len(points)) if scan.most else len(points)


def _aligned(a: _Cloud, b: _Cloud, guess: Pose, params: Params) -> Registration:
    icp = params.Icp
    structure, least = _plainer(a, b, guess), icp.PointToPlaneMinComplexity
    low = icp.PointToPlane and structure.value < least
    if low and icp.PointToPlaneLowComplexityStrategy == 0:
        name = "Icp/PointToPlaneMinComplexity"
        text = f"structural complexity {structure.value:.3f} is below {name} {least:g}"
        return refused(Refusal(name, structure.value, least, text))
    cells = sort(a.points, icp.MaxCorrespondenceDistance)
    T_from_to = align(
        cells,
        np.zeros((0, 3)) if low else a.normals,
        b.points,
        guess,
        icp.MaxCorrespondenceDistance,
        icp.OutlierRatio,
        _free(params),
        icp.Iterations,
        icp.Epsilon,
    )
    if low and icp.PointToPlaneLowComplexityStrategy == 1:
        T_from_to = limited(T_from_to, guess, structure, least, b.points)
    T_from_to = flattened(T_from_to) if params.Reg.Force3DoF else normalized(T_from_to)
    return _judged(cells, b, T_from_to, guess, structure.value, max(a.most, b.most), params)


def _plainer(a: _Cloud, b: _Cloud, guess: Pose) -> Complexity:
    """The structure of the plainer of both scans, in the first frame."""
    first, second = complexity(a.normals), complexity(b.normals)
    if first.value <= second.value:
        return first
    return replace(second, directions=guess[:3, :3] @ second.directions)


def _free(params: Params) -> NDArray[np.bool_]:
    if params.Reg.Force3DoF:
        return np.array([True, True, False, False, False, True])
    turns = not params.Icp.Force4DoF
    return np.array([True, True, True, turns, turns, True])


def _judged(
    cells: Cells, b: _Cloud, T_from_to: Pose, guess: Pose, structure: float, most: int, params: Params
) -> Registration:
    """The result with covariance and evidence, or the first test that it misses."""
    rows, squared = nearest(cells, transform(T_from_to, b.points), params.Icp.MaxCorrespondenceDistance)
    paired = squared[rows >= 0]
    correction = between(guess, T_from_to)
    evidence = IcpEvidence(
        len(paired) / most, translation_norm(correction), rotation_angle(correction), structure, most
    )
    refusal = _refusal(evidence, params)
    if refusal is not None:
        return replace(refused(refusal), icp=evidence)
    covariance = _covariance(paired, params)
    return Registration(T_from_to, covariance, np.zeros((0, 2), np.int32), np.zeros(0, np.bool_), icp=evidence)


def _refusal(found: IcpEvidence, params: Params) -> Refusal | None:
    icp = params.Icp
    if 0 < icp.MaxTranslation < found.translation_m:
        text = f"corrects the guess by {found.translation_m:.3f} m, more than Icp/MaxTranslation {icp.MaxTranslation:g}"
        return Refusal("Icp/MaxTranslation", found.translation_m, icp.MaxTranslation, text)
    if 0 < icp.MaxRotation < found.rotation_rad:
        text = f"turns the guess by {found.rotation_rad:.3f} rad, more than Icp/MaxRotation {icp.MaxRotation:g}"
        return Refusal("Icp/MaxRotation", found.rotation_rad, icp.MaxRotation, text)
    if found.ratio <= icp.CorrespondenceRatio:
        text = f"{found.ratio:.0%} of {found.points} points agree, not above Icp/CorrespondenceRatio"
        text += f" {icp.CorrespondenceRatio:g}"
        return Refusal("Icp/CorrespondenceRatio", found.ratio, icp.CorrespondenceRatio, text)
    return None


def _covariance(squared: Array, params: Params) -> Array:
    """(6, 6) from the median squared distance of the pairs."""
    variance = _MEDIAN_TO_VARIANCE * float(np.median(squared)) if len(squared) else 1.0
    linear = max(_LINEAR_FLOOR, variance / _SURER)
    angular = variance / _SURER**2
    level = angular / _SURER if params.Icp.Force4DoF else angular
    return np.diag([linear] * 3 + [max(_ANGULAR_FLOOR, level)] * 2 + [max(_ANGULAR_FLOOR, angular)])
