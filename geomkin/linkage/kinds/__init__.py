"""Recipes of linkages."""
