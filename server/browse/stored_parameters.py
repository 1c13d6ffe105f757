"""The parameters that a map file says are in force."""

from __future__ import annotations

from collections.abc import Mapping

from slam.database import Fault, Faults, MapReader
from slam.errors import DatabaseError, ParameterError
from slam.params import Params, specs


def parameter_texts(reader: MapReader, faults: Faults) -> dict[str, str]:
    """Name -> text, of the newest session with the changes made while it ran; names that slamdeck doesn't know too."""
    sessions = reader.sessions(faults)
    began = sessions[-1].started if sessions else None
    changes = [change for change in reader.parameter_changes(faults) if began is None or change.time >= began]
    return {**_stored(reader, faults), **{change.name: change.value for change in changes}}


def as_params(texts: Mapping[str, str]) -> Params:
    """Those that slamdeck knows; defaults count for the others."""
    params, known = Params(), {entry.name for entry in specs()}
    for name in texts.keys() & known:
        try:
            params = params.changed({name: texts[name]})
        except ParameterError:
            # A value that we don't allow: it stays in the file, the default counts.
            continue
    return params


def _stored(reader: MapReader, faults: Faults) -> dict[str, str]:
    try:
        return reader.parameters()
    except DatabaseError as error:
        faults[Fault("Info", "newest", f"defaults stand for its parameters: {error}")] = None
        return {}
