"""Plates, pins and layers of a linkage."""
