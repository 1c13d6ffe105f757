"""RTAB-Map's tables, schema 0.20.0, column for column.

Text, order and types of the columns are those of RTAB-Map, which reads by name and asserts that each exists.
The names say nothing of units: lengths are metres, stamps seconds, blobs are described in the codecs beside this file.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import (
    Column,
    Float,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    PrimaryKeyConstraint,
    Table,
    Text,
)
from sqlalchemy.types import UserDefinedType


class Date(UserDefinedType[str]):
    """SQLite's DATE column as RTAB-Map uses it: the text ``YYYY-MM-DD HH:MM:SS``, UTC."""

    cache_ok = True

    def get_col_spec(self, **_: Any) -> str:
        """The type's name in the schema."""
        return "DATE"


metadata = MetaData()


def _floats(*names: str) -> list[Column[float]]:
    return [Column(name, Float) for name in names]


def _blobs(*names: str) -> list[Column[bytes]]:
    return [Column(name, LargeBinary) for name in names]


node = Table(
    "Node",
    metadata,
    Column("id", Integer, nullable=False),
    Column("map_id", Integer, nullable=False),
    Column("weight", Integer),
    Column("stamp", Float),
    *_blobs("pose", "ground_truth_pose", "velocity"),
    Column("label", Text),
    *_blobs("gps", "env_sensors"),
    Column("time_enter", Date),
    PrimaryKeyConstraint("id"),
)

data = Table(
    "Data",
    metadata,
    Column("id", Integer, nullable=False),
    *_blobs("image", "depth", "calibration", "scan", "scan_info", "ground_cells", "obstacle_cells", "empty_cells"),
    *_floats("cell_size", "view_point_x", "view_point_y", "view_point_z"),
    *_blobs("user_data"),
    Column("time_enter", Date),
    PrimaryKeyConstraint("id"),
)

link = Table(
    "Link",
    metadata,
    Column("from_id", Integer, ForeignKey("Node.id"), nullable=False),
    Column("to_id", Integer, ForeignKey("Node.id"), nullable=False),
    Column("type", Integer, nullable=False),
    Column("information_matrix", LargeBinary, nullable=False),
    *_blobs("transform", "user_data"),
)

word = Table(
    "Word",
    metadata,
    Column("id", Integer, nullable=False),
    Column("descriptor_size", Integer, nullable=False),
    Column("descriptor", LargeBinary, nullable=False),
    Column("time_enter", Date),
    PrimaryKeyConstraint("id"),
)

feature = Table(
    "Feature",
    metadata,
    Column("node_id", Integer, ForeignKey("Node.id"), nullable=False),
    Column("word_id", Integer, nullable=False),
    Column("pos_x", Float, nullable=False),
    Column("pos_y", Float, nullable=False),
    Column("size", Integer, nullable=False),
    Column("dir", Float, nullable=False),
    Column("response", Float, nullable=False),
    Column("octave", Integer, nullable=False),
    *_floats("depth_x", "depth_y", "depth_z"),
    Column("descriptor_size", Integer),
    Column("descriptor", LargeBinary),
)

global_descriptor = Table(
    "GlobalDescriptor",
    metadata,
    Column("node_id", Integer, ForeignKey("Node.id"), nullable=False),
    Column("type", Integer, nullable=False),
    Column("info", LargeBinary),
    Column("data", LargeBinary, nullable=False),
)

info = Table(
    "Info",
    metadata,
    Column("STM_size", Integer),
    Column("last_sign_added", Integer),
    Column("process_mem_used", Integer),
    Column("database_mem_used", Integer),
    Column("dictionary_size", Integer),
    Column("parameters", Text),
    Column("time_enter", Date),
)

statistics = Table(
    "Statistics",
    metadata,
    Column("id", Integer, ForeignKey("Node.id"), nullable=False),
    Column("stamp", Float),
    *_blobs("data", "wm_state"),
)

admin = Table(
    "Admin",
    metadata,
    Column("version", Text),
    *_blobs("preview_image", "opt_cloud", "opt_ids", "opt_poses", "opt_last_localization"),
    Column("opt_polygons_size", Integer),
    *_blobs("opt_polygons", "opt_tex_coords", "opt_tex_materials", "opt_map"),
    *_floats("opt_map_x_min", "opt_map_y_min", "opt_map_resolution"),
    Column("time_enter", Date),
)

Index("IDX_Node_id", node.c.id, unique=True)
Index("IDX_Feature_node_id", feature.c.node_id)
Index("IDX_GlobalDescriptor_node_id", global_descriptor.c.node_id)
Index("IDX_Link_from_id", link.c.from_id)
Index("IDX_node_label", node.c.label, unique=True)
Index("IDX_Statistics_id", statistics.c.id, unique=True)

#: RTAB-Map's triggers. The one on Data touches Node, as RTAB-Map's own does.
TRIGGERS = (
    "CREATE TRIGGER insert_Feature BEFORE INSERT ON Feature"
    " WHEN NOT EXISTS (SELECT Node.id FROM Node WHERE Node.id = NEW.node_id)"
    " BEGIN SELECT RAISE(ABORT, 'Foreign key constraint failed in Feature table'); END",
    *(
        f"CREATE TRIGGER insert_{source}_timeEnter AFTER INSERT ON {source}"
        f" BEGIN UPDATE {target} SET time_enter = DATETIME('NOW') WHERE rowid = new.rowid; END"
        for source, target in (("Node", "Node"), ("Data", "Node"), ("Word", "Word"), ("Info", "Info"))
    ),
)
