"""The 3D views: the only place that draws."""
