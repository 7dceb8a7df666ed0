"""Plane geometry in complex numbers, in mm: points, poses, curves and measures. No mechanisms here."""
