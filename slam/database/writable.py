"""Whether a file's schema does on its own nothing that slamdeck would not do: only then is it written."""

from __future__ import annotations

import re
import sqlite3

from slam.errors import DatabaseError

#: What RTAB-Map's triggers say, whatever their names; the table that is stamped is any.
_TRIGGERS = (
    r"before insert on feature when not exists ?\( ?select (?:1|id|node\.id) from node"
    r" where (?:node\.)?id ?= ?new\.node_id ?\) begin select raise ?\( ?abort ?, ?'[^']*' ?\) ?; end",
    r"after insert on (?:node|data|word|info|statistics) begin update (?:node|word|info|statistics)"
    r" set time_enter ?= ?datetime ?\( ?'now' ?\) where rowid ?= ?new\.rowid ?; end",
)
_INDEX = r"create (?:unique )?index \S+ on \S+ ?\( ?[\w\"]+(?: ?, ?[\w\"]+)* ?\)"
_RULES = r"\b(check|collate|on\s+conflict)\b"


def check_writable(connection: sqlite3.Connection) -> None:
    """Refuse to write a file whose triggers, indexes or rules are not those of maps: writing would carry them out.

    Raises:
        DatabaseError: with the one that is not known.
    """
    found = connection.execute("SELECT type, name, sql FROM main.sqlite_master WHERE sql IS NOT NULL").fetchall()
    for kind, name, sql in found:
        plain = " ".join(sql.lower().split())
        said = re.search(_RULES, plain)
        if kind == "trigger" and not _is_known(plain):
            _refuse(f"trigger {name!r}, which is none of RTAB-Map's")
        if kind == "index" and not re.fullmatch(_INDEX, plain):
            _refuse(f"index {name!r}, which is not one of plain columns")
        if kind == "table" and said is not None:
            _refuse(f"table {name!r} with the rule {said[1].upper()!r}")


def _is_known(trigger: str) -> bool:
    body = re.sub(r"^create trigger \S+ ", "", trigger)
    return any(re.fullmatch(known, body) for known in _TRIGGERS)


def _refuse(what: str) -> None:
    raise DatabaseError(
        f"its schema has a {what[:100]}: it can be read, but is not changed, since writing would carry that out"
    )
