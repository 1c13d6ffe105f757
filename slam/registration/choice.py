"""Which registration a parameter asks for."""

from __future__ import annotations

from dataclasses import replace

from slam.geometry import Pose
from slam.params import Params
from slam.registration.icp import IcpRegistration
from slam.registration.view import Registrar, View
from slam.registration.visual import VisualRegistration
from slam.types import Registration


class VisualThenIcp:
    """Images first, and their transform as the guess for ICP; ``always`` also where there is a guess already."""

    def __init__(self, *, always: bool) -> None:
        self._always = always
        self._visual, self._icp = VisualRegistration(), IcpRegistration()

    def register(self, view_from: View, view_to: View, guess: Pose | None, params: Params) -> Registration:
        """``T_from_to`` and covariance of ICP, with the matches of the images; or the first refusal."""
        if guess is not None and not self._always:
            return self._icp.register(view_from, view_to, guess, params)
        return then_icp(self._visual.register(view_from, view_to, guess, params), view_from, view_to, params)


def then_icp(visual: Registration, view_from: View, view_to: View, params: Params) -> Registration:
    """ICP from where a visual registration ended, with its matches; the visual one itself where that was refused."""
    if visual.T_from_to is None:
        return visual
    found = IcpRegistration().register(view_from, view_to, visual.T_from_to, params)
    return replace(found, matches=visual.matches, inliers=visual.inliers)


def registrar(params: Params) -> Registrar:
    """The registration of ``Reg/Strategy``: 0 visual, 1 ICP (with a visual guess where there is none), 2 both."""
    if params.Reg.Strategy == 0:
        return VisualRegistration()
    return VisualThenIcp(always=params.Reg.Strategy == 2)
