"""Plates and pins of a linkage, and how they lie on each other."""
