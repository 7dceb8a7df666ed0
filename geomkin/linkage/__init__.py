"""Planar linkages: sizes, closed-form motion, measures. Knows nothing of plates, pins or files."""
