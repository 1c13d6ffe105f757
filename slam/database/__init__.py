"""The map file: RTAB-Map's SQLite schema with slamdeck's own tables beside it; the only place that speaks SQL."""

from slam.database.deck_values import CandidateRow, LoopState, ParameterChange, UpdateRow
from slam.database.faults import Fault, Faults
from slam.database.reader import MapReader
from slam.database.records import GridChange, JournalEntry, NodeChange, NodeRecord, Reduction, SettingChange, WordRows
from slam.database.removal import remove_map
from slam.database.rows import MapInfo, NodeRow, NodeTable, SessionRow, StatisticsTable
from slam.database.writer import MapWriter

__all__ = [
    "CandidateRow",
    "Fault",
    "Faults",
    "GridChange",
    "JournalEntry",
    "LoopState",
    "MapInfo",
    "MapReader",
    "MapWriter",
    "NodeChange",
    "NodeRecord",
    "NodeRow",
    "NodeTable",
    "ParameterChange",
    "Reduction",
    "SessionRow",
    "SettingChange",
    "StatisticsTable",
    "UpdateRow",
    "WordRows",
    "remove_map",
]
