"""The files that feature parameters name, looked at before a map is made."""

from __future__ import annotations

from slam.features.dictionary_file import open_dictionary
from slam.features.light_glue import check_light_glue
from slam.features.networks import make_aliked, make_disk
from slam.params import Params

_NETWORKS = {100: make_aliked, 101: make_disk}


def check_files(params: Params) -> None:
    """Reads the networks and the dictionary that the parameters name, where they are used.

    Raises:
        ParameterError: one can't be read.
    """
    for number in (params.Vis.FeatureType, params.Kp.DetectorStrategy):
        if number in _NETWORKS:
            _NETWORKS[number](0, params)
    check_light_glue(params)
    open_dictionary(params, seed=0)
