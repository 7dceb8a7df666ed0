"""Plates of gears, their bores, spokes, carriers and base plates."""
