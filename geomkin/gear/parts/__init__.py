"""Plates of gears, bores, spokes, carriers and base plates."""
