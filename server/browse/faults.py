"""Rows of a file that make no sense, as the page shows them."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice

from server.schemas import RowFault
from slam.database import Fault

#: So many are listed; a file with more is damaged all over.
MOST_LISTED = 100


def row_faults(faults: Iterable[Fault]) -> list[RowFault]:
    """The first of them."""
    return [RowFault(table=fault.table, row=fault.row, reason=fault.reason) for fault in islice(faults, MOST_LISTED)]
