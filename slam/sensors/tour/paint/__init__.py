"""Painters of the tour's surfaces: each fills one canvas, measured in metres, from its own random numbers."""
