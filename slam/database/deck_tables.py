"""The tables of slamdeck's own, which RTAB-Map's tools ignore.

Poses here are float64 (12 values, rows of the 3x4 matrix), so that what is read back is what was computed.
Rows of ``deck_journal`` are only ever added, never changed.
"""

from __future__ import annotations

from sqlalchemy import Boolean, Column, Float, Index, Integer, LargeBinary, MetaData, Table, Text

metadata = MetaData()

session = Table(
    "deck_session",
    metadata,
    Column("map_id", Integer, primary_key=True, autoincrement=False),
    Column("started", Float, nullable=False),
    Column("closed", Float),
    Column("clean", Boolean),
    Column("seed", Integer, nullable=False),
    Column("source", Text, nullable=False),
    Column("parameters", Text, nullable=False),
)

update = Table(
    "deck_update",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("frame_index", Integer, nullable=False),
    Column("stamp", Float, nullable=False),
    Column("weight", Integer, nullable=False),
    Column("T_map_base", LargeBinary),
    Column("best_id", Integer, nullable=False),
    Column("value", Float),
    Column("virtual_place", Float),
    Column("optimized", Boolean, nullable=False),
    Column("tiers", Text, nullable=False),
    Column("matches", Integer, nullable=False),
    Column("inliers", Integer, nullable=False),
    Column("keyframe", Boolean, nullable=False),
    Column("odometry_ms", Float, nullable=False),
    Column("time_ms", Float, nullable=False),
)

pose = Table(
    "deck_pose",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("T_map_base", LargeBinary, nullable=False),
)

hypothesis = Table(
    "deck_hypothesis",
    metadata,
    Column("update_id", Integer, primary_key=True, autoincrement=False),
    Column("place_id", Integer, primary_key=True, autoincrement=False),
    Column("likelihood", Float),
    Column("probability", Float),
    sqlite_with_rowid=False,
)

candidate = Table(
    "deck_candidate",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("update_id", Integer, nullable=False),
    Column("from_id", Integer, nullable=False),
    Column("to_id", Integer, nullable=False),
    Column("type", Integer, nullable=False),
    Column("posterior", Float),
    Column("matches", Integer, nullable=False),
    Column("inliers", Integer, nullable=False),
    Column("transform", LargeBinary),
    Column("information", LargeBinary),
    Column("refusal_test", Text),
    Column("refusal_value", Float),
    Column("refusal_threshold", Float),
    Column("refusal_text", Text),
)
Index("deck_candidate_update", candidate.c.update_id)

frame = Table(
    "deck_frame",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("map_id", Integer, nullable=False),
    Column("frame_index", Integer, nullable=False),
    Column("stamp", Float, nullable=False),
    Column("node_id", Integer, nullable=False),
    Column("T_node_base", LargeBinary),
    Column("T_world_base", LargeBinary),
    Column("inliers", Integer, nullable=False),
    Column("odometry_ms", Float, nullable=False),
    Column("lost", Text, nullable=False),
)
Index("deck_frame_node", frame.c.node_id)

journal = Table(
    "deck_journal",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("time", Float, nullable=False),
    Column("author", Text, nullable=False),
    Column("action", Text, nullable=False),
    Column("from_id", Integer, nullable=False),
    Column("to_id", Integer, nullable=False),
    Column("type_before", Integer),
    Column("transform_before", LargeBinary),
    Column("information_before", LargeBinary),
    Column("type_after", Integer),
    Column("transform_after", LargeBinary),
    Column("information_after", LargeBinary),
    Column("note", Text, nullable=False),
    Column("undoes", Integer),
    Column("chi2_before", Float),
    Column("chi2_after", Float),
    Column("moved", Integer, nullable=False),
    Column("max_shift_m", Float, nullable=False),
)

#: What files of earlier versions lack about an entry of the journal; ``batch`` is the first of those decided together.
decision = Table(
    "deck_decision",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("batch", Integer),
    Column("ate_before", Float),
    Column("ate_after", Float),
)

#: What an entry of the journal did to a node.
node_change = Table(
    "deck_node_change",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("node_id", Integer, nullable=False),
    Column("map_id", Integer, nullable=False),
    Column("weight_before", Integer, nullable=False),
    Column("weight_after", Integer, nullable=False),
    Column("label_before", Text, nullable=False),
    Column("label_after", Text, nullable=False),
    Column("T_odom_base", LargeBinary, nullable=False),
    Column("T_map_base", LargeBinary, nullable=False),
)

#: The parameter that an entry of the journal changed with the map.
setting_change = Table(
    "deck_setting_change",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("name", Text, nullable=False),
    Column("before", Text, nullable=False),
    Column("after", Text, nullable=False),
)

#: How an entry of the journal placed all poses: moved as they were, or optimised in a manner of its own.
placement = Table(
    "deck_placement",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("T_new_old", LargeBinary),
    Column("root", Integer),
    Column("without", Text, nullable=False),
    Column("solver", Integer),
    Column("kernel", Text),
    Column("start", Text, nullable=False),
    Column("step", Integer),
)

#: The local grids that an entry of the journal changed: kept with entry ``of``, which made them anew.
grid_change = Table(
    "deck_grid_change",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("of", Integer, nullable=False),
    Column("nodes", Integer, nullable=False),
)

#: Local grids that are not in Data now: those from before a decision, or, while it is undone, those that it made.
kept_grid = Table(
    "deck_local_grid",
    metadata,
    Column("of", Integer, primary_key=True, autoincrement=False),
    Column("node_id", Integer, primary_key=True, autoincrement=False),
    Column("ground_cells", LargeBinary),
    Column("obstacle_cells", LargeBinary),
    Column("empty_cells", LargeBinary),
    Column("cell_size", Float),
    Column("view_point_x", Float),
    Column("view_point_y", Float),
    Column("view_point_z", Float),
)

#: Rows of Link that a decision removed, as they were; ``number`` is its first entry.
removed_link = Table(
    "deck_removed_link",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("number", Integer, nullable=False),
    Column("from_id", Integer, nullable=False),
    Column("to_id", Integer, nullable=False),
    Column("type", Integer, nullable=False),
    Column("information_matrix", LargeBinary, nullable=False),
    Column("transform", LargeBinary),
    Column("user_data", LargeBinary),
)

#: All poses before a decision, as Admin has them, and the digest of those after it; ``id`` is its first entry.
poses_before = Table(
    "deck_poses_before",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("ids", LargeBinary, nullable=False),
    Column("poses", LargeBinary, nullable=False),
    Column("after", Text, nullable=False),
)

parameter_change = Table(
    "deck_parameter_change",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("time", Float, nullable=False),
    Column("node_id", Integer, nullable=False),
    Column("name", Text, nullable=False),
    Column("value", Text, nullable=False),
)
