"""The 3D view of a map: the only part that knows viser, which is loaded when a view opens."""
