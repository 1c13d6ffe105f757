"""Aligning two views: robust pose from points and pixels, with a covariance."""
