"""Key points, descriptors, matching and visual words."""
