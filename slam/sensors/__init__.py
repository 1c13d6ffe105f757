"""Where frames come from: recorded folders and the rendered tour, all behind ``open_source``."""

from slam.sensors.open import open_source
from slam.sensors.source import Source

__all__ = ["Source", "open_source"]
