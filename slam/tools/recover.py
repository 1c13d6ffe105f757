"""A sound map of what can still be read of a damaged file."""

from __future__ import annotations

import shutil
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from slam.database import MapReader, MapWriter
from slam.database.file_check import check_file
from slam.database.mending import Mended, mend
from slam.database.parameter_text import params_text
from slam.database.salvage import Salvaged, salvage
from slam.geometry import Array, between
from slam.graph.graph import PoseGraph
from slam.params import Params
from slam.tools.describe import told
from slam.tools.gap import covariance
from slam.tools.output import check_target, new_map
from slam.tools.parameters import taken
from slam.tools.settle import settle
from slam.types import WEIGHT_INTERMEDIATE, Link, LinkType

#: Standard deviations of a step of odometry where no link of the file tells (metres, radians).
_USUAL_SIGMAS = (0.05, 0.05)


def recover(source: Path, target: Path, *, force: bool = False) -> dict[str, Any]:
    """Make the map; the summary names what was lost.

    Every row that can be read is copied as it is. Then links get their reverse, links and rows of nodes that are gone
    are dropped, words are made of key points again, neighbours whose link is gone are joined by their odometry poses
    with the usual covariance, and the poses are optimised. The damaged file is not changed.

    Raises:
        DatabaseError: nothing of a map is left, or the new file can't be made.
    """
    check_file(source)
    check_target(target, [source], force=force)
    with new_map(target, [source], force=force) as part:
        with _with_log(source) as plain:
            salvaged = salvage(plain, part)
        mended = mend(part, params_text(Params()))
        with MapWriter.open(part) as writer:
            reader = MapReader(part)
            graph = PoseGraph.from_reader(reader)
            bridges = _bridges(reader, graph)
            writer.add_links(bridges)
            for link in bridges:
                graph.add_link(link)
            refused = settle(writer, graph, taken(reader).params)
        left = told(MapReader(part).flaws())
    return _summary(salvaged, mended, bridges, refused, left, source, target)


@contextmanager
def _with_log(source: Path) -> Iterator[Path]:
    """The file with what a killed writer left in its log; the file itself where it has none."""
    log = source.with_name(source.name + "-wal")
    if not log.exists() or not log.stat().st_size:
        yield source
        return
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "map.db"
        shutil.copyfile(source, plain)
        shutil.copyfile(log, Path(folder) / "map.db-wal")
        # A damaged log gives what SQLite makes of it, at worst nothing.
        with suppress(sqlite3.DatabaseError), closing(sqlite3.connect(plain)) as connection:
            connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        yield plain


def _bridges(reader: MapReader, graph: PoseGraph) -> list[Link]:
    """Links between nodes of a session that follow each other and have lost theirs."""
    table, found, last = reader.nodes(), list[Link](), dict[int, int]()
    usual = _usual(graph)
    for node_id, map_id, weight in zip(table.ids.tolist(), table.map_ids.tolist(), table.weights.tolist(), strict=True):
        if node_id not in graph or weight < WEIGHT_INTERMEDIATE:
            continue
        older = last.get(map_id)
        last[map_id] = node_id
        if older is None or (older, node_id) in graph.links or _is_joined(graph, node_id):
            continue
        T = between(graph.T_odom[node_id], graph.T_odom[older])
        steps = max(1, node_id - older)
        found.append(Link(node_id, older, LinkType.NEIGHBOR, T, np.asarray(np.linalg.inv(steps * usual), np.float64)))
    return found


def _is_joined(graph: PoseGraph, node_id: int) -> bool:
    """Whether odometry leads to a node from an older one."""
    return any(i < node_id and link.type is LinkType.NEIGHBOR for i, link in graph.neighbors(node_id).items())


def _usual(graph: PoseGraph) -> Array:
    """Median covariance of odometry's links, diagonal."""
    known = [np.diagonal(covariance(link)) for link in graph.links.values() if link.type is LinkType.NEIGHBOR]
    linear, angular = _USUAL_SIGMAS
    usual = np.median(known, axis=0) if known else np.array([linear**2] * 3 + [angular**2] * 3)
    return np.diag(usual)


def _summary(
    salvaged: Salvaged,
    mended: Mended,
    bridges: list[Link],
    refused: list[str],
    left: list[str],
    source: Path,
    target: Path,
) -> dict[str, Any]:
    return {
        "input": str(source),
        "map": str(target),
        "rows": {table: count for table, count in salvaged.rows.items() if count},
        "lost": {
            "pages": salvaged.gaps,
            "columns": salvaged.cut,
            "rows": dict(salvaged.unreadable),
        },
        "found_beside_the_trees": dict(salvaged.found),
        "mended": {**asdict(mended), "bridged": [list(link.pair) for link in bridges]},
        "not_optimized": refused,
        "still_missing": left,
        "is_whole": not (salvaged.gaps or salvaged.cut or salvaged.unreadable),
    }
