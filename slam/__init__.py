"""The slamdeck engine: RGB-D graph SLAM by RTAB-Map's ideas, without any web or server code."""
