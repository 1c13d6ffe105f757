"""The tags and markers of a map."""

from __future__ import annotations

from server.browse.columns import pose_list
from server.browse.map_view import MapView
from server.schemas import Landmark


def landmarks(view: MapView) -> list[Landmark]:
    """Each landmark that a node of the map saw, by number."""
    snapshot, lengths = view.snapshot(), view.reader.marker_lengths()
    seen_from: dict[int, list[int]] = {}
    for link in snapshot.constraints:
        if link.to_id < 0:
            seen_from.setdefault(link.to_id, []).append(link.from_id)
    return [
        Landmark(
            id=-number,
            pose=pose_list(snapshot.poses.get(number)),
            length_m=lengths.get(number),
            seen_from=sorted(nodes),
        )
        for number, nodes in sorted(seen_from.items(), reverse=True)
    ]
