"""Recipes of gears."""
