"""RTAB-Map's numbers of feature types, which of them slamdeck can extract, and the networks it adds."""

from __future__ import annotations

from importlib.util import find_spec

_NAMES = {
    0: "SURF",
    1: "SIFT",
    2: "ORB",
    3: "FAST/FREAK",
    4: "FAST/BRIEF",
    5: "GFTT/FREAK",
    6: "GFTT/BRIEF",
    7: "BRISK",
    8: "GFTT/ORB",
    9: "KAZE",
    10: "ORB-OCTREE",
    11: "SuperPoint",
    12: "SURF/FREAK",
    13: "GFTT/DAISY",
    14: "SURF/DAISY",
    15: "PyDetector",
    16: "SuperPoint Rpautrat",
    100: "ALIKED",
    101: "DISK",
}
_TORCH = "it needs a network of PyTorch, which slamdeck doesn't run"
_REFUSED = {
    11: _TORCH,
    15: "it would run the Python file that a parameter names",
    16: _TORCH,
}
_NEED_SURF = (0, 12, 14)
#: Networks that OpenCV 5 runs from a file that the user names; RTAB-Map has no numbers for them.
NETWORKS = (100, 101)
#: RTAB-Map's types that slamdeck can extract, given their libraries.
FEATURE_TYPES = tuple(number for number in _NAMES if number not in _REFUSED and number not in NETWORKS)
#: All numbers that a parameter may have.
CHOICES = (*FEATURE_TYPES, *NETWORKS)


def feature_name(number: int) -> str:
    """What the detector and descriptor of a number are called."""
    return _NAMES[number]


def checked_feature_type(number: int) -> int:
    """The number itself.

    Raises:
        ValueError: this type can't be extracted here; the text says why, and which can.
    """
    reason = _why_not(number)
    if reason is None:
        return number
    working = ", ".join(f"{n} {_NAMES[n]}" for n in CHOICES if _why_not(n) is None)
    known = f"{number} is {_NAMES[number]}, and {reason}" if number in _NAMES else f"{number} is no feature type"
    raise ValueError(f"one of {working}; {known}")


def _why_not(number: int) -> str | None:
    if number not in _NAMES:
        return "there is no such number"
    if number in _NEED_SURF and find_spec("mahotas") is None:
        return "OpenCV is built without SURF; `pip install mahotas` brings it"
    if number in NETWORKS:
        return _why_no_network(number)
    return _REFUSED.get(number)


def _why_no_network(number: int) -> str | None:
    import cv2  # parameters are read by much that needs no images

    if hasattr(cv2, _NAMES[number]):
        return None
    return f"OpenCV {cv2.__version__} has no networks for features, 5.0 does"
