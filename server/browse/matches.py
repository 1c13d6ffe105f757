"""Matches between both images of a link, made anew from the stored key points."""

from __future__ import annotations

import numpy as np

from server.browse.map_view import MapView
from server.browse.nodes import camera_of, require_node
from server.errors import NotFoundError
from server.schemas import LinkMatches, Size


def matches(view: MapView, from_id: int, to_id: int) -> LinkMatches:
    """Matched key points and which of them agree with one rigid motion, as the loop detector would find them.

    Raises:
        NotFoundError: a node is unknown or its camera is.
    """
    # Compiled code: loaded by the first who looks at matches, not by everybody who starts the server.
    from slam.registration.visual import register

    snapshot = view.snapshot()
    for node_id in (from_id, to_id):
        require_node(snapshot, node_id)
    cameras = camera_of(view, from_id), camera_of(view, to_id)
    if cameras[0] is None or cameras[1] is None:
        raise NotFoundError(f"node {from_id if cameras[0] is None else to_id} has no calibration to match it by")
    features_from, _ = view.reader.features(from_id)
    features_to, _ = view.reader.features(to_id)
    found = register(features_from, features_to, cameras[1], snapshot.params)
    pixels_from = features_from.pixels[found.matches[:, 0]]
    pixels_to = features_to.pixels[found.matches[:, 1]]
    return LinkMatches(
        from_=Size(width=cameras[0].width, height=cameras[0].height),
        to=Size(width=cameras[1].width, height=cameras[1].height),
        x1=pixels_from[:, 0].round(2).tolist(),
        y1=pixels_from[:, 1].round(2).tolist(),
        x2=pixels_to[:, 0].round(2).tolist(),
        y2=pixels_to[:, 1].round(2).tolist(),
        inlier=np.asarray(found.inliers, dtype=bool).tolist(),
        recomputed=True,
    )
