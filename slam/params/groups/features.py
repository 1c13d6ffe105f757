"""Parameters of key points, descriptors and words."""

from __future__ import annotations

from pydantic import field_validator

from slam.params.feature_types import CHOICES, checked_feature_type
from slam.params.registry import Effect, Group, param
from slam.params.roi import checked_ratios

_SESSION = Effect.SESSION
_NO_BORDER = "0.0 0.0 0.0 0.0"


class KpGroup(Group):
    """Visual words."""

    DetectorStrategy: int = param(
        8, "Feature type of the words, by RTAB-Map's number.", effect=_SESSION, choices=CHOICES
    )
    MaxFeatures: int = param(500, "Key points of a node that become words.", unit="words", ge=1)
    MinDepth: float = param(0.0, "Depth from which a key point becomes a word.", unit="m", ge=0)
    MaxDepth: float = param(0.0, "Depth up to which a key point becomes a word; 0 is no limit.", unit="m", ge=0)
    GridRows: int = param(1, "Rows of the grid whose cells get equal shares of the key points.", ge=1, le=64)
    GridCols: int = param(1, "Columns of the grid whose cells get equal shares of the key points.", ge=1, le=64)
    RoiRatios: str = param(_NO_BORDER, "Shares of the image without key points: left, right, top, bottom.")
    SubPixWinSize: int = param(3, "Half the window of the sub-pixel search.", unit="px", ge=1)
    SubPixIterations: int = param(0, "Iterations of the sub-pixel search; 0 is off.", ge=0)
    SubPixEps: float = param(0.02, "Motion at which the sub-pixel search stops.", unit="px", ge=0)
    IncrementalDictionary: bool = param(
        True, "Make new words while mapping; otherwise those of Kp/DictionaryPath.", effect=_SESSION
    )
    DictionaryPath: str = param(
        "", "File with the words of a fixed dictionary: RTAB-Map's text or a map.", effect=_SESSION
    )
    NndrRatio: float = param(
        0.8, "A descriptor is a known word when its nearest is this much nearer than the second.", ge=0, le=1
    )
    NewWordsComparedTogether: bool = param(True, "Compare descriptors with words made from the same image too.")
    BadSignRatio: float = param(
        0.5, "A node with fewer than this share of the usual words is not used for loops.", ge=0, le=1
    )
    TfIdfLikelihoodUsed: bool = param(True, "Likelihood by TF-IDF; otherwise by the share of common words.")

    _checked_roi = field_validator("RoiRatios")(checked_ratios)
    _checked_type = field_validator("DetectorStrategy")(checked_feature_type)


class GFTTGroup(Group):
    """Corner detector."""

    QualityLevel: float = param(0.001, "Weakest corner as a share of the strongest.", ge=1e-6, le=1)
    MinDistance: float = param(7.0, "Least distance between corners.", unit="px", ge=1)
    BlockSize: int = param(3, "Window of the corner measure.", unit="px", ge=3, le=45)
    UseHarrisDetector: bool = param(False, "Harris's corner measure instead of Shi and Tomasi's.")
    K: float = param(0.04, "Free factor of Harris's measure.", ge=0, le=0.25)


class FASTGroup(Group):
    """FAST corners."""

    Threshold: int = param(20, "Contrast of a corner with its circle.", unit="grey levels", ge=1, le=255)
    MinThreshold: int = param(
        7, "Contrast taken where ORB-OCTREE finds no stronger corner.", unit="grey levels", ge=1, le=255
    )
    NonmaxSuppression: bool = param(True, "Keep only corners that beat their neighbours.")


class ORBGroup(Group):
    """ORB features, and the ORB descriptor of other corners."""

    ScaleFactor: float = param(2.0, "Ratio of one pyramid level to the next.", ge=1.05, le=4)
    NLevels: int = param(3, "Pyramid levels.", ge=1, le=16)
    EdgeThreshold: int = param(19, "Border without key points.", unit="px", ge=1, le=100)
    FirstLevel: int = param(0, "Pyramid level of the image as it is.", ge=0, le=8)
    ScoreType: int = param(0, "Strength of a key point: 0 Harris's measure, 1 FAST's.", ge=0, le=1)
    PatchSize: int = param(31, "Patch that a descriptor is drawn from.", unit="px", ge=5, le=127)


class BRIEFGroup(Group):
    """The BRIEF descriptor."""

    Bytes: int = param(32, "Length: 16, 32 or 64.", unit="bytes", effect=_SESSION, choices=(16, 32, 64))

    @field_validator("Bytes")
    @classmethod
    def _has_pattern(cls, count: int) -> int:
        if count not in (16, 32, 64):
            raise ValueError("16, 32 or 64 bytes")
        return count


class FREAKGroup(Group):
    """The FREAK descriptor."""

    OrientationNormalized: bool = param(True, "Turn the pattern with the key point.", effect=_SESSION)
    ScaleNormalized: bool = param(True, "Scale the pattern with the key point.", effect=_SESSION)
    PatternScale: float = param(22.0, "Size of the pattern.", unit="px", ge=1, le=100, effect=_SESSION)
    NOctaves: int = param(4, "Octaves that key points may cover.", ge=1, le=8, effect=_SESSION)


class BRISKGroup(Group):
    """BRISK features."""

    Thresh: int = param(30, "Contrast of a corner with its circle.", unit="grey levels", ge=1, le=255)
    Octaves: int = param(3, "Octaves; 0 is a single scale.", ge=0, le=8)
    PatternScale: float = param(1.0, "Scale of the pattern.", ge=0.1, le=10, effect=_SESSION)


class SIFTGroup(Group):
    """SIFT features."""

    NOctaveLayers: int = param(3, "Scales of an octave.", ge=1, le=10)
    ContrastThreshold: float = param(0.04, "Weakest contrast of a key point.", ge=0, le=1)
    EdgeThreshold: float = param(10.0, "Largest ratio of curvatures; above it a key point is an edge.", ge=1)
    Sigma: float = param(1.6, "Blur of the first scale.", unit="px", ge=0.5, le=10)
    PreciseUpscale: bool = param(False, "Upscale the image without shifting it.")
    RootSIFT: bool = param(False, "Roots of the normalised descriptor's numbers.", effect=_SESSION)


class KAZEGroup(Group):
    """KAZE features."""

    Extended: bool = param(False, "128 numbers instead of 64.", effect=_SESSION)
    Upright: bool = param(False, "Don't turn with the key point.", effect=_SESSION)
    Threshold: float = param(0.001, "Weakest response of a key point.", ge=0)
    NOctaves: int = param(4, "Octaves.", ge=1, le=8)
    NOctaveLayers: int = param(4, "Scales of an octave.", ge=1, le=10)
    Diffusivity: int = param(1, "Diffusion: 0 PM g1, 1 PM g2, 2 Weickert, 3 Charbonnier.", ge=0, le=3)


class ALIKEDGroup(Group):
    """ALIKED features, of a network."""

    ModelPath: str = param("", "ONNX file of the network.", effect=_SESSION)


class DISKGroup(Group):
    """DISK features, of a network."""

    ModelPath: str = param("", "ONNX file of the network.", effect=_SESSION)


class LightGlueGroup(Group):
    """Matching by the LightGlue network (``Vis/CorNNType`` 6)."""

    ModelPath: str = param("", "ONNX file of the network, made for the type of Vis/FeatureType.", effect=_SESSION)
    Threshold: float = param(0.1, "Lowest score of a match.", ge=0, le=1, effect=_SESSION)


class SURFGroup(Group):
    """SURF features."""

    HessianThreshold: float = param(500.0, "Weakest response of a key point.", ge=0)
    Octaves: int = param(4, "Octaves.", ge=1, le=8)
    OctaveLayers: int = param(2, "Scales of an octave.", ge=1, le=8)
